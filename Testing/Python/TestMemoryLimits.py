# SPDX-License-Identifier: BSD-3-Clause
"""Memory that runs out is an error with its message, wherever on the way it does, never the end of the process: each
algorithm of the way under an address limit that leaves ever more to it, and requests too large for the memory there is.
After each the same algorithm, without the limit, gives what it gives otherwise."""
import os
import resource
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import vtk
from vtk.util import numpy_support

import echotools
import scenetools
from avianlidar import vtkAvianLidar as al

MEGABYTE = 1 << 20
# What is left to the algorithm: from so little that it fails to so much that it does not.
LEAST = 0.5  # MB
STEPS = 8
MOST = 256


ENDINGS = {"LAS": "las", "PCD": "pcd", "KITTI": "bin", "GeoJSON": "geojson"}


class Limit:
    """The address space that there is now and so many bytes more."""

    def __init__(self, more):
        self.more = more

    def __enter__(self):
        with open("/proc/self/status", encoding="ascii") as status:
            size = next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmSize:"))
        self.before = resource.getrlimit(resource.RLIMIT_AS)
        resource.setrlimit(resource.RLIMIT_AS, (size + self.more, self.before[1]))

    def __exit__(self, *_):
        resource.setrlimit(resource.RLIMIT_AS, self.before)


def ball(resolution=200):
    """About 80,000 triangles around the sensor."""
    source = vtk.vtkSphereSource()
    source.SetRadius(50)
    source.SetThetaResolution(resolution)
    source.SetPhiResolution(resolution)
    paint = al.vtkAvianLidarMaterial()
    paint.SetInputConnection(source.GetOutputPort())
    paint.SetMaterialToWall()
    paint.Update()
    return paint.GetOutput()


def many_beams():
    beams = echotools.sensor(columns=1000, channels=100)
    beams.SetElevationStep(0.1)
    beams.SetFiringInterval(0)
    return beams


def cloud(size=150000):
    random = np.random.default_rng(7)
    data = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_support.numpy_to_vtk(100 * random.random((size, 3)), deep=True))
    data.SetPoints(points)
    for name, values in (("energy", random.random(size)), ("laser_id", random.integers(0, 16, size).astype(np.int32)),
                         ("object_id", np.zeros(size, np.int32)), ("material_id", np.zeros(size, np.int32))):
        array = numpy_support.numpy_to_vtk(values, deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    origin = numpy_support.numpy_to_vtk(np.array([[31.2, 121.3, 3.0]]), deep=True)
    origin.SetName("geodetic_origin")
    data.GetFieldData().AddArray(origin)
    return data


def on(algorithm, *inputs, **properties):
    for port, data in enumerate(inputs):
        algorithm.SetInputData(port, data)
    for name, value in properties.items():
        getattr(algorithm, "Set" + name)(value)
    return algorithm


class Way:
    """Every algorithm of the way by name, with inputs that are there already."""

    def __init__(self, folder):
        self.folder = folder
        self.beams = echotools.sensor(columns=360, channels=16)
        self.beams.Update()
        self.ball = ball()
        self.echoes = echotools.scan(self.ball, self.beams.GetOutput(), RaysPerBeam=10)
        self.echoes.Update()
        self.cloud = cloud()
        self.write_scenes()

    def file(self, name):
        return os.path.join(self.folder, name)

    def write_scenes(self):
        points = numpy_support.vtk_to_numpy(self.ball.GetPoints().GetData())
        cells = numpy_support.vtk_to_numpy(self.ball.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        with open(self.file("ball.obj"), "w", encoding="ascii") as stream:
            stream.writelines(f"v {x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in points)
            stream.writelines(f"f {a} {b} {c}\n" for a, b, c in cells + 1)
        writer = vtk.vtkXMLPolyDataWriter()
        writer.SetFileName(self.file("ball.vtp"))
        writer.SetInputData(self.ball)
        writer.SetDataModeToBinary()
        writer.Write()
        legacy = vtk.vtkPolyDataWriter()
        legacy.SetFileName(self.file("ball.vtk"))
        legacy.SetInputData(self.ball)
        legacy.Write()

    def writer(self, kind, name):
        return on(getattr(al, f"vtkAvianLidar{kind}Writer")(), self.cloud, FileName=self.file(name))

    def reader(self, kind, name):
        if not os.path.exists(self.file(name)):
            self.writer(kind, name).Write()
        return on(al.vtkAvianLidarPointCloudReader(), FileName=self.file(name))

    def scene(self, name):
        file = scenetools.write_scene(self.folder, name, {"version": 1, "objects": [
            {"file": name, "material": "Wall"}, {"file": name, "material": "Metal", "position": [200, 0, 0]}]})
        return on(al.vtkAvianLidarSceneReader(), FileName=file)

    def make(self, name):
        kind, _, what = name.partition(" ")
        if what == "writer":
            return self.writer(kind, "w." + ENDINGS[kind])
        if what == "reader":
            return self.reader(kind, "r." + ENDINGS[kind])
        if kind == "scene":
            return self.scene("ball." + name[-3:].lower())
        return {
            "beam source": many_beams,
            "material": lambda: on(al.vtkAvianLidarMaterial(), self.ball),
            "tree": lambda: on(al.vtkAvianLidarCollisionTree(), self.ball),
            "echo filter": lambda: echotools.scan(self.ball, self.beams.GetOutput(), RaysPerBeam=10),
            "colour map": lambda: on(al.vtkAvianLidarHSBColorMap(), self.cloud, UseFieldDataRange=False),
            "range image": lambda: on(al.vtkAvianLidarRangeImage(), self.echoes.GetOutput(), self.beams.GetOutput(),
                                      Columns=360, Rows=16),
            "geodetic transform": lambda: on(al.vtkAvianLidarGeodeticTransform(), self.cloud),
            "tracker": lambda: on(al.vtkAvianLidarTracker(), self.cloud),
            "cloud comparison": lambda: on(al.vtkAvianLidarCloudComparison(), self.cloud, self.cloud),
        }[name]()


def size_of(algorithm):
    """Points and cells of all outputs."""
    sizes = []
    for port in range(algorithm.GetNumberOfOutputPorts()):
        data = algorithm.GetOutputDataObject(port)
        sizes.append((data.GetNumberOfPoints(), data.GetNumberOfCells()) if hasattr(data, "GetNumberOfPoints") else ())
    return sizes


def execute(algorithm):
    algorithm.Modified()
    if hasattr(algorithm, "Write"):
        return algorithm.Write()
    algorithm.Update()
    return None


def step_through(make, whole):
    """Errors and results at ever higher limits, as counts."""
    failed = succeeded = 0
    for step in range(STEPS):
        more = int(MEGABYTE * LEAST * (MOST / LEAST) ** (step / (STEPS - 1)))
        algorithm = make()
        messages = echotools.Messages(algorithm)
        with Limit(more):
            execute(algorithm)
        if messages.errors:
            failed += 1
            assert len(messages.errors) == 1, messages.errors
            said = messages.errors[0]
            assert "memory" in said or "are available" in said, said
            assert all(not any(size) for size in size_of(algorithm)) or hasattr(algorithm, "Write"), size_of(algorithm)
            messages.errors.clear()
            execute(algorithm)
            assert not messages.errors, messages.errors
        else:
            succeeded += 1
        assert size_of(algorithm) == whole, (size_of(algorithm), whole)
    return failed, succeeded


def walk(folder, *names):
    """In a process of its own: a line for each. The threads are there before the first limit."""
    way = Way(folder)
    for name in names:
        first = way.make(name)
        execute(first)
        whole = size_of(first)
        del first
        print("WALKED", *step_through(lambda name=name: way.make(name), whole), name, flush=True)


def first_scan(_, megabytes):
    """In a process of its own, which has no threads yet and no room for eight."""
    echo = echotools.scan(ball(resolution=50), echotools.sensor(), RaysPerBeam=10, NumberOfThreads=8)
    messages = echotools.Messages(echo)
    with Limit(int(megabytes) * MEGABYTE):
        echo.Update()
    print(len(messages.errors), echo.GetOutput().GetNumberOfPoints())


def too_large(folder, name):
    """In a process of its own, with 4 GB of addresses."""
    heard = []

    def check(algorithm, words):
        said = [text.split("): ", 1)[1].strip() for text in echo.errors]
        assert len(said) == 1 and words in said[0] and " GB are available" in said[0], said
        heard.append(said[0])
        echo.errors.clear()

    if name == "points":
        algorithm = al.vtkAvianLidarPointCloudReader()
        algorithm.SetFileName(compressed(os.path.join(folder, "large.pcd"), 20_000_000))
    else:
        algorithm = al.vtkAvianLidarBeamSource()
    echo = echotools.Messages(algorithm)
    if name == "elevations":
        algorithm.SetNumberOfChannelElevations(3)
        algorithm.SetChannelElevation(1, 7.0)
        algorithm.SetNumberOfChannelElevations(2**31 - 1)
        check(algorithm, "2,147,483,647 channel elevations need about ")
        assert algorithm.GetNumberOfChannelElevations() == 3 and algorithm.GetChannelElevation(1) == 7.0
    elif name == "beams":
        algorithm.SetFiringInterval(0)
        algorithm.SetNumberOfChannels(100000)
        algorithm.SetElevationStep(0.0001)
        algorithm.SetAzimuthStep(0.36)
        algorithm.Update()
        check(algorithm, "100,000,000 beams need about 20 GB, ")
        assert algorithm.GetOutput().GetNumberOfPoints() == 0
        # A piece of them is not too large.
        algorithm.UpdatePiece(3, 1000, 0)
        assert not echo.errors and algorithm.GetOutput().GetNumberOfPoints() == 100000, echo.errors
        image = on(al.vtkAvianLidarRangeImage(), vtk.vtkPolyData())
        image.SetInputConnection(1, algorithm.GetOutputPort())
        echo = echotools.Messages(image)
        image.UpdateInformation()
        check(image, "100,000,000 beams of the whole scan need about 6.4 GB, ")
    else:
        algorithm.Update()
        check(algorithm, "20,000,000 points need about ")
        algorithm.SetFileName(compressed(os.path.join(folder, "small.pcd"), 1000))
        algorithm.Update()
        assert not echo.errors and algorithm.GetOutput().GetNumberOfPoints() == 1000, echo.errors
    print(*heard)


def compressed(name, points):
    """A PCD file of so many points at the origin: 16 bytes each, of which LZF leaves a 90th."""
    plain = 16 * points
    packed = bytearray(b"\x00\x00")  # a zero as it is, then copies of it
    left = plain - 1
    packed += b"\xe0\xff\x00" * (left // 264)
    left %= 264
    while left:
        run = min(left, 32)
        packed += bytes([run - 1]) + bytes(run)
        left -= run
    head = ("VERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\n"
            f"WIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA binary_compressed\n")
    with open(name, "wb") as file:
        file.write(head.encode() + struct.pack("<II", len(packed), plain) + packed)
    return name


# Threads, and memory that goes back to the system when it is freed, so that the next has to ask.
ENVIRONMENT = {"OMP_NUM_THREADS": "2", "MALLOC_MMAP_THRESHOLD_": "65536", "MALLOC_TRIM_THRESHOLD_": "65536",
               "MALLOC_ARENA_MAX": "1"}
TASKS = {"walk": walk, "first_scan": first_scan, "too_large": too_large}
# What needs little comes first: later it might find it among what others left.
NAMES = ["colour map", "geodetic transform", "cloud comparison", "tracker", "LAS writer", "PCD writer", "KITTI writer",
         "GeoJSON writer", "range image", "LAS reader", "PCD reader", "KITTI reader", "beam source", "material", "tree",
         "echo filter", "scene of OBJ", "scene of VTP"]


class MemoryLimits(unittest.TestCase):
    def run_apart(self, task, names, addresses=resource.RLIM_INFINITY):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (addresses, addresses))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([sys.executable, __file__, "--task", task, folder, *names], preexec_fn=limit,
                                 env=dict(os.environ, **ENVIRONMENT), text=True, errors="replace",
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        return run

    def test_every_limit_gives_a_result_or_one_error(self):
        left, errors = list(NAMES), 0
        while left:
            run = self.run_apart("walk", left)
            lines = [line.split(" ", 3)[1:] for line in run.stdout.splitlines() if line.startswith("WALKED")]
            for failed, succeeded, name in lines:
                print(f"  {name}: {failed} errors, {succeeded} results", flush=True)
                with self.subTest(name=name):
                    self.assertGreater(int(succeeded), 0)
            errors += sum(int(failed) for failed, *_ in lines)
            left = left[len(lines):]
            if left:
                with self.subTest(name=left.pop(0)):
                    self.fail(f"the process ended with {run.returncode}: {run.stderr[-2000:]}")
        # Which algorithm finds how much depends on what malloc kept of those before it; the limits are felt all the same.
        self.assertGreater(errors, 20)

    def test_a_first_scan_has_the_threads_for_which_there_is_room(self):
        for megabytes in (20, 60, 200, 1000):
            run = self.run_apart("first_scan", [str(megabytes)])
            self.assertEqual(run.returncode, 0, run.stdout + run.stderr[-2000:])
            errors, echoes = map(int, run.stdout.split()[-2:])
            self.assertEqual((errors, echoes > 0), (0, True), megabytes)

    def test_requests_that_are_too_large_say_so(self):
        for name in ("beams", "elevations", "points"):
            with self.subTest(name=name):
                run = self.run_apart("too_large", [name], 2 << 30)
                self.assertEqual(run.returncode, 0, run.stdout + run.stderr[-2000:])
                self.assertIn("are available", run.stdout)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--task"]:
        TASKS[sys.argv[2]](*sys.argv[3:])
    else:
        unittest.main()
