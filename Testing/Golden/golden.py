#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Freezes what scans of nine scenes with two sensors give, and compares another build with it, array by array.

    golden.py make FOLDER       one file for each scene
    golden.py compare FOLDER    prints what differs; exit status 1 if anything does. With --tolerance, numbers of double
                                precision may differ by that much of the largest

PYTHONPATH names the Python package of the build. The sceneries that are not part of the repository are scene files in
AVIANLIDAR_SCENES_DIR (default: build/paraview/Testing/Scenes); a scene without its file is left out, and named.
Counts of nodes, candidates and rays are costs, not results, and are not compared. Neither are arrays that the frozen
scans lack."""
import argparse
import math
import os
import pathlib
import pickle
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersGeneral import vtkMultiBlockDataGroupFilter

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE.parent / "Prober"), str(ROOT / "Examples" / "corridor")]
import corridor_scene  # noqa: E402
from avianlidar import vtkAvianLidar as al  # noqa: E402
from data import contents  # noqa: E402
from pipeline import MAY_DIFFER  # noqa: E402

Filter, Source = al.vtkAvianLidarEchoFilter, al.vtkAvianLidarBeamSource
SENSORS = {"Airport16": 3.0, "VLP16": 4.0}  # degrees between columns: some thousand beams with the two
PHOTONS = {"ReceiverModel": Source.RECEIVER_MODEL_PHOTONS, "ReceiverAperture": 0.01, "BackgroundRadiance": 0.1,
           "ReceiverEfficiency": 0.3}
# What a variant sets, of the filter and of the sensor, and what else the scene holds.
VARIANTS = {"default": ({}, {}, ""), "one reflection": ({"NumberOfReflections": 1}, {}, ""),
            "rays": ({"BeamSamples": Filter.BEAM_SAMPLES_RAYS}, {}, ""),
            "paper": ({"BeamSamples": Filter.BEAM_SAMPLES_RAYS, "Sampling": Filter.SAMPLING_MONTE_CARLO,
                       "LightEnergyThreshold": Filter.LIGHT_ENERGY_THRESHOLD_LIMIT,
                       "ReturnMode": Filter.RETURN_MODE_RANGE_UNITS}, {}, ""),
            "no beam constraint": ({"BeamConstraint": 0, "BeamSamples": Filter.BEAM_SAMPLES_RAYS}, {}, ""),
            "25 rays": ({"RaysPerBeam": 25}, {}, ""),
            "400 rays": ({"RaysPerBeam": 400, "NumberOfConnections": 4}, {}, ""),
            "full model": ({"FullModel": 1, "ReflectanceModel": Filter.REFLECTANCE_MODEL_MICROFACET}, {}, ""),
            "aperture": ({},
                         {"ReceiverAperture": 0.01, "BeamProfile": Source.BEAM_PROFILE_GAUSSIAN, "OverlapRange": 20.0},
                         ""), "photons": ({"Noise": 1}, PHOTONS, ""),
            "rain": ({"Visibility": 5000.0, "RainRate": 10.0, "AirBackscatter": 1}, {"ReceiverAperture": 0.01}, ""),
            "fog bank": ({"AirBackscatter": 1}, {"ReceiverAperture": 0.01}, "fog"),
            "birds": ({"ReportMovers": 1}, {"NumberOfRevolutions": 1}, "birds"),
            "birds and photons": ({"Noise": 1, "ReportMovers": 1, "NumberOfReflections": 1}, PHOTONS, "birds")}


def set_all(algorithm, values):
    for name, value in values.items():
        getattr(algorithm, "Set" + name)(value)


def scene_files():
    folder = pathlib.Path(os.environ.get("AVIANLIDAR_SCENES_DIR", ROOT / "build" / "paraview" / "Testing" / "Scenes"))
    names = ("avz_office", "ingolstadt", "neubrandenburg", "phnl", "shanghai_cbd", "zsss_all", "zsss_structures")
    return {"hongqiao": ROOT / "Examples" / "airport" / "scene" / "hongqiao.lidarscene.json", "corridor": None,
            **{name: folder / (name + ".lidarscene.json") for name in names}}


def surfaces_of(name, file):
    """The surfaces, and where the lidar stands."""
    if name == "corridor":
        return corridor_scene.build(), corridor_scene.LIDAR
    reader = al.vtkAvianLidarSceneReader()
    reader.SetFileName(str(file))
    reader.Update()
    data = reader.GetOutputDataObject(0)
    return data, data.GetFieldData().GetArray("lidar_position").GetTuple(0)


class Scans:
    """All scans of one scene."""

    def __init__(self, surfaces, position):
        self.position = position
        self.tree, self.with_fog = al.vtkAvianLidarCollisionTree(), al.vtkAvianLidarCollisionTree()
        self.tree.SetInputDataObject(surfaces)
        fog = al.vtkAvianLidarMedium()
        set_all(fog, {"Kind": fog.KIND_FOG, "Shape": fog.SHAPE_ELLIPSOID})
        fog.SetCenter(position[0] + 60.0, position[1], position[2])
        fog.SetLengths(60.0, 40.0, 30.0)
        both = vtkMultiBlockDataGroupFilter()
        both.AddInputDataObject(surfaces)
        both.AddInputConnection(fog.GetOutputPort())
        self.with_fog.SetInputConnection(both.GetOutputPort())
        self.birds = al.vtkAvianLidarTracks()
        set_all(self.birds, {"NumberOfBirds": 12, "Radius": 60.0})
        self.birds.SetCenter(*position)
        self.birds.SetHeights(1.0, 15.0)

    def run(self, sensor, settings, of_sensor, holds):
        """{output of the filter: contents}, from objects that never ran before but for the tree."""
        source, echoes = al.vtkAvianLidarBeamSource(), al.vtkAvianLidarEchoFilter()
        getattr(source, "SetPresetTo" + sensor)()
        source.SetAzimuthStep(SENSORS[sensor])
        source.SetPosition(*self.position)
        set_all(source, of_sensor)
        set_all(echoes, settings)
        echoes.SetInputConnection(0, source.GetOutputPort())
        echoes.SetInputConnection(1, (self.with_fog if holds == "fog" else self.tree).GetOutputPort())
        if holds == "birds":
            echoes.SetInputConnection(2, self.birds.GetOutputPort())
        echoes.AddObserver("WarningEvent", lambda *_: None)  # faces that coincide in what others drew
        echoes.Update()
        points = echoes.GetOutput().GetPointData()
        return (
            [contents(echoes.GetOutputDataObject(port), MAY_DIFFER) for port in range(echoes.GetNumberOfOutputPorts())],
            {name: vtk_to_numpy(points.GetArray(name)).copy() for name in ("beam_id", "distance_m", "energy_received")})


def scan_all(name, file):
    scans = Scans(*surfaces_of(name, file))
    return {(sensor, variant): scans.run(sensor, *what) for variant, what in VARIANTS.items() for sensor in SENSORS}


def in_words(old, new):
    """How far two scans differ: echoes without a partner, and errors of those with one (by beam and order)."""
    keys = []  # of each echo: beam and order
    for echoes in (old, new):
        beam = echoes["beam_id"].astype(np.int64)
        first = np.concatenate([[True], beam[1:] != beam[:-1]]) if len(beam) else np.zeros(0, bool)
        start = np.maximum.accumulate(np.where(first, np.arange(len(beam)), 0)) if len(beam) else beam
        keys.append(beam * 4096 + np.arange(len(beam)) - start)
    both, one, two = np.intersect1d(*keys, return_indices=True)
    energy = np.abs(new["energy_received"][two] / old["energy_received"][one] - 1.0)
    away = np.abs(new["distance_m"][two] - old["distance_m"][one])
    rms = math.sqrt(float(np.mean(energy**2))) if len(both) else 0.0
    return (f"{len(keys[0])} echoes, {len(keys[0]) - len(both)} gone, {len(keys[1]) - len(both)} new; energy rms "
            f"{rms:.1e}, at most {energy.max(initial=0.0):.1e}; range at most {away.max(initial=0.0):.1e} m; "
            f"{np.count_nonzero(energy)} differ")


def is_same(one, two, tolerance):
    """Whether two arrays of contents() have the same bits, or doubles that differ by `tolerance` of the largest at
    most."""
    if one == two or not tolerance or one is None or two is None or one[:-1] != two[:-1] or "double" not in one:
        return one == two
    one, two = np.frombuffer(one[-1]), np.frombuffer(two[-1])
    largest = np.max(np.abs(one), initial=0.0, where=np.isfinite(one))
    return np.allclose(one, two, rtol=0.0, atol=tolerance * largest, equal_nan=True)


def compare(frozen, found, tolerance):
    """Prints what differs. @return number of scans that do"""
    differ = 0
    for key, (outputs, echoes) in frozen.items():
        names = {f"{port}{where}" for port, (one, two) in enumerate(zip(outputs, found[key][0]))
                 for where in one if not is_same(one.get(where), two.get(where), tolerance)}
        if names:
            differ += 1
            print(f"  {', '.join(key)}: {in_words(echoes, found[key][1])}; arrays: {', '.join(sorted(names))[:400]}",
                  flush=True)
    return differ


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("what", choices=("make", "compare"))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--scenes", nargs="+", choices=list(scene_files()), default=list(scene_files()))
    parser.add_argument("--tolerance", type=float, default=0.0)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    differ = 0
    for name in options.scenes:
        source = scene_files()[name]
        file = options.folder / (name + ".pickle")
        if source and not source.exists():
            print(f"{name}: left out, {source} is not there")
            continue
        found = scan_all(name, source)
        if options.what == "make":
            file.write_bytes(pickle.dumps(found))
            echoes = sum(len(one["beam_id"]) for _, one in found.values())
            print(f"{name}: {len(found)} scans, {echoes} echoes", flush=True)
        else:
            count = compare(pickle.loads(file.read_bytes()), found, options.tolerance)
            print(f"{name}: {count} of {len(found)} scans differ", flush=True)
            differ += count
    sys.exit(differ > 0)


if __name__ == "__main__":
    main()
