# SPDX-License-Identifier: BSD-3-Clause
"""Objects of a scene: formats, placement, material names, footprints of every shape, warnings, abort."""
import base64
import gzip
import json
import math
import os
import struct
import subprocess
import tempfile
import unittest

import numpy as np
from vtkmodules.vtkCommonCore import vtkIntArray, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, vtkCellArray, vtkMultiBlockDataSet, vtkPolyData,
                                           vtkUnstructuredGrid)
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOXML import (vtkXMLMultiBlockDataWriter, vtkXMLPolyDataWriter,
                                 vtkXMLUnstructuredGridWriter)
from vtkmodules.util.numpy_support import vtk_to_numpy

import scenetools as st

# A box of three different sides, so that no axis can be taken for another; corners in binary order.
LOW, HIGH = (1.0, 2.0, 0.0), (2.0, 4.0, 3.0)
CORNERS = np.array([[(LOW, HIGH)[i >> k & 1][k] for k in range(3)] for i in range(8)])
TRIANGLES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]


def y_up(points):
    return np.column_stack([points[:, 0], points[:, 2], -points[:, 1]])


def obj(points, faces, materials=("painted",)):
    """Faces are shared out among the materials in turn."""
    lines = ["mtllib box.mtl"] + ["v %r %r %r" % tuple(map(float, p)) for p in points]
    for i, face in enumerate(faces):
        lines += ["usemtl " + materials[i % len(materials)], "f " + " ".join(str(k + 1) for k in face)]
    return "\n".join(lines) + "\n"


def stl(points, faces):
    text = "solid box\n"
    for face in faces:
        text += "facet normal 0 0 0\nouter loop\n" + "".join("vertex %r %r %r\n" % tuple(map(float, points[k])) for k in face)
        text += "endloop\nendfacet\n"
    return text + "endsolid box\n"


def ply(points, faces):
    return ("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(faces)
            + "".join("%r %r %r\n" % tuple(map(float, p)) for p in points)
            + "".join("%d %s\n" % (len(f), " ".join(map(str, f))) for f in faces))


def gltf(points, faces):
    indices = struct.pack("<%dH" % (3 * len(faces)), *(k for f in faces for k in f))
    vertices = np.asarray(points, dtype="<f4").tobytes()
    blob = base64.b64encode(indices + vertices).decode()
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        # Half of the shift in the scene graph, half in the vertices.
        "nodes": [{"mesh": 0, "translation": [0.5, 0, 0]}],
        "materials": [{"name": "painted"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0, "material": 0}]}],
        "buffers": [{"uri": "data:application/octet-stream;base64," + blob, "byteLength": len(indices) + len(vertices)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(indices)},
                        {"buffer": 0, "byteOffset": len(indices), "byteLength": len(vertices)}],
        "accessors": [
            {"bufferView": 0, "componentType": 5123, "count": 3 * len(faces), "type": "SCALAR"},
            {"bufferView": 1, "componentType": 5126, "count": 8, "type": "VEC3",
             "min": points.min(0).tolist(), "max": points.max(0).tolist()}]})


def collada(points, faces, up):
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>{up}</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert/></technique></profile_COMMON></effect>
</library_effects>
<library_materials><material id="m" name="painted"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="a" count="24">{" ".join(repr(float(c)) for c in points.ravel())}</float_array>
<technique_common><accessor source="#a" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{len(faces)}" material="m"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{" ".join(str(k) for f in faces for k in f)}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"><bind_material><technique_common>
<instance_material symbol="m" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def three_ds(points, faces):
    def chunk(kind, *content):
        body = b"".join(content)
        return struct.pack("<HI", kind, 6 + len(body)) + body

    vertices = struct.pack("<H", len(points)) + np.asarray(points, dtype="<f4").tobytes()
    indices = struct.pack("<H", len(faces)) + b"".join(struct.pack("<4H", *f, 0) for f in faces)
    mesh = chunk(0x4100, chunk(0x4110, vertices), chunk(0x4120, indices))
    return chunk(0x4D4D, chunk(0x0002, struct.pack("<I", 3)), chunk(0x3D3D, chunk(0x4000, b"box\0", mesh)))


def ac3d(points, faces):
    text = 'AC3Db\nMATERIAL "painted" rgb 1 0 0 amb 1 1 1 emis 0 0 0 spec 0 0 0 shi 0 trans 0\nOBJECT world\nkids 1\n'
    text += 'OBJECT poly\nname "box"\nnumvert 8\n' + "".join("%r %r %r\n" % tuple(map(float, p)) for p in points)
    text += "numsurf %d\n" % len(faces)
    for face in faces:
        text += "SURF 0x0\nmat 0\nrefs 3\n" + "".join("%d 0 0\n" % k for k in face)
    return text + "kids 0\n"


def ifc(points, faces):
    """The smallest project with a site that has a shape; lengths in metres."""
    lines = ["IFCPROJECT('0000000000000000000001',#14,'box',$,$,$,$,(#5),#3)",
             "IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.)",
             "IFCUNITASSIGNMENT((#2))",
             "IFCAXIS2PLACEMENT3D(#8,$,$)",
             "IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-05,#4,$)",
             "IFCLOCALPLACEMENT($,#4)",
             "IFCSITE('0000000000000000000002',#14,'site',$,$,#6,#11,$,.ELEMENT.,$,$,$,$,$)",
             "IFCCARTESIANPOINT((0.,0.,0.))",
             "IFCRELAGGREGATES('0000000000000000000003',#14,$,$,#1,(#7))",
             "IFCSHAPEREPRESENTATION(#5,'Body','Brep',(#12))",
             "IFCPRODUCTDEFINITIONSHAPE($,$,(#10))",
             "IFCFACETEDBREP(#13)"]
    first, last = 20, 20 + len(points)
    shell = ",".join("#%d" % (last + 3 * i + 2) for i in range(len(faces)))
    lines.append("IFCCLOSEDSHELL((%s))" % shell)
    lines += ["IFCOWNERHISTORY(#15,#18,$,.NOCHANGE.,$,$,$,0)",
              "IFCPERSONANDORGANIZATION(#16,#17,$)",
              "IFCPERSON($,'nobody',$,$,$,$,$,$)",
              "IFCORGANIZATION($,'none',$,$,$)",
              "IFCAPPLICATION(#17,'1','test','test')",
              "IFCDIRECTION((0.,0.,1.))"]
    lines += ["IFCCARTESIANPOINT((%r,%r,%r))" % tuple(map(float, p)) for p in points]
    for i, face in enumerate(faces):
        lines.append("IFCPOLYLOOP((%s))" % ",".join("#%d" % (first + k) for k in face))
        lines.append("IFCFACEOUTERBOUND(#%d,.T.)" % (last + 3 * i))
        lines.append("IFCFACE((#%d))" % (last + 3 * i + 1))
    return ("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
            "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n"
            + "".join("#%d=%s;\n" % (i + 1, line) for i, line in enumerate(lines)) + "ENDSEC;\nEND-ISO-10303-21;\n")


def poly_data(faces):
    points, polys, lines = vtkPoints(), vtkCellArray(), vtkCellArray()
    points.SetDataTypeToDouble()
    for p in CORNERS:
        points.InsertNextPoint(p)
    # Cells that no ray hits, before those that count.
    lines.InsertNextCell(2)
    lines.InsertCellPoint(0)
    lines.InsertCellPoint(7)
    for face in faces:
        polys.InsertNextCell(len(face))
        for k in face:
            polys.InsertCellPoint(k)
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetLines(lines)
    data.SetPolys(polys)
    ids, names = vtkIntArray(), vtkStringArray()
    ids.SetName("material_id")
    names.SetName("material_names")
    for i in range(1 + len(faces)):
        ids.InsertNextValue(0 if i == 0 else i % 2)
    for name in ("painted", "glazed"):
        names.InsertNextValue(name)
    data.GetCellData().AddArray(ids)
    data.GetFieldData().AddArray(names)
    return data


def canonical(triangles):
    """Triangles that differ in order or first corner only are equal."""
    rows = []
    for t in triangles.tolist():
        first = min(range(3), key=lambda k: t[k])
        rows.append(t[first] + t[(first + 1) % 3] + t[(first + 2) % 3])
    return np.array(sorted(rows))


class SceneObjects(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = cls.holder.name
        half = y_up(CORNERS) - [0.5, 0, 0]
        cls.save("box.obj", obj(CORNERS, TRIANGLES))
        cls.save("box.mtl", "newmtl painted\nKd 1 0 0\nnewmtl glazed\nKd 0 0 1\n")
        cls.save("quads.obj", obj(CORNERS, QUADS, ("painted", "glazed")))
        cls.save("box.stl", stl(CORNERS, TRIANGLES))
        cls.save("box.ply", ply(CORNERS, TRIANGLES))
        cls.save("box.gltf", gltf(half, TRIANGLES))
        cls.save("y.dae", collada(y_up(CORNERS), TRIANGLES, "Y_UP"))
        cls.save("z.dae", collada(CORNERS, TRIANGLES, "Z_UP"))
        cls.save("box.ac", ac3d(y_up(CORNERS), TRIANGLES))
        cls.save("box.ifc", ifc(CORNERS, TRIANGLES))
        with open(os.path.join(cls.folder, "box.3ds"), "wb") as file:
            file.write(three_ds(CORNERS, TRIANGLES))
        with gzip.open(os.path.join(cls.folder, "packed.obj.gz"), "wt") as file:
            file.write(obj(CORNERS, TRIANGLES))
        for writer, name in ((vtkXMLPolyDataWriter(), "box.vtp"), (vtkPolyDataWriter(), "box.vtk")):
            writer.SetFileName(os.path.join(cls.folder, name))
            writer.SetInputData(poly_data(TRIANGLES))
            if name.endswith("vtp"):
                writer.SetDataModeToBinary()
            writer.Write()
        cls.write_volume_and_blocks()

    @classmethod
    def write_volume_and_blocks(cls):
        """The box as one hexahedron, and as two blocks of half its triangles each."""
        grid = vtkUnstructuredGrid()
        grid.SetPoints(poly_data(TRIANGLES).GetPoints())
        grid.InsertNextCell(VTK_HEXAHEDRON, 8, (0, 1, 3, 2, 4, 5, 7, 6))
        blocks = vtkMultiBlockDataSet()
        blocks.SetBlock(0, poly_data(TRIANGLES[:6]))
        blocks.SetBlock(1, poly_data(TRIANGLES[6:]))
        for writer, name, data in ((vtkXMLUnstructuredGridWriter(), "box.vtu", grid),
                                   (vtkXMLMultiBlockDataWriter(), "box.vtm", blocks)):
            writer.SetFileName(os.path.join(cls.folder, name))
            writer.SetInputData(data)
            writer.SetDataModeToBinary()
            writer.Write()

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    @classmethod
    def save(cls, name, text):
        with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def read(self, *objects, silent=True, **keys):
        scene = {"version": 1, "material_map": {"*": "wall"}, "objects": list(objects), **keys}
        result = st.Read(st.write_scene(self.folder, "scene", scene))
        self.assertEqual(result.errors, [])
        if silent:
            self.assertEqual(result.warnings, [])
        return result

    def box(self, **keys):
        return st.corners(self.read({"file": "box.obj", **keys}).blocks[0])

    # --- formats

    def test_all_formats_give_the_same_box(self):
        expected = canonical(CORNERS[np.array(TRIANGLES)])
        for name in ("box.obj", "box.stl", "box.ply", "box.gltf", "y.dae", "z.dae", "packed.obj.gz", "box.3ds",
                     "box.ac", "box.ifc", "box.vtp", "box.vtk", "box.vtm"):
            with self.subTest(file=name):
                block = self.read({"file": name}).blocks[0]
                self.assertEqual(block.GetNumberOfPoints(), 8)
                triangles = st.corners(block)
                if name == "box.ifc":
                    # Assimp turns it by a matrix in single precision whose zeros are 4e-8.
                    triangles = triangles.round(6) + 0.0
                np.testing.assert_array_equal(canonical(triangles), expected)

    def test_polygons_and_outsides_of_volumes_are_triangulated(self):
        for name in ("quads.obj", "box.vtu"):
            triangles = st.corners(self.read({"file": name}).blocks[0])
            self.assertEqual(len(triangles), 12)
            self.assertTrue(st.is_closed(triangles))
            self.assertAlmostEqual(st.volume(triangles), 6, places=12)

    def test_up_axis_can_be_told(self):
        triangles = st.corners(self.read({"file": "y.dae", "up_axis": "z"}).blocks[0])
        np.testing.assert_array_equal(canonical(triangles), canonical(y_up(CORNERS)[np.array(TRIANGLES)]))

    # --- material names

    def test_names_are_mapped_by_the_first_pattern_that_fits(self):
        keys = {"material_map": {"p?inted": "metal", "paint*": "glass", "*": "wood"}}
        block = self.read({"file": "quads.obj"}, **keys).blocks[0]
        self.assertEqual(sorted(st.cells(block, "material_id")), 6 * [2] + 6 * [3])
        keys["material_map"] = {"paint*": "glass", "p?inted": "metal", "*": "wood"}
        block = self.read({"file": "quads.obj"}, **keys).blocks[0]
        self.assertEqual(sorted(st.cells(block, "material_id")), 6 * [1] + 6 * [3])

    def test_the_map_of_an_object_comes_first(self):
        block = self.read({"file": "quads.obj", "material_map": {"glazed": "Glass"}}).blocks[0]
        self.assertEqual(sorted(st.cells(block, "material_id")), 6 * [0] + 6 * [1])

    def test_material_of_an_object_overrides_names(self):
        block = self.read({"file": "quads.obj", "material": "WOOD"}).blocks[0]
        self.assertEqual(set(st.cells(block, "material_id")), {3})
        np.testing.assert_array_equal(st.cells(block, "kd"), 0.107)

    def test_names_in_vtk_files(self):
        for name in ("box.vtp", "box.vtk"):
            block = self.read({"file": name, "material_map": {"glazed": "glass"}}).blocks[0]
            self.assertEqual(sorted(st.cells(block, "material_id")), 6 * [0] + 6 * [1])

    def test_unmapped_names_are_wall_and_said_once(self):
        scene = self.read({"file": "quads.obj", "name": "A"}, {"file": "quads.obj", "name": "B"}, {"file": "box.stl"},
                          {"ground": {"size": 10}}, silent=False, material_map={"glazed": "glass"})
        self.assertEqual(len(scene.warnings), 1)
        self.assertIn('"painted"', scene.warnings[0])
        self.assertIn("Ground: taken as Wall", scene.warnings[0])
        self.assertEqual(scene.warnings[0].count("painted"), 1)
        self.assertEqual(sorted(st.cells(scene.blocks[1], "material_id")), 6 * [0] + 6 * [1])

    def test_own_materials_follow_the_four(self):
        materials = {"Grass": {"kd": 0.2}, "wood": {"kd": 0.3, "ks": 0.1, "kp": 5}, "Ice": {"kd": 0, "ks": 1, "kp": 1e6}}
        scene = self.read({"file": "box.obj", "material": "ice"}, {"file": "box.obj", "material": "wood"},
                          {"file": "box.obj", "material": "grass"}, materials=materials)
        self.assertEqual(scene.strings("material_names"), ["Wall", "Glass", "Metal", "Wood", "Grass", "Ice"])
        self.assertEqual([set(st.cells(b, "material_id")) for b in scene.blocks], [{5}, {3}, {4}])
        self.assertEqual([st.cells(b, "kd")[0] for b in scene.blocks], [0, 0.3, 0.2])
        self.assertEqual([st.cells(b, "kp")[0] for b in scene.blocks], [1e6, 5, 1])

    # --- placement

    def test_scale_then_rotation_then_position(self):
        got = self.box(scale=[1, 2, 3], rotation=90, position=[100, 200, 300])
        scaled = CORNERS * [1, 2, 3]
        expected = np.column_stack([scaled[:, 1], -scaled[:, 0], scaled[:, 2]]) + [100, 200, 300]
        np.testing.assert_allclose(canonical(got.round(9)), canonical(expected[np.array(TRIANGLES)]), atol=1e-9)

    def test_yaw_turns_north_clockwise(self):
        # The model's north edge direction, from a corner to the next along y.
        for yaw in (0, 30, 90, 200, -45):
            got = self.box(rotation=yaw)
            matrix = [[math.cos(math.radians(yaw)), math.sin(math.radians(yaw)), 0],
                      [-math.sin(math.radians(yaw)), math.cos(math.radians(yaw)), 0], [0, 0, 1]]
            expected = CORNERS[np.array(TRIANGLES)] @ np.array(matrix).T
            np.testing.assert_allclose(got, expected, atol=1e-12)
            np.testing.assert_allclose(np.array(matrix) @ [0, 1, 0],
                                       [math.sin(math.radians(yaw)), math.cos(math.radians(yaw)), 0], atol=1e-12)

    def test_direction_is_where_north_goes(self):
        level = [math.sin(math.radians(30)), math.cos(math.radians(30)), 0]
        np.testing.assert_allclose(self.box(rotation=[5 * c for c in level]), self.box(rotation=30), atol=1e-12)
        direction = np.array([1, 2, 0.5]) / math.sqrt(5.25)
        got, start = self.box(rotation=[1, 2, 0.5]), CORNERS[np.array(TRIANGLES)]
        # Six points and their images fix the matrix.
        matrix = np.linalg.lstsq(start.reshape(-1, 3), got.reshape(-1, 3), rcond=None)[0].T
        np.testing.assert_allclose(matrix @ [0, 1, 0], direction, atol=1e-12)
        np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
        self.assertAlmostEqual(np.linalg.det(matrix), 1, places=12)
        self.assertAlmostEqual((matrix @ [1, 0, 0])[2], 0, places=12)
        self.assertGreater((matrix @ [0, 0, 1])[2], 0.9)

    def test_matrix(self):
        matrix = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
        np.testing.assert_allclose(self.box(rotation=matrix), CORNERS[np.array(TRIANGLES)] @ np.array(matrix).T,
                                   atol=1e-12)

    def test_geodetic_place_equals_the_same_place_in_metres(self):
        origin = {"latitude": 31.1979, "longitude": 121.3363, "height": 3}
        place = {"latitude": 31.3, "longitude": 121.6, "height": 70}
        got = st.corners(self.read({"file": "box.obj", "geodetic": place, "rotation": 20}, origin=origin).blocks[0])
        position, rotation = self.frame(origin, place)
        yaw = math.radians(20)
        turn = np.array([[math.cos(yaw), math.sin(yaw), 0], [-math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
        expected = st.corners(self.read({"file": "box.obj", "position": position.tolist(),
                                         "rotation": (rotation @ turn).tolist()}, origin=origin).blocks[0])
        np.testing.assert_allclose(got, expected, atol=1e-8)
        # 27 km away up leans by a quarter of a degree: 13 mm at the top of this box.
        upright = st.corners(self.read({"file": "box.obj", "position": position.tolist(), "rotation": 20},
                                       origin=origin).blocks[0])
        self.assertGreater(abs(got - upright).max(), 0.01)

    @staticmethod
    def frame(origin, place):
        """Position and rotation of the tangent frame of a place in that of the origin, by ECEF."""
        def ecef(p):
            a, f = 6378137.0, 1 / 298.257223563
            lat, lon = math.radians(p["latitude"]), math.radians(p["longitude"])
            n = a / math.sqrt(1 - f * (2 - f) * math.sin(lat) ** 2)
            return np.array([(n + p["height"]) * math.cos(lat) * math.cos(lon),
                             (n + p["height"]) * math.cos(lat) * math.sin(lon),
                             (n * (1 - f) ** 2 + p["height"]) * math.sin(lat)])

        def axes(p):
            lat, lon = math.radians(p["latitude"]), math.radians(p["longitude"])
            return np.array([[-math.sin(lon), math.cos(lon), 0],
                             [-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat)],
                             [math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat)]])

        return axes(origin) @ (ecef(place) - ecef(origin)), axes(origin) @ axes(place).T

    def test_projected_coordinates(self):
        origin = {"latitude": 48.7608, "longitude": 11.4235, "height": 412}
        offset = np.array([678016, 5403455, 412])
        got = st.corners(self.read({"file": "box.obj", "crs": "EPSG:32632", "position": offset.tolist()},
                                   origin=origin).blocks[0])
        lines = "".join("%.6f %.6f %.6f\n" % tuple(c + offset) for c in CORNERS)
        text = subprocess.run(["cs2cs", "-f", "%.12f", "EPSG:32632", "EPSG:4979"], input=lines, text=True,
                              capture_output=True, check=True).stdout
        expected = []
        for line in text.splitlines():
            lat, lon, _ = map(float, line.split())
            place = {"latitude": lat, "longitude": lon, "height": 0}
            expected.append(place)
        for place, corner in zip(expected, CORNERS):
            place["height"] = corner[2] + offset[2]
        local = np.array([self.frame(origin, p)[0] for p in expected])
        np.testing.assert_allclose(got, local[np.array(TRIANGLES)], atol=1e-6)

    # --- footprints

    def plan(self, file, *features, **keys):
        """Features (kind, coordinates, properties) in metres, and a scene of them."""
        self.save(file, json.dumps({"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": p, "geometry": {"type": kind, "coordinates": c}}
            for kind, c, p in features]}))
        return self.read({"footprints": file, "crs": "local", **keys})

    SQUARE = [[0, 0], [20, 0], [20, 10], [0, 10], [0, 0]]
    HOLE = [[5, 2], [5, 8], [15, 8], [15, 2], [5, 2]]

    def test_courtyards_are_open(self):
        for rings in ([self.SQUARE, self.HOLE], [self.SQUARE[::-1], self.HOLE[::-1]]):
            block = self.plan("court.geojson", ("Polygon", rings, {}), height=4, base=1).blocks[0]
            triangles = st.corners(block)
            self.assertTrue(st.is_closed(triangles))
            self.assertAlmostEqual(st.volume(triangles), (200 - 60) * 4, places=9)
            self.assertEqual((triangles[:, :, 2].min(), triangles[:, :, 2].max()), (1, 5))

    def test_several_polygons_crossing_rings_and_repeated_vertices(self):
        other = [[[30, 0], [40, 0], [40, 0], [40, 10], [30, 10], [30, 0]]]
        scene = self.plan("multi.geojson", ("MultiPolygon", [[self.SQUARE], other], {}), height=2)
        self.assertAlmostEqual(st.volume(st.corners(scene.blocks[0])), 600, places=9)
        bow = [[0, 0], [10, 10], [10, 0], [0, 10], [0, 0]]
        scene = self.plan("bow.geojson", ("Polygon", [bow], {}), height=2)
        self.assertAlmostEqual(st.volume(st.corners(scene.blocks[0])), 2 * 50, places=9)
        self.assertIn("1 footprints with crossing or overlapping rings were repaired",
                      " ".join(scene.strings("scene_report")))

    def test_glazing_shares_of_every_size(self):
        for share in (0.01, 0.3, 0.9, 0.97, 0.999, 1):
            for bay in (0.7, 6, 1000):
                with self.subTest(share=share, bay=bay):
                    block = self.plan("glazed.geojson", ("Polygon", [self.SQUARE, self.HOLE], {}), height=4,
                                      roof_material="wood", glazing={"share": share, "bay": bay}).blocks[0]
                    triangles, material = st.corners(block), st.cells(block, "material_id")
                    area = st.areas(triangles)
                    self.assertTrue(st.is_closed(triangles))
                    self.assertAlmostEqual(st.volume(triangles), 560, places=8)
                    self.assertAlmostEqual(area[material == 1].sum(), share * (60 + 32) * 4, places=8)
                    self.assertAlmostEqual(area[material == 3].sum(), 2 * 140, places=8)

    def test_lines_become_strips(self):
        scene = self.plan("road.geojson", ("LineString", [[0, 0], [100, 0], [100, 50]], {"w": "8 m"}), flat=True,
                          base=0.5, width_attribute="w", width=3)
        triangles = st.corners(scene.blocks[0])
        self.assertAlmostEqual(st.areas(triangles).sum(), 8 * 150, places=9)
        self.assertEqual(set(triangles[:, :, 2].ravel()), {0.5})
        self.assertTrue((st.normals(triangles)[:, 2] > 0).all())

    def test_attributes(self):
        features = [("Polygon", [self.SQUARE], {"kind": "house", "h": "7.5 m", "label": "A", "n": 2}),
                    ("Polygon", [self.SQUARE], {"kind": "hut", "h": None, "label": "", "n": 3}),
                    ("Polygon", [self.SQUARE], {"kind": "house", "h": "two storeys", "n": 2}),
                    ("Point", [0, 0], {"kind": "house", "n": 2})]
        options = {"height_attribute": "h", "height": 3, "name_attribute": "label", "name": "House"}
        scene = self.plan("town.geojson", *features, features="separate", **options)
        self.assertEqual(scene.names, ["A", "House 2", "House 3"])
        self.assertEqual([st.corners(b)[:, :, 2].max() for b in scene.blocks], [7.5, 3, 3])
        report = " ".join(scene.strings("scene_report"))
        self.assertIn("House: 2 features have no usable height attribute", report)
        self.assertIn("House: 1 points were left out", report)
        scene = self.plan("town.geojson", *features, **options)
        self.assertEqual((scene.names, scene.blocks[0].GetNumberOfCells()), (["House"], 36))
        for chosen, count in (({"kind": "ho*"}, 2), ({"label": "*"}, 2), ({"kind": "h*", "n": 3}, 1)):
            scene = self.plan("town.geojson", *features, filter=chosen, **options)
            self.assertEqual(scene.blocks[0].GetNumberOfCells(), 12 * count, msg=chosen)

    def test_tags_of_a_raw_osm_file(self):
        nodes = [(1, 0, 0), (2, 0, 0.001), (3, 0.001, 0.001), (4, 0.001, 0)]
        self.save("town.osm", '<osm version="0.6">' + "".join(
            f'<node id="{i}" lat="{lat}" lon="{lon}" version="1"/>' for i, lat, lon in nodes)
            + '<way id="9" version="1">' + "".join(f'<nd ref="{i}"/>' for i in (1, 2, 3, 4, 1))
            + '<tag k="building" v="yes"/><tag k="height" v="33"/></way></osm>')
        scene = self.read({"footprints": "town.osm", "layer": "multipolygons", "filter": {"building": "*"},
                           "height_attribute": "height"}, origin={"latitude": 0, "longitude": 0, "height": 0})
        triangles = st.corners(scene.blocks[0])
        self.assertEqual(triangles[:, :, 2].max(), 33)
        # A thousandth of a degree on the equator: 111.3195 m along it, 110.5743 m across.
        self.assertAlmostEqual(triangles[:, :, 0].max(), 111.3195, places=3)
        self.assertAlmostEqual(triangles[:, :, 1].max(), 110.5743, places=3)

    # --- what is said, and what is not

    def test_lidar_inside_or_under(self):
        inside = {"lidar": {"position": [1.5, 3, 1]}}
        scene = self.read({"file": "box.obj", "name": "Box"}, silent=False, **inside)
        self.assertEqual(len(scene.warnings), 1)
        self.assertIn("the lidar is inside Box", scene.warnings[0])
        inside["lidar"]["inside"] = True
        self.read({"file": "box.obj", "name": "Box"}, **inside)
        scene = self.read({"ground": {"size": 100}}, silent=False, lidar={"position": [0, 0, -1]})
        self.assertIn("the lidar is under the scene", scene.warnings[0])
        # Under a roof is no fault.
        self.read({"ground": {"size": 100}}, {"ground": {"size": 10, "height": 5}}, lidar={"position": [0, 0, 1]})

    def test_far_away_is_said(self):
        scene = self.read({"file": "box.obj", "position": [678016, 5403455, 412]}, silent=False)
        self.assertEqual(len(scene.warnings), 1)
        self.assertIn("box reaches more than 100 km from the origin", scene.warnings[0])

    def test_extents_and_degenerate_triangles_are_reported(self):
        self.save("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 3 1\nf 1 2 3\nf 1 2 4\nf 1 1 4\n")
        scene = self.read({"file": "flat.obj", "name": "Flat"})
        self.assertIn("Flat: 3 triangles, 2 degenerate, east 0.00 to 2.00, north 0.00 to 3.00, up 0.00 to 1.00 m",
                      scene.strings("scene_report"))

    def test_a_scene_of_nothing(self):
        scene = self.read()
        self.assertEqual((scene.blocks, scene.names), ([], []))

    def test_abort_leaves_an_empty_output(self):
        scene = self.read({"file": "box.obj"}, {"file": "box.obj"})
        seen = []

        def stop(reader, _):
            seen.append(reader.GetProgress())
            if reader.GetProgress() > 0.3:
                reader.SetAbortExecute(1)

        tag = scene.reader.AddObserver("ProgressEvent", stop)
        scene.reader.Modified()
        scene.reader.Update()
        self.assertEqual(scene.reader.GetOutput().GetNumberOfBlocks(), 0)
        self.assertEqual(scene.errors, [])
        self.assertTrue(any(0 < share < 1 for share in seen))
        scene.reader.RemoveObserver(tag)
        scene.reader.SetAbortExecute(0)
        scene.reader.Modified()
        scene.reader.Update()
        self.assertEqual(scene.reader.GetOutput().GetNumberOfBlocks(), 2)

    def test_which_files_are_scenes(self):
        can = st.vtkAvianLidarSceneReader.CanReadFile
        self.assertEqual(can(st.SHIPPED), 1)
        self.assertEqual(can(os.path.join(self.folder, "box.obj")), 0)
        self.assertEqual(can(os.path.join(self.folder, "none.lidarscene.json")), 0)
        self.assertEqual(can(self.folder), 0)


if __name__ == "__main__":
    unittest.main()
