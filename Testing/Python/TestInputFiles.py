# SPDX-License-Identifier: BSD-3-Clause
"""Files that are read: wrong scenes, damaged meshes, files on which libraries crash, never end or take all memory,
pipes, devices, the network. Each is one error that names the file, the key and the fault, with an empty output, and the
next good file is read."""
import copy
import ctypes
import gzip
import json
import os
import pathlib
import tempfile
import time

import numpy as np

import avianlidar
import scenetools as st
from avianlidar import _suffixes
from boxfiles import gltf_document, with_buffer
from filetools import Files
from helpertools import Server

DEEP = 80000
CHAIN = 20000
HUGE = 2**60
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
SQUARE = [[0, 0], [0.001, 0], [0.001, 0.001], [0, 0.001], [0, 0]]
NO_FILE = "not a regular file"


def plan(**more):
    return st.features(("Polygon", [SQUARE], {"kind": "house", "height": "high"}), **more)


def gltf(children=((),), uri=None):
    """A triangle in the last node; `children`: of each node."""
    nodes = [{"children": list(c)} if c else {} for c in children]
    nodes[-1]["mesh"] = 0
    document, blob = gltf_document([np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], "f4")], (0, 1, 2), nodes,
                                   min=[0, 0, 0], max=[1, 1, 0])
    return with_buffer(document, uri or blob)


def legacy(kind, content):
    return f"# vtk DataFile Version 3.0\nt\nASCII\nDATASET {kind}\n{content}"


POINTS = "POINTS 3 float\n0 0 0 1 0 0 0 1 0\n"
WHOLE = POINTS + "POLYGONS 1 4\n3 0 1 2\n"
AXES = "DIMENSIONS 2 2 2\n" + "".join(f"{axis}_COORDINATES 2 double\n0 3\n" for axis in "XYZ")


def xml(kind, content):
    return f'<VTKFile type="{kind}" version="0.1" byte_order="LittleEndian"><{kind}>{content}</{kind}></VTKFile>'


def array(name, values, kind="Int64", more=""):
    return f'<DataArray type="{kind}" Name="{name}" format="ascii" {more}>{values}</DataArray>'


def surface(points=3, offset=3):
    return xml("PolyData", f'<Piece NumberOfPoints="{points}" NumberOfPolys="1"><Points>'
               + array("p", "0 0 0 1 0 0 0 1 0", "Float64", 'NumberOfComponents="3"') + "</Points><Polys>"
               + array("connectivity", "0 1 2") + array("offsets", offset) + "</Polys></Piece>")


def grid(kind, points, faces=()):
    """A file of one cell over its points, or over `faces` (a polyhedron's stream) too."""
    def numbers(name, values, type_="Int64"):
        return array(name, " ".join(map(str, values)), type_)

    return xml("UnstructuredGrid", f'<Piece NumberOfPoints="{points}" NumberOfCells="1"><Points>'
               + array("p", " ".join(f"{i % 3} {i // 3 % 3} {i // 9}" for i in range(points)), "Float64",
                       'NumberOfComponents="3"')
               + "</Points><Cells>" + numbers("connectivity", range(points)) + numbers("offsets", [points])
               + numbers("types", [kind], "UInt8") + (numbers("faces", faces) + numbers("faceoffsets", [len(faces)])
                                                      if faces else "")
               + "</Cells></Piece>")


def image(*counts):
    extent = " ".join(f"0 {n}" for n in counts)
    return xml("ImageData", f'<Piece Extent="{extent}"></Piece>').replace(
        "<ImageData>", f'<ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1">')


def blocks(content):
    return ('<VTKFile type="vtkMultiBlockDataSet" '
            f'version="1.0"><vtkMultiBlockDataSet>{content}</vtkMultiBlockDataSet></VTKFile>')


def ply(faces, points="0 0 0\n1 0 0\n0 1 0\n"):
    count = faces.count("\n")
    return ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face "
            f"{count}\nproperty list uchar int vertex_indices\nend_header\n{points}{faces}")


TORN = gzip.compress(("".join(f"v {i} 0 {i * i}\n" for i in range(5000)) + TRIANGLE).encode())
IDS = "is broken: a cell has a point id outside 0 to "

# Name, content, what is said; None: an error that names the file, or the one triangle; True: it is sound.
MESHES = [
    ("points.obj", "v 0 0 0\nv 1 0 0\n", ""),
    ("unknown.xyz", "1 2 3\n", "Assimp cannot read it: No suitable reader found"),
    ("torn.obj.gz", TORN[:len(TORN) // 2], "Assimp cannot read it"),
    ("nan.ply", ply("3 0 1 2\n", "0 0 0\nnan 0 0\n0 1 0\n"), "has a vertex whose coordinates are not finite"),
    ("far.ply", ply("4 0 1 2 99999999\n"), "is broken: a face has vertex 99999999 of 3"),
    ("endless.ply", ply("").split("property float y")[0] + "comment end_header\n0\n0\n",
     "is broken: its header has no line end_header"),
    ("short.ply", ply("3 0 1 2\n" * 3)[:-8], "is cut short"),
    ("strips.ply", ply("3 0 1 2\n").replace("element face", "element tristrips"), "has triangle strips"),
    ("points.ply", ply("3 0 1 2\n").replace("vertex 3", "vertex 9"), "is cut short"),
    ("index.ply", ply("3 0 1 2\n3 0 1\n"), "is cut short or damaged: row 2 of an element has 3 numbers, expected 4"),
    ("text.obj", "v 1 2 abc\n" + TRIANGLE, 'line 1 is "v 1 2 abc", expected a vertex with three coordinates'),
    ("commas.obj", TRIANGLE.replace("v 0 0 0", "v 0,5 +1e-400 .5 \\\n").replace("v 1 0 0", "v 1,5 0 0#"), None),
    ("broken.vtp", "<VTKFile type='PolyData'", "VTK cannot read it"),
    ("few.vtk", legacy("POLYDATA", WHOLE.replace("POINTS 3", "POINTS 4")), "VTK cannot read it"),
    ("strip.vtk", legacy("POLYDATA", POINTS + "TRIANGLE_STRIPS 1 3\n2 0 1\n"),
     "is broken: a vtkTriangleStrip has 2 points"),
    ("axis.vtk", legacy("RECTILINEAR_GRID", AXES.replace("2 2 2", "2 3 2")),
     "is broken: an axis has 2 coordinates, expected 3"),
    ("grid.vtk", legacy("STRUCTURED_GRID", "DIMENSIONS 2 2 2\n" + POINTS),
     "is broken: a grid of 2 x 2 x 2 has 3 points"),
    ("far.vtk", legacy("POLYDATA", WHOLE.replace("3 0 1 2", "3 5 1 2")), IDS + "2"),
    ("cell.vtk", legacy("UNSTRUCTURED_GRID", POINTS + "CELLS 1 4\n3 0 1 3\nCELL_TYPES 1\n5\n"), IDS + "2"),
    ("line.vtu", grid(4, 1), "is broken: a vtkPolyLine has 1 points"),
    ("quadratic.vtu", grid(36, 5), "is broken: a vtkQuadraticPolygon has 5 points"),
    ("quad.vtu", grid(9, 5), "is broken: a vtkQuad has 5 points"),
    ("polyhedron.vtu", grid(42, 3, [0]), "is broken: a vtkPolyhedron has 3 points"),
    ("nofaces.vtu", grid(42, 4, [0]), "is broken: a polyhedron's faces are missing"),
    ("three.vtu", grid(42, 4, [3, 3, 0, 1, 2, 3, 0, 1, 3, 3, 1, 2, 3]), "is broken: a polyhedron has 3 faces"),
    ("edges.vtu", grid(42, 4, [4, 3, 0, 1, 2, 2, 0, 1, 3, 1, 2, 3, 3, 0, 2, 3]),
     "is broken: a face of a polyhedron has 2 points"),
    ("faces.vtu", grid(42, 4, [4, 3, 0, 1, 2, 3, 0, 1, 4, 3, 1, 2, 3, 3, 0, 2, 3]), IDS + "3"),
    ("lagrange.vtu", grid(70, 7), "has cells of type 70, of variable order"),
    # Nested or in a circle: the stack of the program that reads.
    ("chain.gltf", gltf([[i + 1] for i in range(CHAIN - 1)] + [[]]), None),
    ("cycle.gltf", gltf([[1], [2], [0]]), None),
    ("elements.vtp", "<VTKFile type='PolyData'>" + "<a>" * DEEP + "</a>" * DEEP + "</VTKFile>", None),
    ("own.vtm", blocks('<DataSet index="0" file="own.vtm"/>'), "names the file"),
    # Numbers that take all memory, or lead beside it.
    ("many.vtk", legacy("POLYDATA", POINTS + "POLYGONS 1 4\n99999999 0 1 2\n"), None),
    ("points.vtk", legacy("POLYDATA", WHOLE.replace("POINTS 3", f"POINTS {HUGE}")), None),
    ("vectors.vtk", legacy("POLYDATA", WHOLE + f"POINT_DATA {10**12}\nVECTORS v double\n1\n"), None),
    ("image.vti", image(10**6, 10**6, 10**3), None),
    ("points.vtp", surface(points=HUGE), None),
    ("offsets.vtp", surface(offset=10**15), None),
    # Sound files.
    ("sound.vtp", surface(), True),
    ("sound.vtu", grid(5, 3), True),
    ("sound.vti", image(10, 10, 10), True),
]

PLANS = {
    "plan.geojson": plan(), "points.geojson": st.features(("Point", [0, 0], {})), "triangle.obj": TRIANGLE,
    "two.kml": '<kml xmlns="http://www.opengis.net/kml/2.2"><Document>' + "".join(
        f"<Folder><name>{name}</name><Placemark><Point><coordinates>0,0</coordinates></Point></Placemark></Folder>"
        for name in ("roads", "trees")) + "</Document></kml>"}
ORIGIN = {"latitude": 0, "longitude": 0, "height": 0}
WHOLE_SCENE = {
    "version": 1, "origin": ORIGIN, "lidar": {"position": [0, 0, 3], "inside": False},
    "materials": {"Grass": {"kd": 0.2, "ks": 0, "kp": 1}}, "material_map": {"*": "wall"},
    "objects": [
        {"file": "triangle.obj", "name": "triangle", "position": [1, 2, 3], "rotation": 30, "scale": 2, "up_axis": "z"},
        {"footprints": "plan.geojson", "height": 10, "glazing": {"share": 0.5, "bay": 5}, "features": "together"},
        {"ground": {"size": [100, 80], "height": -1}, "material": "Grass"}]}
MISSING = object()

# Path of the value to replace (or, MISSING, to remove), the value, what the message must say beside the file's name.
VALUES = [
    (["version"], MISSING, "version: is missing"),
    (["version"], 2, "version: must be 1"),
    (["materials", ""], {"kd": 0.1}, "a material must have a name"),
    (["origin", "latitude"], 91, "origin.latitude: must be from -90 to 90, is 91"),
    (["materials", "Grass", "kd"], -0.1, "materials.Grass.kd: must be from 0 to 1"),
    (["origin", "longitude"], 361, "origin.longitude: must be from -180 to 360"),
    (["lidar", "position"], [0, 0], "lidar.position: must be an array"),
    (["materials", "Grass", "kp"], -1, "materials.Grass.kp: must be from 0 to"),
    (["materials", "Grass", "kd"], MISSING, "materials.Grass.kd: is missing"),
    (["materials", "Grass", "ks"], 0.9, "materials.Grass: kd + ks is 1.1"),
    (["materials", "GRASS"], {"kd": 0.1}, "materials.GRASS: this material is already in the scene"),
    (["material_map", "*"], "velvet", 'material_map.*: unknown material "velvet"; known: Wall, Glass, Metal, Wood, '
                                      'Grass'),
    (["objects", 0, "file"], "nowhere.obj", "objects[0].file: there is no file "),
    (["objects", 0, "file"], MISSING, "objects[0]: must have one of file, footprints, ground"),
    (["objects", 0, "footprints"], "plan.geojson", "objects[0]: must have one of file"),
    (["objects", 0, "scale"], 0, "objects[0].scale: must be greater"),
    (["objects", 0, "scale"], [1, 1, -1], "objects[0].scale[2]: must be greater"),
    (["objects", 0, "rotation"], [0, 0, 0], "objects[0].rotation: must be a direction"),
    (["objects", 0, "rotation"], [0, 0, 1], "objects[0].rotation: must be a direction"),
    (["objects", 0, "rotation"], [[2, 0, 0], [0, 1, 0], [0, 0, 1]], "objects[0].rotation: must be a rotation: rows"),
    (["objects", 0, "rotation"], [[-1, 0, 0], [0, 1, 0], [0, 0, 1]], "objects[0].rotation: must be a rotation, not a"),
    (["objects", 0, "geodetic"], ORIGIN, "objects[0].geodetic: stands beside"),
    (["objects", 0, "up_axis"], "x", 'objects[0].up_axis: must be "y" or "z"'),
    (["objects", 0, "crs"], "EPSG:0", 'unknown coordinate reference system "EPSG:0"'),
    (["objects", 0, "name"], "", "objects[0].name: must not be empty"),
    (["objects", 0], {"file": "triangle.obj", "crs": "EPSG:4326", "position": [0, 95, 0]},
     "triangle.obj: coordinates lie outside"),
    (["objects", 1, "height"], MISSING, "objects[1]: footprints need height or height_attribute, or flat"),
    (["objects", 1], {"footprints": "plan.geojson", "height_attribute": "height"}, "has no usable height"),
    (["objects", 1, "height"], -3, "objects[1].height: must be greater than 0"),
    (["objects", 1, "glazing", "share"], 1.5, "objects[1].glazing.share: must be from 0 to 1"),
    (["objects", 1, "features"], "apart", 'objects[1].features: must be "separate"'),
    (["objects", 1, "filter"], {"kind": []}, "objects[1].filter.kind"),
    (["objects", 1, "flat"], True, "objects[1].height: cannot be given"),
    (["objects", 1, "glazing", "bay"], 1e-9, "more than 100000 bays"),
    (["objects", 1, "filter"], {"kind": "castle"}, "plan.geojson: none of its 1 features fits the filter"),
    (["objects", 1, "layer"], "roads", 'plan.geojson: has no layer "roads"'),
    (["objects", 1, "geodetic"], ORIGIN, "plan.geojson: is georeferenced"),
    (["objects", 1, "footprints"], "two.kml", "has not one layer but 2 (roads, trees)"),
    (["objects", 1, "footprints"], "triangle.obj", "triangle.obj: GDAL cannot read it"),
    (["objects", 1, "footprints"], "points.geojson", "points.geojson: its features have no area"),
    (["origin"], MISSING, "plan.geojson: is georeferenced, so the scene needs an origin"),
]
# The text of a whole file, and what the message must say.
TEXTS = [
    ('{"version": NaN, "objects": []}', "is not JSON"),
    ('{"version": 1, "version": 1}', 'the key "version" stands twice'),
    ("[1, 2]", "the whole: must be an object"),
    ('{"version": 1, "objects": [{"file": "triangle.obj", "crs": "EPSG:32631"}]}',
     "objects[0].crs: needs the scene's origin"),
    ('{"version": 1, "objects": [{"file": "triangle.obj", "geodetic": %s}]}' % json.dumps(ORIGIN),
     "objects[0].geodetic: needs the scene's origin"),
    ('{"version":1,"comment":' + "[" * DEEP + "]" * DEEP + ',"objects":[]}', "is nested more than 100 deep"),
    ('{"version":1,"objects":' + "[" * DEEP, "is nested more than 100 deep"),
]


def wrong_types(value, path=()):
    """(path of a value, one of another type, the path as it is written)"""
    name = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in path)[1:]
    other = 1 if isinstance(value, bool) else 5 if isinstance(value, (str, dict)) else "here"
    if path:
        yield list(path), other, name + ": must"
    if isinstance(value, dict):
        yield [*path, "colour"], 1, (name + "." if path else "") + "colour: "
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from wrong_types(inner, (*path, key))


def replaced(path, value):
    scene = copy.deepcopy(WHOLE_SCENE)
    owner = scene
    for key in path[:-1]:
        owner = owner[key]
    if value is MISSING:
        del owner[path[-1]]
    else:
        owner[path[-1]] = value
    return scene


class Inputs(Files):
    def setUp(self):
        super().setUp()
        for name, text in PLANS.items():
            self.save(name, text)


class Contents(Inputs):
    def test_meshes(self):
        """A process of their own opens them: what ends it is an error as well."""
        table = []
        for name, content, words in MESHES:
            file = self.save(name, content)
            table.append((self.scene({"file": name}), words if words in (None, True)
                          else f"objects[0].file: {file}: {words}"))
        self.assert_said(table)

    def test_values_of_scenes(self):
        """Each value of another type, a key that is unknown in each object, and values beyond their limits."""
        read = st.Read(st.write_scene(str(self.folder), "whole", WHOLE_SCENE))
        self.assertEqual((read.errors, read.names), ([], ["triangle", "plan", "Ground"]))
        cases = [(replaced(path, value), words) for path, value, words in [*wrong_types(WHOLE_SCENE), *VALUES]] + TEXTS
        table = [(st.write_scene(str(self.folder), f"bad{i}", content), words)
                 for i, (content, words) in enumerate(cases)]
        self.assert_said([*table, (str(self.folder / "none.lidarscene.json"), "cannot be opened")])
        self.assertIn("FileName is not set", "".join(st.Read(None).errors))

    def test_a_scale_that_leaves_nothing_warns(self):
        for scale, warned in ((1e-200, True), ([1, 1e-30, 1], True), (1e-6, False)):
            read = st.Read(self.scene({"file": "triangle.obj", "scale": scale}))
            self.assertEqual((read.errors, "triangle: all 1 triangles are points or lines" in " ".join(read.warnings)),
                             ([], warned))

    def test_footprints_nested_deep(self):
        feature = '{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"a":%s},"geometry":%s}]}'
        square = '{"type":"Polygon","coordinates":[[[0,0],[0.001,0],[0.001,0.001],[0,0]]]}'
        inner = '{"type":"GeometryCollection","geometries":['
        for i, text in enumerate(("[" * DEEP + "]" * DEEP, feature % ("[" * DEEP + "]" * DEEP, square),
                                  feature % (1, inner * CHAIN + square + "]}" * CHAIN))):
            self.save(f"{i}.geojson", text)
        self.assert_said([(self.scene({"footprints": f"{i}.geojson", "height": 3}), "GDAL cannot read it")
                          for i in range(3)])

    def test_compressed_files_that_hold_very_much(self):
        """Each by its own limit, before the memory is full or a reader is busy; the same content that is not packed is
        read."""
        def packed(name, unit, count, start=b"", end=b""):
            return self.save(name, gzip.compress(start + unit * count + end, 6))

        zeros, many = b"[0,0,0],", 8_000_000
        city = b'{"type":"CityJSON","version":"1.1","CityObjects":{},"vertices":['
        line = (b'{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},'
                b'"geometry":{"type":"LineString","coordinates":[')
        for name in ("city.json.gz", "unknown.gz"):
            packed(name, zeros, many, city, b"[0,0,0]]}")
        for name in ("plan2.geojson.gz", "plan2.kml.gz"):
            packed(name, zeros, many, line, b"[0,0]]}}]}")
        packed("points.obj.gz", b"v 0 0 0\n", many)
        packed("wall.stl.gz", bytes(84), 600_000)
        words = "bytes hold more than 100 times as many once decompressed"
        start = time.monotonic()
        self.assert_said([(self.scene({"footprints": name, "height": 3}), words)
                          for name in ("plan2.geojson.gz", "plan2.kml.gz", "city.json.gz")]
                         + [(self.scene({"file": name}), words)
                            for name in ("city.json.gz", "unknown.gz", "points.obj.gz", "wall.stl.gz")])
        self.assertLess(time.monotonic() - start, 60.0)
        from avianlidar.apps.inputs import _read as _inputs  # not in the processes with limits
        for name in ("plan.coverage.json", "cloud.csv"):
            with self.assertRaisesRegex(avianlidar.Error, name + ": holds more than [0-9]+ MiB, which is too much"):
                (_inputs.read_plan if "json" in name else avianlidar.load_cloud)(packed(name, zeros, many, b'{"a":[',
                                                                                        b"0]}"))
        # 15 MiB of comments are 300 times smaller, and no bomb.
        packed("comments.obj.gz", b"# nothing\n", 1_500_000, end=TRIANGLE.encode())
        self.assertEqual(st.Read(self.scene({"file": "comments.obj.gz"})).errors, [])

    def test_compressed_files_as_they_are_now(self):
        """Damaged, mended, and edited, all under one name; nothing is written beside them."""
        comments = "# nothing\n" * 30000  # more than one block of GDAL's
        cases = (("m.obj.gz", "file", comments + TRIANGLE, comments + TRIANGLE.replace("1", "2", 1)),
                 ("plan.geojson.gz", "footprints", plan(), plan().replace("0.001", "0.002")))
        for name, key, text, edited in cases:
            file = self.scene({key: name, **({"height": 3, "crs": "EPSG:4326"} if key == "footprints" else {})})
            good = gzip.compress(text.encode(), 0)  # stored, so that the damage is where it is wanted

            def read(content):
                self.save(name, bytes(content))
                found = st.Read(file)
                return found.errors, found.blocks[0].GetBounds() if found.blocks else None

            with self.subTest(name):
                want = read(good)
                self.assertEqual(want[0], [])
                broken_block, broken_sum = bytearray(good), bytearray(good)
                broken_block[11] ^= 0xFF  # its length
                broken_sum[-6] ^= 0xFF
                for damaged in (broken_block, broken_sum, good[:-20], good[:30]):
                    self.assertIn(name, read(damaged)[0][0])
                    self.assertEqual(read(good), want)
                for level in (0, 9):  # the same size, another
                    errors, bounds = read(gzip.compress(edited.encode(), level))
                    self.assertEqual(errors, [])
                    self.assertAlmostEqual(bounds[1] / want[1][1], 2, delta=2e-3)
        self.assertEqual([one for one in os.listdir() if one.endswith(".properties")], [])


class Places(Inputs):
    """Regular files of any folder are read, and nothing else: no pipe, which would wait for ever, no device, which
    would not end."""

    def make(self, kind, name):
        if kind == "pipe":
            os.mkfifo(name)
        else:
            os.symlink("/dev/zero", name)
        return str(self.folder / name)

    def test_neither_pipes_nor_devices(self):
        table = []
        for kind in ("pipe", "device"):
            for ending in (".lidarscene.json", *_suffixes.READERS):
                table.append((self.make(kind, kind + ending), NO_FILE))
            for ending in (".obj", ".obj.gz", ".vtp", ".vtk"):
                self.make(kind, kind + ending)
                table.append((self.scene({"file": kind + ending}), NO_FILE))
            for ending in (".geojson", ".shp", ".osm"):
                self.make(kind, kind + ending)
                table.append((self.scene({"footprints": kind + ending, "height": 3}), NO_FILE))
            # What a file names: materials, buffers, parts and neighbours.
            for ending in (".mtl", ".buf", "2.prj"):
                self.make(kind, kind + ending)
            self.save(kind + "n.obj", f"mtllib {kind}.mtl\n" + TRIANGLE)
            table.append((self.scene({"file": kind + "n.obj"}), True))  # a mesh without its materials
            self.save(kind + "n.gltf", gltf(uri=kind + ".buf"))
            table.append((self.scene({"file": kind + "n.gltf"}), "could not open"))
            self.save(kind + "n.vtm", blocks(f'<DataSet index="0" file="{kind}.vtp"/>'))
            table.append((self.scene({"file": kind + "n.vtm"}), NO_FILE))
            self.save(kind + "2.geojson", plan())
            table.append((self.scene({"footprints": kind + "2.geojson", "height": 3}), NO_FILE))
        # Grids of a reference system.
        os.mkfifo("grid")
        for crs in (f"+proj=longlat +nadgrids=@{self.folder}/grid +type=crs",
                    f"+proj=longlat +geoidgrids={self.folder}/grid"):
            for thing in ({"footprints": "plan.geojson", "height": 3}, {"file": "triangle.obj"}):
                table.append((self.scene({**thing, "crs": crs}), "grid"))
        self.assert_said(table)

    def test_regular_files_of_any_folder(self):
        """Links to them, too."""
        with tempfile.TemporaryDirectory() as elsewhere:
            far = pathlib.Path(elsewhere, "far.obj")
            far.write_text(TRIANGLE)
            os.symlink(far, "link.obj")
            os.symlink("plan.geojson", "link.geojson")
            file = self.scene({"file": str(far)}, {"file": os.path.relpath(far)}, {"file": "link.obj"},
                              {"footprints": "link.geojson", "height": 3}, {"file": "triangle.obj", "crs": "EPSG:3857"})
            os.symlink(file, "link.lidarscene.json")
            for name in (file, "link.lidarscene.json"):
                read = st.Read(name)
                self.assertEqual((read.errors, len(read.names)), ([], 5))

    def files_that_ask(self, url):
        """Files by name, and the object of a scene that uses each."""
        doctype = f'<!DOCTYPE x SYSTEM "{url}/x.dtd">'
        vrt = ("<OGRVRTDataSource><OGRVRTLayer name='plan'>"
               "<SrcDataSource>{}</SrcDataSource>{}</OGRVRTLayer></OGRVRTDataSource>")

        gml = (f'<?xml version="1.0" encoding="ISO-8859-15"?>{doctype}<ogr:FeatureCollection '
               'xmlns:ogr="http://ogr.maptools.org/" '
               'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:xlink="http://www.w3.org/1999/xlink" '
               f'xsi:schemaLocation="http://ogr.maptools.org/ {url}/x.xsd" xmlns:gml="http://www.opengis.net/gml">'
               f'<gml:featureMember><ogr:x fid="1"><ogr:geometryProperty xlink:href="{url}/x.xml#1">'
               f'<gml:Polygon srsName="{url}/crs"><gml:outerBoundaryIs><gml:LinearRing>'
               '<gml:coordinates>0,0 0.001,0 0.001,0.001 0,0</gml:coordinates></gml:LinearRing></gml:outerBoundaryIs>'
               '</gml:Polygon></ogr:geometryProperty></ogr:x></gml:featureMember></ogr:FeatureCollection>')
        plans = {
            "link.geojson": plan(crs={"type": "link", "properties": {"href": url + "/crs", "type": "proj4"}}),
            "source.vrt": vrt.format(f"/vsicurl/{url}/x.geojson", ""),
            "system.vrt": vrt.format("plan.geojson", f"<LayerSRS>{url}/crs</LayerSRS>"),
            "wfs.xml": f"<OGRWFSDataSource><URL>{url}/wfs</URL></OGRWFSDataSource>",
            "types.gml": gml,
            "link.kml": '<kml xmlns="http://www.opengis.net/kml/2.2"><Document><NetworkLink>'
                        f"<Link><href>{url}/x.kml</href></Link></NetworkLink></Document></kml>"}
        meshes = {
            "m1.obj": f"mtllib /vsicurl/{url}/x.mtl\n" + TRIANGLE, "m2.gltf": gltf(uri=url + "/b.bin"),
            "m4.vtm": blocks(f'<DataSet index="0" file="{url}/x.vtp"/>')}
        for name, text in {**plans, **meshes}.items():
            self.save(name, text)
        objects = [{"footprints": name, "height": 3} for name in plans] + [{"file": name} for name in meshes]
        for place in (url + "/crs", "/vsicurl/" + url):
            objects += [{"file": place}, {"footprints": place, "height": 3}]
        for crs in (url + "/crs", "/vsicurl/" + url, f"+proj=longlat +nadgrids=@{url}/g.tif", "urn:ogc:def:crs:" + url):
            objects += [{"footprints": "plan.geojson", "height": 3, "crs": crs}, {"file": "triangle.obj", "crs": crs}]
        return objects

    def test_nobody_is_asked_over_the_network(self):
        """Even where users want PROJ to fetch its grids for other programs. What was not fetched is said."""
        for name, value in (("PROJ_NETWORK", "ON"), ("GDAL_HTTP_TIMEOUT", "5"), ("GDAL_HTTP_MAX_RETRY", "0")):
            os.environ[name] = value
        server, said = Server(), {}
        url = server.url
        for asking in self.files_that_ask(url):
            said[json.dumps(asking)] = st.Read(self.scene(asking)).errors
            self.assertEqual(server.requests.value, 0, asking)
        self.assertEqual(server.asked(), 1)
        for asking, words in (({"footprints": "link.geojson", "height": 3}, url + "/crs is not fetched"),
                              ({"footprints": "system.vrt", "height": 3}, "GDAL cannot read it"),
                              ({"file": "triangle.obj", "crs": url + "/crs"}, "unknown coordinate reference system")):
            self.assertEqual(len(said[json.dumps(asking)]), 1)
            self.assertIn(words, said[json.dumps(asking)][0])

    def test_settings_of_gdal_are_as_before(self):
        """PROJ's switch is of the whole process."""
        file = self.scene({"file": "triangle.obj"}, {"file": "triangle.obj", "crs": "EPSG:3857"})
        st.Read(file)
        with open("/proc/self/maps", encoding="utf-8") as maps:
            gdal = ctypes.CDLL(next(line.split()[-1] for line in maps if "libgdal" in line))
        gdal.CPLGetThreadLocalConfigOption.restype = ctypes.c_char_p
        options = {b"CPL_VSIL_CURL_ALLOWED_FILENAME": b"mine", b"CPL_VSIL_GZIP_SAVE_INFO": None,
                   b"CPL_VSIL_GZIP_WRITE_PROPERTIES": b"YES"}
        for name, value in options.items():
            gdal.CPLSetThreadLocalConfigOption(name, value)
            self.addCleanup(gdal.CPLSetThreadLocalConfigOption, name, None)
        self.addCleanup(gdal.OSRSetPROJEnableNetwork, gdal.OSRGetPROJEnableNetwork())
        gdal.OSRSetPROJEnableNetwork(1)
        read = st.Read(file)
        self.assertEqual((read.errors, gdal.OSRGetPROJEnableNetwork()), ([], 1))
        self.assertEqual({name: gdal.CPLGetThreadLocalConfigOption(name, None) for name in options}, options)
