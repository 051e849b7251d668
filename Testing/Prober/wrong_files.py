# SPDX-License-Identifier: BSD-3-Clause
"""Mutated files in child processes with little memory: a reader gives a sound result or an error that names a file; a
plan or a scenario is taken as a whole or refused in words that name the file and its member. Never a signal, a hang, or
nothing. See README.md."""

import argparse
import json
import math
import os
import random
import re
import struct
import sys
import tempfile
import time
import traceback
import warnings

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "..", "Python"))

import numpy as np  # noqa: E402
import vtk  # noqa: E402
from vtk.util.numpy_support import vtk_to_numpy  # noqa: E402

import boxfiles as box  # noqa: E402
import children  # noqa: E402
from avianlidar import Error, Sequence  # noqa: E402
from avianlidar import vtkAvianLidar as al  # noqa: E402
from avianlidar.apps.inputs._read import read_plan  # noqa: E402
from avianlidar.apps.coverage._report import Report  # noqa: E402
from data import leaves  # noqa: E402
from echotools import Messages  # noqa: E402
from mutations import changed, mutated  # noqa: E402

BATCH = 40  # files to a child
CORPUS = os.path.join(HERE, "..", "Fuzzing", "Corpus")
SCENE_FILE = "scene.lidarscene.json"


def dumped(document):
    return json.dumps(document, indent=1).encode()


# ---------------------------------------------------------------- files for the readers

def mesh_files(folder):
    """{name: content} of a box in every format, as text and binary, except formats whose library is known to crash: IFC
    (Assimp), legacy surfaces and unstructured grids (VTK)."""
    c, t, q = box.CORNERS, box.TRIANGLES, box.QUADS
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, *c[list(face)].ravel(), 0) for face in t)
    quads = b"".join(struct.pack("<B4i", 4, *face) for face in q)
    head = box.ply(c, q).split("end_header\n")[0].replace("ascii", "binary_little_endian") + "end_header\n"
    gltf = box.MESHES["box.gltf"]
    gltf += b" " * (-len(gltf) % 4)
    files = {**box.MESHES, "quads.ply": box.ply(c, q).encode(), "quads.ac": box.ac3d(c, q).encode(),
             "binary.stl": b"box".ljust(80) + struct.pack("<I", len(t)) + triangles,
             "binary.ply": head.encode() + c.astype("<f4").tobytes() + quads,
             "box.glb": b"glTF" + struct.pack("<IIII", 2, 20 + len(gltf), len(gltf), 0x4E4F534A) + gltf}
    image, grid, name = vtk.vtkImageData(), vtk.vtkAppendFilter(), os.path.join(folder, "written")
    image.SetDimensions(3, 4, 2)
    grid.AddInputData(box.poly_data(q))
    grid.Update()
    for kind, data, writer in (("vtp", box.poly_data(q), vtk.vtkXMLPolyDataWriter()),
                               ("vtu", grid.GetOutput(), vtk.vtkXMLUnstructuredGridWriter()),
                               ("vti", image, vtk.vtkXMLImageDataWriter()), ("vtk", image, vtk.vtkDataSetWriter())):
        for mode in (0, 1):
            writer.SetInputData(data)
            writer.SetFileName(name)
            writer.SetFileType(mode + 1) if kind == "vtk" else (writer.SetDataModeToAscii,
                                                                writer.SetDataModeToBinary)[mode]()
            writer.Write()
            with open(name, "rb") as file:
                files[f"box{mode}.{kind}"] = file.read()
    return files


def reader_samples():
    """[(file to mutate, file to open, {name: content})] of small good files: the fuzzers' scenes and clouds, and
    meshes."""
    samples = []
    for kind in ("SceneReader", "PointCloud"):
        for name in sorted({*os.listdir(os.path.join(CORPUS, kind))} - {"empty", "cell-without-its-points"}):
            with open(os.path.join(CORPUS, kind, name), "rb") as file:
                content = file.read()
            if kind == "SceneReader":
                first, *others = re.split(rb"\n=== ([^\n]*)\n", content)
                files = {SCENE_FILE: first, **dict(zip((name.decode() for name in others[::2]), others[1::2]))}
                samples += [(one, SCENE_FILE, files) for one in files]
            elif name != "kitti":
                cloud = "cloud." + name.split("-")[0]
                samples.append((cloud, cloud, {cloud: content[1:]}))  # the first byte is the format
    kitti = {"cloud.bin": np.arange(40, dtype="<f4").tobytes(), "cloud.label": np.arange(10, dtype="<u4").tobytes()}
    samples += [(name, "cloud.bin", kitti) for name in kitti]
    with tempfile.TemporaryDirectory() as folder:
        for name, content in mesh_files(folder).items():
            scene = {"version": 1, "objects": [{"file": name, "material": "wall"}]}
            samples.append((name, SCENE_FILE, {SCENE_FILE: dumped(scene), name: content}))
    return samples


def judge(data, heard, names):
    """What is wrong with what a reader gave, or nothing; and its kind."""
    found = [leaf for _, _, leaf in leaves(data)]
    size = sum(leaf.GetNumberOfPoints() for leaf in found)
    if heard.errors:
        if size or not data.IsA("vtkPolyData") and data.GetNumberOfBlocks():
            return "an error and an output that is not empty", "error"
        named = heard.errors[0] and any(name in heard.errors[0] for name in names)
        return "" if named else f"an error that names no file: {heard.errors[0]}", "error"
    for leaf in found:
        points = leaf.GetNumberOfPoints()
        for cells in (leaf.GetVerts(), leaf.GetPolys()):
            ids = vtk_to_numpy(cells.GetConnectivityArray()) if cells.GetNumberOfCells() else np.array([])
            if len(ids) and (ids.min() < 0 or ids.max() >= points):
                return "a cell with a point that is not there", "result"
        for arrays, count in ((leaf.GetPointData(), points), (leaf.GetCellData(), leaf.GetNumberOfCells())):
            if any(arrays.GetAbstractArray(i).GetNumberOfTuples() != count for i in range(arrays.GetNumberOfArrays())):
                return "an array that is not one value for each", "result"
        if points and not data.IsA("vtkPolyData") and not np.isfinite(vtk_to_numpy(leaf.GetPoints().GetData())).all():
            return "coordinates that are not finite", "result"
    return "", "result" if size else "warning" if heard.warnings else "nothing"


def says_nothing(name, content):
    """True if a file itself says that it holds nothing, or no number."""
    nan = b"nan" in content.lower()
    none = re.search(rb"(POINTS|WIDTH|HEIGHT)\s+0\s|DATA binary", content)
    without_points = content[107:111] == b"\0\0\0\0"
    return {"json": b'"objects": []' in content, ".bin": not content, ".las": without_points, ".laz": without_points,
            ".pcd": nan or none,
            ".ply": nan or re.search(rb"vertex +[0+-]|format binary", content)}.get(name[-4:], False)


def put(files, folder):
    for name, content in files.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(content)


def read(reader, file):
    reader.SetFileName(file)
    reader.Modified()
    reader.Update()
    return reader.GetOutput()


SAMPLES = reader_samples()


def try_reader(seed, folder):
    """What is wrong with what comes of a mutated file, and its kind."""
    r = random.Random(seed)
    name, opened, files = r.choice(SAMPLES)
    file = os.path.join(folder, opened)
    reader = al.vtkAvianLidarSceneReader() if opened == SCENE_FILE else al.vtkAvianLidarPointCloudReader()
    heard = Messages(reader)
    put(files, folder)
    content = mutated(files[name], r)
    put({name: content}, folder)
    wrong, kind = judge(read(reader, file), heard, files)
    if not wrong and kind == "nothing" and not says_nothing(name, content):
        wrong = "no output and not a word"
    return wrong and f"{name}: {wrong}", kind


# ---------------------------------------------------------------- plans of coverage and scenarios

EAST, NORTH = 1 / (111320 * math.cos(math.radians(31.2))), 1 / 111320
SENSOR = {"preset": "Airport16", "azimuth_step": 30.0, "position": [0, 0, 3]}


def feature(shape, corners, **properties):
    places = [[121.3 + x * EAST, 31.2 + y * NORTH] for x, y in corners]
    return {"type": "Feature", "properties": properties,
            "geometry": {"type": shape, "coordinates": [places] if shape == "Polygon" else places}}


def documents():
    """{name: document}; the first three are opened: two plans and a scenario."""
    scene = {"version": 1, "origin": {"latitude": 31.2, "longitude": 121.3, "height": 3},
             "lidar": {"position": [0, 0, 3]},
             "objects": [{"ground": {"size": 4000, "height": 0}, "name": "ground", "material": "Wall"},
                         {"footprints": "town.geojson", "filter": {"height": "*"}, "height_attribute": "height",
                          "height": 8}]}
    town = [feature("Polygon", [(200, 0), (260, 0), (260, 60), (200, 60), (200, 0)], height=12, name="hangar"),
            feature("LineString", [(-300, -500), (-300, 500)], kind="runway", name="18/36", width=45)]
    taken = [feature("Polygon", [(400, 400), (600, 400), (600, 600), (400, 600), (400, 400)])]
    plan = {"scene": "town.lidarscene.json", "sensor": SENSOR,
            "compare_with": [{**SENSOR, "name": "near", "range_gate": 500}], "seed": 1,
            "coverage": {"visibility": 20000, "height_limits": [0, 30]}, "mix": {"crow": 1, "starling": 2},
            "weather": ["rain:1"], "places": 20,
            "heights": [15, 30.5], "extent": [-300, 300, -300, 300], "spacing": 150, "runways": "town.geojson",
            "regions": {"strips": 1, "approaches": 2}}
    bounds = {"bounds": [-500, 500, -500, 500], "spacing": 500, "masts": [5, 8], "margin": 3,
              "exclusions": ["taken.geojson"], "sensors": 2, "draws": 1}
    year = [{"weather": ["fog:700"], "share": 0.25}, {"weather": [], "share": 0.75}]
    scenario = {"scene": "town.lidarscene.json", "sensor": {**SENSOR, "sway_amplitude": 0.02},
                "scan": {"rays_per_beam": 50}, "number_of_scans": 2,
                "scans_per_sequence": 2, "seed": 1, "near_clutter_distance": 10,
                "birds": [{"pattern": "Crossings", "species": "crow", "number_of_birds": 2, "radius": 100,
                           "heights": [2, 30]}],
                "objects": [{"name": "car", "class": "car", "speed": 8, "first": 0, "every": 20,
                             "boxes": [[-1, 1, -2, 2, 0, 1.5]],
                             "route": [[0, -80, 0], [0, 80, 0], [60, 80, 0]]}]}
    collections = {name: {"type": "FeatureCollection", "features": of}
                   for name, of in (("town.geojson", town), ("taken.geojson", taken))}
    return {"lattice.coverage.json": {**plan, "siting": bounds, "year": year},
            "points.coverage.json": {**plan, "siting": {"points": "points.csv", "draws": 0}, "metar": "year.txt"},
            "town.scenario.json": scenario,
            "town.lidarscene.json": scene, **collections}


def try_plan(seed, folder):
    """The same of a mutated plan or scenario, or of a file that it names. Nothing is scanned."""
    r, found = random.Random(seed), documents()
    files = {name: dumped(document) for name, document in found.items()}
    files["points.csv"] = b"x,y\n-100,0\n100,0\n0,-400\n"
    files["year.txt"] = (b"ZSSS 010000Z 34004MPS 9999 FEW030 12/08 Q1013\n"
                         b"ZSSS 010100Z 34004MPS 0800 -RA FG 12/08 Q1013\n")
    opened = r.choice([*found][:3])
    name = opened if r.random() < 0.6 else r.choice([*files][3:])
    files[name] = dumped(changed(found[name], r)) if name in found and r.random() < 0.8 else mutated(files[name], r)
    put(files, folder)
    try:
        asked = os.path.join(folder, opened)
        Sequence(asked, threads=1) if opened == "town.scenario.json" else Report(read_plan(asked), threads=1)
    except Error as error:
        words = str(error).partition(f"{opened}: ")[2]
        of_the_file = "is not JSON|is not known|is a required property|is not of type 'object'"
        named = words and (re.match(rf"({'|'.join([*found[opened], 'year', 'metar'])})\b", words)
                           or re.search(of_the_file, words))
        return "" if named else f"{opened}: an error that does not name the file and its member: {error}", "refused"
    except Exception:  # noqa: B902
        return f"{opened}: {traceback.format_exc()}", "refused"
    return "", "taken"


def run(tell, attempt, seeds):
    warnings.simplefilter("ignore")
    kinds = {}
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            tell(seed)
            wrong, kind = attempt(seed, folder)
            kinds[kind] = kinds.get(kind, 0) + 1
            if wrong:
                return seed, wrong, kinds
    return None, "", kinds


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="+", help="7, 3-9, 3- (until stopped), +100 from a free one, or + (until "
                                                     "stopped)")
    parser.add_argument("--plans", action="store_true", help="plans and scenarios, not what readers read")
    parser.add_argument("--memory", type=int, default=4096, help="MiB of address space")
    parser.add_argument("--limit", type=int, default=60, help=f"seconds of the processor for {BATCH} files")
    options = parser.parse_args()
    attempt = try_plan if options.plans else try_reader
    seeds, failed, total, begin = children.seeds(options.seeds), [], {}, time.monotonic()
    while seeds:
        value, fault, told = children.run(run, attempt, seeds[:BATCH], seconds=options.limit,
                                          memory=options.memory << 20)
        seed, wrong, kinds = (told[-1], fault, {}) if fault else value
        total = {kind: total.get(kind, 0) + kinds.get(kind, 0) for kind in total | kinds}
        if seed is not None:
            failed.append(seed)
            print(f"\nseed {seed}: {wrong}", flush=True)
        seeds = seeds[BATCH if seed is None else seed + 1 - seeds[0] :]
    print(f"{total}, {time.monotonic() - begin:.0f} s; failed: {failed or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
