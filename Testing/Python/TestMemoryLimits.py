# SPDX-License-Identifier: BSD-3-Clause
"""Memory that runs out is an error with its message, wherever on the way it does, never the end of the process: each
algorithm under an address limit that leaves ever more to it, and requests too large for the memory there is. After each
the same algorithm, without the limit, gives what it gives otherwise."""
import os
import resource
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import vtk

import avianlidar
import echotools
import scenetools
from cloudtools import WRITERS, add_array, add_field, cloud
from faulttools import limited, make, writer

MEGABYTE = 1 << 20
LEAST, MOST = 0.25, 256  # MB that are left to the algorithm: it fails with the first, and does not with the last
STEPS = 4
POINTS = 60000


def limit(more):
    """The address space that there is now and so many bytes more."""
    with open("/proc/self/status", encoding="ascii") as status:
        size = next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmSize:"))
    return limited(resource.RLIMIT_AS, size + more)


def ball(resolution=120):
    """About 28,000 triangles around the sensor."""
    source = echotools.given(vtk.vtkSphereSource(), Radius=50, ThetaResolution=resolution, PhiResolution=resolution)
    return echotools.painted(echotools.output(source), "Wall")


def on(algorithm, *inputs):
    for port, data in enumerate(inputs):
        algorithm.SetInputData(port, data)
    return algorithm


def way():
    """Every algorithm by name, with inputs that are there already; what needs little comes first: later it might find
    it among what others left."""
    beams = echotools.sensor(columns=360, channels=8)
    beams.Update()
    surfaces, random = ball(), np.random.default_rng(7)
    echoes = echotools.scan(surfaces, beams.GetOutput(), RaysPerBeam=10)
    echoes.Update()
    data = cloud(100 * random.random((POINTS, 3)))
    for name, values in (("energy", random.random(POINTS)),
                         ("laser_id", random.integers(0, 16, POINTS).astype(np.int32)),
                         ("object_id", np.zeros(POINTS, np.int32)), ("material_id", np.zeros(POINTS, np.int32))):
        add_array(data, name, values)
    add_field(data, "geodetic_origin", (31.2, 121.3, 3.0))
    avianlidar.save(surfaces, "ball.vtp")
    mesh = vtk.vtkOBJWriter()
    mesh.SetFileName("ball.obj")
    mesh.SetInputData(surfaces)
    mesh.Write()
    for name in WRITERS:
        on(writer(name, "r"), data).Write()

    def scene(name):
        return make("SceneReader", FileName=scenetools.write_scene(".", name, {"version": 1, "objects": [
            {"file": name, "material": "Wall"}, {"file": name, "material": "Metal", "position": [200, 0, 0]}]}))

    return {
        "HSBColorMap": lambda: on(make("HSBColorMap", UseFieldDataRange=False), data),
        **{name: lambda name=name: on(make(name), data) for name in ("GeodeticTransform", "Tracker")},
        "CloudComparison": lambda: on(make("CloudComparison"), data, data),
        **{name + " writer": lambda name=name: on(writer(name, "w"), data) for name in WRITERS},
        "RangeImage": lambda: on(make("RangeImage", Columns=360, Rows=8), echoes.GetOutput(), beams.GetOutput()),
        **{name + " reader": lambda suffix=suffix: make("PointCloudReader", FileName="r" + suffix)
           for name, suffix in WRITERS.items() if suffix != ".geojson"},
        "BeamSource": lambda: echotools.given(echotools.sensor(columns=1000, channels=40), ElevationStep=0.1,
                                              FiringInterval=0),
        **{name: lambda name=name: on(make(name), surfaces) for name in ("Material", "CollisionTree")},
        "EchoFilter": lambda: echotools.scan(surfaces, beams.GetOutput(), RaysPerBeam=10),
        "scene of OBJ": lambda: scene("ball.obj"), "scene of VTP": lambda: scene("ball.vtp")}


def size_of(algorithm):
    """Points and cells of all outputs."""
    outputs = [algorithm.GetOutputDataObject(port) for port in range(algorithm.GetNumberOfOutputPorts())]
    return [(data.GetNumberOfElements(0), data.GetNumberOfElements(1)) for data in outputs]


def execute(algorithm):
    algorithm.Modified()
    algorithm.Write() if hasattr(algorithm, "Write") else algorithm.Update()


def walk(*names):
    """In a process of its own: a line for each. The threads are there before the first limit."""
    there = way()
    for name in names or there:
        first = there[name]()
        execute(first)
        whole = size_of(first)
        del first
        failed = 0
        for step in range(STEPS):
            algorithm = there[name]()
            messages = echotools.Messages(algorithm)
            with limit(int(MEGABYTE * LEAST * (MOST / LEAST) ** (step / (STEPS - 1)))):
                execute(algorithm)
            if messages.errors:
                failed += 1
                assert len(messages.errors) == 1, messages.errors
                assert "memory" in messages.errors[0] or "are available" in messages.errors[0], messages.errors[0]
                assert hasattr(algorithm, "Write") or not any(map(any, size_of(algorithm))), size_of(algorithm)
                messages.errors.clear()
                execute(algorithm)
                assert not messages.errors, messages.errors
            assert size_of(algorithm) == whole, (size_of(algorithm), whole)
        print("WALKED", failed, name, flush=True)


def first_scan():
    """In a process of its own, which has no threads yet and no room for eight."""
    echo = echotools.scan(ball(50), echotools.sensor(), RaysPerBeam=10, NumberOfThreads=8)
    messages = echotools.Messages(echo)
    with limit(20 * MEGABYTE):
        echo.Update()
    assert not messages.errors and echo.GetOutput().GetNumberOfPoints(), messages.errors


def too_large():
    """In a process of its own, with 2 GB of addresses."""
    def check(algorithm, words, method="Update"):
        heard = echotools.Messages(algorithm)
        getattr(algorithm, method)()
        assert len(
            heard.errors) == 1 and words in heard.errors[0] and " GB are available" in heard.errors[0], heard.errors

    source = make("BeamSource", FiringInterval=0, NumberOfChannels=100000, ElevationStep=0.0001, AzimuthStep=0.36)
    check(source, "100,000,000 beams need about 20 GB, ")
    assert source.GetOutput().GetNumberOfPoints() == 0
    source.UpdatePiece(3, 1000, 0)  # a piece of them is not too large
    assert source.GetOutput().GetNumberOfPoints() == 100000
    image = on(make("RangeImage"), vtk.vtkPolyData())
    image.SetInputConnection(1, source.GetOutputPort())
    check(image, "100,000,000 beams of the whole scan need about 6.4 GB, ", "UpdateInformation")
    source = make("BeamSource", NumberOfChannelElevations=3)
    source.SetChannelElevation(1, 7.0)
    heard = echotools.Messages(source)
    source.SetNumberOfChannelElevations(2**31 - 1)
    assert len(heard.errors) == 1 and "2,147,483,647 channel elevations need about " in heard.errors[0], heard.errors
    assert source.GetNumberOfChannelElevations() == 3 and source.GetChannelElevation(1) == 7.0
    points = 20_000_000
    head = ("VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
            f"WIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA binary_compressed\n")
    packed = b"\x00\x00" + b"\xe0\xff\x00" * (16 * points // 264)  # a zero, then copies of it
    with open("large.pcd", "wb") as file:
        file.write(head.encode() + struct.pack("<II", len(packed), 16 * points) + packed)
    check(make("PointCloudReader", FileName="large.pcd"), "20,000,000 points need about ")


# Threads, and memory that goes back to the system when it is freed, so that the next has to ask.
ENVIRONMENT = {"OMP_NUM_THREADS": "2", "MALLOC_MMAP_THRESHOLD_": "65536", "MALLOC_TRIM_THRESHOLD_": "65536",
               "MALLOC_ARENA_MAX": "1"}


class MemoryLimits(unittest.TestCase):
    def run_apart(self, task, *arguments, addresses=resource.RLIM_INFINITY):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (addresses, addresses))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([sys.executable, os.path.abspath(__file__), "--task", task, *arguments],
                                 preexec_fn=limit, cwd=folder, env={**os.environ, **ENVIRONMENT}, text=True,
                                 errors="replace", capture_output=True, check=False)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr[-2000:])
        return run.stdout

    def test_every_limit_gives_a_result_or_one_error(self):
        """Which algorithm finds how much depends on what malloc kept of those before it; the limits are felt all the
        same."""
        lines = [line.split(" ", 2) for line in self.run_apart("walk").splitlines() if line.startswith("WALKED")]
        print(", ".join(f"{name}: {failed}" for _, failed, name in lines))
        self.assertGreater(sum(int(failed) for _, failed, _ in lines), 10)
        self.assertTrue(all(int(failed) < STEPS for _, failed, _ in lines))

    def test_a_first_scan_has_the_threads_for_which_there_is_room(self):
        self.run_apart("first_scan")

    def test_requests_that_are_too_large_say_so(self):
        self.run_apart("too_large", addresses=2 << 30)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--task"]:
        {"walk": walk, "first_scan": first_scan, "too_large": too_large}[sys.argv[2]](*sys.argv[3:])
    else:
        unittest.main()
