# SPDX-License-Identifier: BSD-3-Clause
"""Every kind of bad scene file: one error that names the file, the key and the fault, and an empty output."""
import copy
import gzip
import json
import os
import tempfile
import unittest

import scenetools as st

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
SQUARE = [[0, 0], [0.001, 0], [0.001, 0.001], [0, 0.001], [0, 0]]


def collection(*features):
    return json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": p, "geometry": {"type": kind, "coordinates": c}} for kind, c, p in features]})


# Legacy VTK files without their cells.
POLYGONS = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n"
AXES = ("# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 2\n"
        + "".join(f"{axis}_COORDINATES 2 double\n0 3\n" for axis in "XYZ"))
GRID = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n"
CELLS = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n"

def grid(kind, points, faces=()):
    """A file of one cell over its points, or over `faces` (a polyhedron's stream) too."""
    coordinates = " ".join(f"{i % 3} {i // 3 % 3} {i // 9}" for i in range(points))
    numbers = lambda name, values, type="Int64": (
        f'<DataArray type="{type}" Name="{name}" format="ascii">{" ".join(map(str, values))}</DataArray>')
    return ('<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
            f'<Piece NumberOfPoints="{points}" NumberOfCells="1"><Points><DataArray type="Float64" '
            f'NumberOfComponents="3" format="ascii">{coordinates}</DataArray></Points><Cells>'
            + numbers("connectivity", range(points)) + numbers("offsets", [points]) + numbers("types", [kind], "UInt8")
            + (numbers("faces", faces) + numbers("faceoffsets", [len(faces)]) if faces else "")
            + "</Cells></Piece></UnstructuredGrid></VTKFile>")


FILES = {
    "triangle.obj": TRIANGLE,
    "points.obj": "v 0 0 0\nv 1 0 0\n",
    "garbage.obj": "\0\1\2 nothing",
    "nan.ply": "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n",
    "unknown.xyz": "1 2 3\n",
    "empty.ply": "",
    "strip.vtk": POLYGONS.replace("POLYGONS 1 4", "TRIANGLE_STRIPS 1 3") + "2 0 1\n",
    "line.vtu": grid(4, 1),
    "strip.vtu": grid(6, 2),
    "polygon.vtu": grid(7, 2),
    "quadratic.vtu": grid(36, 5),
    "polyhedron.vtu": grid(42, 3, [0]),
    "nofaces.vtu": grid(42, 4, [0]),
    "broken.vtp": "<VTKFile type='PolyData'",
    "axes.vtk": AXES.replace("X_COORD", "X-COORD"),
    "axis.vtk": AXES.replace("DIMENSIONS 2 2 2", "DIMENSIONS 2 3 2"),
    "grid.vtk": GRID,
    "far.ply": "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2 99999999\n",
    "endless.ply": "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\ncomment end_header\n0\n0\n0\n",
    "far.vtk": POLYGONS + "3 5 1 2\n",
    "below.vtk": POLYGONS + "3 0 -1 2\n",
    "short.vtk": CELLS + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n12\n",
    "cell.vtk": CELLS + "CELLS 1 4\n3 0 1 9\nCELL_TYPES 1\n5\n",
    "solid.vtk": CELLS + "CELLS 1 18\n17 4 3 0 1 2 3 0 1 7 3 0 2 3 3 1 2 3\nCELL_TYPES 1\n42\n",
    "faces.vtu": grid(42, 4, [4, 3, 0, 1, 2, 3, 0, 1, 100000000, 3, 1, 2, 3, 3, 0, 2, 3]),
    "threefaces.vtu": grid(42, 4, [3, 3, 0, 1, 2, 3, 0, 1, 3, 3, 1, 2, 3]),
    "edges.vtu": grid(42, 4, [4, 3, 0, 1, 2, 2, 0, 1, 3, 1, 2, 3, 3, 0, 2, 3]),
    "fewfaces.vtu": grid(42, 4, [5, 3, 0, 1, 2, 3, 0, 1, 3, 3, 1, 2, 3, 3, 0, 2, 3]),
    "faceless.vtu": grid(42, 4),
    "lagrange.vtu": grid(70, 7),
    "longquad.vtu": grid(9, 5),
    "table.vtk": "# vtk DataFile Version 3.0\nt\nASCII\nDATASET TABLE\nROW_DATA 0\n",
    "plan.geojson": collection(("Polygon", [SQUARE], {"kind": "house", "height": "high"})),
    "two.kml": '<kml xmlns="http://www.opengis.net/kml/2.2"><Document>' + "".join(f"<Folder><name>{name}</name><Placemark><Point>"
               "<coordinates>0,0</coordinates></Point></Placemark></Folder>" for name in ("roads", "trees")) + "</Document></kml>",
    "points.geojson": collection(("Point", [0, 0], {"kind": "tree"})),
    "lines.geojson": collection(("LineString", [[0, 0], [0.001, 0]], {"kind": "road"})),
    "pole.geojson": collection(("Polygon", [[[0, 91], [1, 91], [1, 92], [0, 91]]], {})),
    "broken.geojson": '{"type": "FeatureCollection", "features": [',
}

GOOD = {
    "version": 1,
    "origin": {"latitude": 0, "longitude": 0, "height": 0},
    "lidar": {"position": [0, 0, 3]},
    "materials": {"Grass": {"kd": 0.2, "ks": 0, "kp": 1}},
    "material_map": {"*": "wall"},
    "objects": [
        {"file": "triangle.obj", "position": [1, 2, 3], "rotation": 30, "scale": 2},
        {"footprints": "plan.geojson", "height": 10, "glazing": {"share": 0.5, "bay": 5}},
        {"ground": {"size": [100, 80], "height": -1}, "material": "Grass"},
    ],
}
MISSING = object()

# Path of the value to replace (or, MISSING, to remove), the value, what the message must say beside the file's name.
TABLE = [
    (["colour"], 1, "colour: unknown key; known here: version,"),
    (["version"], MISSING, "version: is missing"),
    (["version"], 2, "version: must be 1"),
    (["version"], "1", "version: must be a number"),
    (["objects"], MISSING, "objects: is missing"),
    (["objects"], {}, "objects: must be an array"),
    (["lidar"], 5, "lidar: must be an object"),
    (["materials", ""], {"kd": 0.1}, "a material must have a name"),
    (["origin", "latitude"], 91, "origin.latitude: must be from -90 to 90, is 91"),
    (["origin", "longitude"], 361, "origin.longitude: must be from -180 to 360"),
    (["origin", "height"], "3", "origin.height: must be a number"),
    (["origin", "altitude"], 3, "origin.altitude: unknown key"),
    (["lidar", "position"], [0, 0], "lidar.position: must be an array [...] of 3"),
    (["lidar", "position", 2], None, "lidar.position[2]: must be a number"),
    (["lidar", "inside"], 1, "lidar.inside: must be true or false"),
    (["materials", "Grass", "kd"], -0.1, "materials.Grass.kd: must be from 0 to 1, is -0.1"),
    (["materials", "Grass", "ks"], 0.9, "materials.Grass: kd + ks is 1.1"),
    (["materials", "Grass", "kp"], -1, "materials.Grass.kp: must be from 0 to"),
    (["materials", "Grass", "kd"], MISSING, "materials.Grass.kd: is missing"),
    (["materials", "Gold"], {"kd": 0.1, "ks": 0.1}, "materials.Gold.kp: is missing"),
    (["materials", "GRASS"], {"kd": 0.1}, "materials.GRASS: this material is there already"),
    (["material_map", "*"], "velvet", 'material_map.*: unknown material "velvet"; known: Wall, Glass, Metal, Wood, Grass'),
    (["material_map"], ["wall"], "material_map: must be an object"),
    (["objects", 0, "file"], "nowhere.obj", "objects[0].file: there is no file "),
    (["objects", 0, "file"], MISSING, "objects[0]: must have one of file, footprints, ground"),
    (["objects", 0, "footprints"], "plan.geojson", "objects[0]: must have one of file, footprints, ground"),
    (["objects", 0, "colour"], "red", "objects[0].colour: unknown key"),
    (["objects", 0, "height"], 3, "objects[0].height: unknown key"),
    (["objects", 0, "position"], "here", "objects[0].position: must be an array"),
    (["objects", 0, "scale"], 0, "objects[0].scale: must be greater than 0"),
    (["objects", 0, "scale"], [1, 1, -1], "objects[0].scale[2]: must be greater than 0"),
    (["objects", 0, "rotation"], "north", "objects[0].rotation: must be a yaw"),
    (["objects", 0, "rotation"], [0, 0, 1], "objects[0].rotation: must be a direction that is neither zero nor vertical"),
    (["objects", 0, "rotation"], [0, 0, 0], "objects[0].rotation: must be a direction that is neither zero nor vertical"),
    (["objects", 0, "rotation"], [[2, 0, 0], [0, 1, 0], [0, 0, 1]], "objects[0].rotation: must be a rotation: rows"),
    (["objects", 0, "rotation"], [[-1, 0, 0], [0, 1, 0], [0, 0, 1]], "objects[0].rotation: must be a rotation, not a"),
    (["objects", 0, "geodetic"], {"latitude": 0, "longitude": 0, "height": 0}, "objects[0].geodetic: stands beside"),
    (["objects", 0, "crs"], "EPSG:0", 'unknown coordinate reference system "EPSG:0"'),
    (["objects", 0], {"file": "triangle.obj", "crs": "EPSG:4326", "position": [0, 95, 0]},
     "triangle.obj: coordinates lie outside their coordinate reference system"),
    (["objects", 0, "up_axis"], "x", 'objects[0].up_axis: must be "y" or "z"'),
    (["objects", 0, "name"], "", "objects[0].name: must not be empty"),
    (["objects", 0, "file"], "points.obj", "points.obj: "),
    (["objects", 0, "file"], "garbage.obj", "garbage.obj: "),
    (["objects", 0, "file"], "nan.ply", "nan.ply: has a vertex whose coordinates are not finite"),
    (["objects", 0, "file"], "unknown.xyz", "unknown.xyz: Assimp cannot read it"),
    (["objects", 0, "file"], "empty.ply", "empty.ply: Assimp cannot read it"),
    (["objects", 0, "file"], "strip.vtk", "strip.vtk: is broken: a vtkTriangleStrip has 2 points"),
    (["objects", 0, "file"], "line.vtu", "line.vtu: is broken: a vtkPolyLine has 1 points"),
    (["objects", 0, "file"], "strip.vtu", "strip.vtu: is broken: a vtkTriangleStrip has 2 points"),
    (["objects", 0, "file"], "polygon.vtu", "polygon.vtu: is broken: a vtkPolygon has 2 points"),
    (["objects", 0, "file"], "quadratic.vtu", "quadratic.vtu: is broken: a vtkQuadraticPolygon has 5 points"),
    (["objects", 0, "file"], "polyhedron.vtu", "polyhedron.vtu: is broken: a vtkPolyhedron has 3 points"),
    (["objects", 0, "file"], "nofaces.vtu", "nofaces.vtu: is broken: a polyhedron's faces are missing"),
    (["objects", 0, "file"], "threefaces.vtu", "threefaces.vtu: is broken: a polyhedron has 3 faces"),
    (["objects", 0, "file"], "edges.vtu", "edges.vtu: is broken: a face of a polyhedron has 2 points"),
    (["objects", 0, "file"], "torn.obj.gz", "torn.obj.gz: Assimp cannot read it"),
    (["objects", 0, "file"], "broken.vtp", "broken.vtp: VTK cannot read it"),
    (["objects", 0, "file"], "table.vtk", "table.vtk: "),
    (["objects", 0, "file"], "far.vtk", "far.vtk: is broken: a cell has a point id outside 0 to 2"),
    (["objects", 0, "file"], "far.ply", "far.ply: is broken: a face has vertex 99999999 of 3"),
    (["objects", 0, "file"], "endless.ply", "endless.ply: is broken: its header has no line end_header"),
    (["objects", 0, "file"], "axes.vtk", "axes.vtk: is broken: an axis has 0 coordinates, expected 2"),
    (["objects", 0, "file"], "axis.vtk", "axis.vtk: is broken: an axis has 2 coordinates, expected 3"),
    (["objects", 0, "file"], "grid.vtk", "grid.vtk: is broken: a grid of 2 x 2 x 2 has 3 points"),
    (["objects", 0, "file"], "below.vtk", "below.vtk: is broken: a cell has a point id outside 0 to 2"),
    (["objects", 0, "file"], "cell.vtk", "cell.vtk: is broken: a cell has a point id outside 0 to 3"),
    (["objects", 0, "file"], "short.vtk", "short.vtk: is broken: a vtkHexahedron has 3 points"),
    (["objects", 0, "file"], "solid.vtk", "solid.vtk: is broken: a cell has a point id outside 0 to 3"),
    (["objects", 0, "file"], "faces.vtu", "faces.vtu: is broken: a cell has a point id outside 0 to 3"),
    (["objects", 0, "file"], "fewfaces.vtu", "fewfaces.vtu: "),
    (["objects", 0, "file"], "faceless.vtu", "faceless.vtu: is broken: a polyhedron's faces are missing"),
    (["objects", 0, "file"], "lagrange.vtu", "lagrange.vtu: has cells of type 70, of variable order, which are not supported: tessellate"),
    (["objects", 0, "file"], "longquad.vtu", "longquad.vtu: is broken: a vtkQuad has 5 points"),
    (["objects", 1, "height"], MISSING, "objects[1]: footprints need height or height_attribute, or flat"),
    (["objects", 1], {"footprints": "plan.geojson", "height_attribute": "height"}, "has no usable height, and there is no height to assume"),
    (["objects", 1, "height"], -3, "objects[1].height: must be greater than 0"),
    (["objects", 1, "flat"], True, "objects[1].height: means nothing for flat footprints"),
    (["objects", 1, "glazing", "share"], 1.5, "objects[1].glazing.share: must be from 0 to 1"),
    (["objects", 1, "glazing", "bay"], 1e-9, "m has more than 100000 bays of 1e-09 m: a coordinate or 'bay' is wrong"),
    (["objects", 1, "glazing", "bay"], 0, "objects[1].glazing.bay: must be greater than 0"),
    (["objects", 1, "features"], "apart", 'objects[1].features: must be "separate" or "together"'),
    (["objects", 1, "filter"], {"kind": "castle"}, "plan.geojson: none of its 1 features fits the filter"),
    (["objects", 1, "filter"], {"kind": []}, "objects[1].filter.kind: must be a string"),
    (["objects", 1, "layer"], "roads", 'plan.geojson: has no layer "roads"'),
    (["objects", 1, "footprints"], "two.kml", "has not one layer but 2 (roads, trees); name one as layer"),
    (["objects", 1, "footprints"], "broken.geojson", "objects[1].footprints: "),
    (["objects", 1, "footprints"], "triangle.obj", "triangle.obj: GDAL cannot read it"),
    (["objects", 1, "footprints"], "points.geojson", "points.geojson: its features have no area"),
    (["objects", 1, "footprints"], "lines.geojson", "lines.geojson: its features have no area"),
    (["objects", 1, "footprints"], "pole.geojson", "pole.geojson: coordinates lie outside"),
    (["objects", 1, "geodetic"], {"latitude": 0, "longitude": 0, "height": 0}, "plan.geojson: is georeferenced"),
    (["origin"], MISSING, "plan.geojson: is georeferenced, so the scene needs an origin"),
    (["objects", 2, "ground", "size"], [10, 10, 10], "objects[2].ground.size: must be an array [...] of 2"),
    (["objects", 2, "ground", "size"], 0, "objects[2].ground.size: must be greater than 0"),
    (["objects", 2, "ground"], 5, "objects[2].ground: must be an object"),
]

# Text of a whole file, and what the message must say.
TEXTS = [
    ("", "is not JSON"),
    ('{"version": 1, "objects": [}', "is not JSON"),
    ('{"version": 1e999, "objects": []}', "is not JSON"),
    ('{"version": NaN, "objects": []}', "is not JSON"),
    ('{"version": 1, "version": 1, "objects": []}', 'the key "version" stands twice'),
    ("[1, 2]", "the whole: must be an object"),
    ('{"version": 1, "objects": [{"file": "triangle.obj", "crs": "EPSG:32631"}]}', "objects[0].crs: needs the scene's origin"),
    ('{"version": 1, "objects": [{"file": "triangle.obj", "geodetic": {"latitude": 0, "longitude": 0, "height": 0}}]}',
     "objects[0].geodetic: needs the scene's origin"),
]


def changed(path, value):
    scene = copy.deepcopy(GOOD)
    owner = scene
    for key in path[:-1]:
        owner = owner[key]
    if value is MISSING:
        del owner[path[-1]]
    else:
        owner[path[-1]] = value
    return scene


class SceneErrors(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = cls.holder.name
        for name, text in FILES.items():
            with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        whole = gzip.compress("".join(f"v {i} 0 {i * i}\n" for i in range(5000)).encode() + TRIANGLE.encode())
        with open(os.path.join(cls.folder, "torn.obj.gz"), "wb") as file:
            file.write(whole[:len(whole) // 2])

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def assert_fails(self, file, expected):
        scene = st.Read(file)
        self.assertEqual(len(scene.errors), 1, msg=scene.errors)
        self.assertIn(expected, scene.errors[0])
        self.assertIn(file, scene.errors[0])
        self.assertEqual(scene.output.GetNumberOfBlocks(), 0)
        fields = scene.output.GetFieldData()
        self.assertEqual(fields.GetNumberOfArrays(), 1)
        self.assertIn(expected, fields.GetAbstractArray("error").GetValue(0))

    def test_the_scene_without_faults_is_read(self):
        scene = st.Read(st.write_scene(self.folder, "good", GOOD))
        self.assertEqual(scene.errors, [])
        self.assertEqual(scene.names, ["triangle", "plan", "Ground"])

    def test_every_fault_is_named(self):
        for number, (path, value, expected) in enumerate(TABLE):
            with self.subTest(path=path, value=value):
                self.assert_fails(st.write_scene(self.folder, f"bad{number}", changed(path, value)), expected)

    def test_files_that_are_no_scene(self):
        for number, (text, expected) in enumerate(TEXTS):
            with self.subTest(text=text):
                self.assert_fails(st.write_scene(self.folder, f"text{number}", text), expected)

    def test_reasons_are_short_and_name_files_that_exist(self):
        for name in ("torn.obj.gz", "broken.vtp"):
            scene = st.Read(st.write_scene(self.folder, "short", changed(["objects", 0, "file"], name)))
            text = scene.errors[0].split("): ", 1)[1].strip()
            self.assertNotIn("\n", text)
            self.assertNotIn("ERROR:", text)
            self.assertNotIn(".cpp", text)
            self.assertNotIn(".cxx", text)
            for word in text.replace('"', " ").replace(": ", " ").split():
                if word.startswith(self.folder):
                    self.assertTrue(os.path.exists(word.rstrip(".:")), word)

    def test_a_scale_that_leaves_nothing_warns(self):
        for scale, warned in ((1e-200, True), ([1, 1e-30, 1], True), (1e-6, False)):
            scene = st.Read(st.write_scene(self.folder, "scale", changed(["objects", 0, "scale"], scale)))
            self.assertEqual(scene.errors, [])
            said = " ".join(scene.warnings)
            self.assertEqual("triangle: all 1 triangles are points or lines" in said, warned, (scale, said))

    def test_no_file(self):
        self.assert_fails(os.path.join(self.folder, "none.lidarscene.json"), "cannot be opened")

    def test_no_name(self):
        scene = st.Read(None)
        self.assertEqual(len(scene.errors), 1)
        self.assertIn("FileName is not set", scene.errors[0])

    def test_a_good_file_after_a_bad_one(self):
        scene = st.Read(st.write_scene(self.folder, "first", changed(["version"], 2)))
        scene.reader.SetFileName(st.write_scene(self.folder, "second", GOOD))
        scene.reader.Update()
        self.assertEqual(scene.reader.GetOutput().GetNumberOfBlocks(), 3)


if __name__ == "__main__":
    unittest.main()
