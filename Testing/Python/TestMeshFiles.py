# SPDX-License-Identifier: BSD-3-Clause
"""Mesh files as other programs write them: units and extensions that a file names, coordinates of national grids, and
the program that reads them. Expected: the corners that were written, in metres."""
import json
import os
import pathlib
import re
import stat
import struct
import subprocess
import unittest
import unittest.mock

import numpy as np
import scenetools as st
from boxfiles import CORNERS, TRIANGLES, gltf, gltf_document, ifc, with_buffer
from echotools import InFolder
from avianlidar import vtkAvianLidar
from scipy.spatial.distance import cdist
from scipy.spatial.transform import Rotation

SINGLE = 2**-23


def fbx(centimetres):
    """One triangle in FBX's text."""
    return f"""; FBX 7.4.0 project file
FBXHeaderExtension:  {{
	FBXVersion: 7400
}}
GlobalSettings:  {{
	Version: 1000
	Properties70:  {{
		P: "UnitScaleFactor", "double", "Number", "",{centimetres}
	}}
}}
Objects:  {{
	Geometry: 10, "Geometry::", "Mesh" {{
		Vertices: *9 {{
			a: 0,0,0,200,0,0,0,300,0
		}}
		PolygonVertexIndex: *3 {{
			a: 0,1,-3
		}}
		GeometryVersion: 124
	}}
	Model: 20, "Model::box", "Mesh" {{
		Version: 232
	}}
}}
Connections:  {{
	C: "OO",20,0
	C: "OO",10,20
}}
"""


def instanced(**attributes):
    """A node with instances of the mesh. @param attributes numbers of their accessors"""
    return {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}}


class MeshFiles(InFolder):
    def setUp(self):
        super().setUp()
        self.enterContext(unittest.mock.patch.dict(os.environ))

    def read(self, name, text=None, **more):
        if text is not None:
            (self.folder / name).write_text(text, encoding="utf-8")
        return st.Read(st.write_scene(self.folder, name, {"version": 1, "objects": [
            {"name": "Box", "file": name, "material": "Wall", **more}]}))

    def places(self, read):
        self.assertEqual(read.errors, [])
        return np.unique(st.corners(read.block("Box")).reshape(-1, 3), axis=0)

    def assert_box(self, read, unit):
        self.assertEqual(read.warnings, [])
        np.testing.assert_allclose(self.places(read), unit * np.unique(CORNERS, axis=0), atol=4 * SINGLE * unit
                                   * np.abs(CORNERS).max())

    def assert_refused(self, read, words):
        self.assertEqual(len(read.errors), 1, read.errors)
        self.assertIn(words, read.errors[0])

    def assert_left_out(self, read, words):
        self.assertEqual(read.errors, [])
        self.assertTrue(any(words in warning for warning in read.warnings), read.warnings)

    def test_formats_that_are_refused(self):
        """By the extension, packed too, with the command that converts the file."""
        whole = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
        for ending in (".3mf", ".amf", ".nff", ".off", ".ogex", ".x3d"):
            for name in ("box" + ending, "BOX" + ending.upper(), f"box{ending}.gz"):
                read = self.read(name, whole)
                self.assert_refused(read, f'{name}: is of a format that is not read: convert it to OBJ with')
                self.assert_refused(read, f'"assimp export in{ending} out.obj"')

    def test_fbx_units_become_metres(self):
        places = self.places(self.read("triangle.fbx", fbx(2.54), up_axis="z"))
        np.testing.assert_allclose(places, 0.0254 * np.array([[0, 0, 0], [0, 300, 0], [200, 0, 0]]), rtol=2 * SINGLE)

    IFC = ifc(CORNERS, TRIANGLES)  # in metres
    UNIT = next(line for line in IFC.splitlines() if ".LENGTHUNIT." in line)
    NAME = UNIT.split("=")[0].strip()
    CONVERTED = (f"#901=IFCSIUNIT(*,.LENGTHUNIT.,{{}},.METRE.);\n"
                 f"#902=IFCMEASUREWITHUNIT(IFCLENGTHMEASURE({{}}),#901);\n"
                 "#903=IFCDIMENSIONALEXPONENTS(1,0,0,0,0,0,0);\n"
                 f"{NAME}=IFCCONVERSIONBASEDUNIT(#903,.LENGTHUNIT.,'{{}}',#902);")
    FOOT = IFC.replace(UNIT, CONVERTED.format("$", "0.3048", "FOOT"))

    def test_ifc_units_become_metres(self):
        foot = self.CONVERTED.format("$", "3.048E-1", "FOOT")
        for written, length in ((self.UNIT, 1.0), (self.UNIT.replace(",$,", ",.MILLI.,"), 1e-3),
                                (self.CONVERTED.format(".MILLI.", "25.4", "INCH"), 0.0254),
                                (foot.replace("#902=", "#902 = ").replace("(IFCL", "( IFCL"), 0.3048)):
            with self.subTest(unit=written):
                read = self.read("box.ifc", self.IFC.replace(self.UNIT, written), up_axis="y")
                self.assertEqual(read.warnings, [])
                np.testing.assert_allclose(np.sort(np.ptp(self.places(read), axis=0)),
                                           np.sort(length * np.ptp(CORNERS, axis=0)), rtol=1e-5)

    def test_ifc_units_are_those_of_the_project(self):
        """Keywords in any case, comments, words in strings, assignments that nobody uses; units that are not of the
        standard's."""
        first = self.FOOT.index("DATA;") + 5
        lower = re.sub("(IFCCONVERSIONBASEDUNIT|IFCUNITASSIGNMENT|IFCMEASUREWITHUNIT)", lambda found: found[0].title(),
                       self.FOOT)
        for text in (lower, self.FOOT[:first] + "\n/* #8=IFCUNITASSIGNMENT(()); */" + self.FOOT[first:],
                     self.FOOT[:first] + "\n#910=IFCUNITASSIGNMENT((#901));" + self.FOOT[first:]):
            np.testing.assert_allclose(np.ptp(self.places(self.read("box.stp", text)), axis=0),
                                       0.3048 * np.ptp(CORNERS, axis=0), rtol=1e-5)
        strange = ("#903=IFCDIMENSIONALEXPONENTS(1,0,0,0,0,0,0);\n"
                   f"{self.NAME}=IFCCONTEXTDEPENDENTUNIT(#903,.LENGTHUNIT.,'CUBIT');")
        self.assert_refused(self.read("box.ifc", self.IFC.replace(self.UNIT, strange)),
                            f"has a unit of length, {self.NAME}, that cannot be read")

    def test_what_assimp_leaves_out_is_a_warning(self):
        broken = gltf(np.asarray(CORNERS), [*TRIANGLES[:-1], (0, 1, 77)])
        self.assert_left_out(self.read("box.gltf", broken),
                             'Assimp may have left out something: "Some faces had out-of-range indices')
        whole = ifc(np.asarray(CORNERS), TRIANGLES)
        self.assert_box(self.read("box.ifc", whole), 1.0)
        more = ("#901=IFCPRODUCTDEFINITIONSHAPE($,$,(#902));\n#902=IFCSHAPEREPRESENTATION(#5,'Body','CSG',(#903));\n"
                "#903=IFCBLOCK(#4,1.,1.,1.);\n"
                "#904=IFCBUILDINGELEMENTPROXY('0000000000000000000004',#14,'tank; (one)',$,$,#6,#901,$,$);\n"
                "#907=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000007',#14,$,$,(#904),#7);\n")
        end = whole.rindex("ENDSEC;")
        self.assert_left_out(self.read("box.ifc", whole[:end] + more + whole[end:]),
                             "elements have no triangles and are left out: 1 IFCBUILDINGELEMENTPROXY")

    def test_ifc4(self):
        """What is as in IFC 2x3 is read. A refusal names the schema and the shape."""
        whole = self.IFC.replace("IFC2X3", "IFC4")
        self.assert_box(self.read("box.ifc", whole), 1.0)
        end = whole.rindex("ENDSEC;")
        points = "#951=IFCCARTESIANPOINTLIST3D((" + ",".join("({!r},{!r},{!r})".format(*map(float, corner))
                                                             for corner in CORNERS) + "));\n"
        for shape, item in (("IFCTRIANGULATEDFACESET", "#951,$,.T.,((1,2,3)),$"), ("IFCADVANCEDBREP", "#13")):
            more = points + (f"#952={shape}({item});\n#901=IFCPRODUCTDEFINITIONSHAPE($,$,(#902));\n"
                             "#902=IFCSHAPEREPRESENTATION(#5,'Body','Tessellation',(#952));\n"
                             "#904=IFCWALL('0000000000000000000004',#14,'wall',$,$,#6,#901,$,.SOLIDWALL.);\n")
            self.assert_refused(self.read("box.ifc", whole[:end] + more + whole[end:]),
                                f"box.ifc: is written in the schema IFC4 and has a {shape}, which Assimp cannot read: "
                                "export it as IFC2X3")
        for name in ("IFC4", "IFC4X3_ADD2"):
            self.assert_refused(self.read("box.ifc",
                                          self.IFC.replace("IFC2X3", name).replace(",#14,'site'", ",$,'site'")),
                                f"is written in the schema {name}, expected IFC2X3. Assimp cannot read it: ")

    def test_the_axes_that_fbx_says(self):
        right, up, away = np.array([[0, 200, 0], [0, 0, 300], [0, 0, 0]])  # of the three points in what a viewer sees
        x, y, z = np.array([[0, 200, 0], [0, 0, 300], [0, 0, 0]])  # in the file
        for axes, expected in (((), (right, away, up)), ((("Up", 2, 1),), (x, y, z)),
                               ((("Up", 2, 1), ("Front", 0, 1), ("Coord", 1, 1)), (y, -x, z)),
                               ((("Up", 1, -1), ("Front", 2, 1), ("Coord", 0, -1)), (-x, -z, -y)),
                               ((("Up", 0, 1), ("Front", 2, 1), ("Coord", 1, -1)), (-y, -z, x))):
            said = "".join(f'\n\t\tP: "{name}Axis", "int", "Integer", "",{axis}\n'
                           f'\t\tP: "{name}AxisSign", "int", "Integer", "",{sign}' for name, axis, sign in axes)
            read = self.read("triangle.fbx", fbx(100).replace("\tProperties70:  {", "\tProperties70:  {" + said, 1))
            np.testing.assert_allclose(self.places(read), np.unique(np.column_stack(expected), axis=0), rtol=2 * SINGLE,
                                       err_msg=str(axes))
        x_up = fbx(100).replace("\tProperties70:  {", '\tProperties70:  {\n\t\tP: "UpAxis", "int", "Integer", "",0', 1)
        self.assert_refused(self.read("triangle.fbx", x_up),
                            "says that x points up, and not which axes point right and to the front")

    def test_gltf_poses_are_warnings(self):
        document = json.loads(gltf(np.asarray(CORNERS), TRIANGLES))
        for key, value, words in (("skins", [{"joints": [0]}], "has skins, which are left out"),
                                  ("meshes", [{**document["meshes"][0], "weights": [0, 1]}],
                                   "weights of morph targets, which are left out")):
            read = self.read("box.gltf", json.dumps({**document, key: value}))
            self.assertEqual(len(self.places(read)), 8)
            self.assert_left_out(read, words)
        latin = json.dumps({"asset": {"version": "2.0", "generator": "X"},
                            "extensionsRequired": ["VENDOR_unheard_of"]}).encode()
        (self.folder / "box.gltf").write_bytes(latin.replace(b'"X"', b'"\xe9"'))
        self.assert_refused(self.read("box.gltf"), "VENDOR_unheard_of")

    def test_gltf_extensions_that_change_geometry_are_refused_by_name(self):
        for key, name, refused in (("Required", "EXT_meshopt_compression", True),
                                   ("Required", "VENDOR_unheard_of", True), ("Used", "CESIUM_RTC", True),
                                   ("Used", "VENDOR_unheard_of", False), ("Required", "KHR_materials_unlit", False)):
            with self.subTest(key=key, name=name):
                document = json.loads(gltf(np.asarray(CORNERS), TRIANGLES))
                document["extensions" + key] = [name]
                read = self.read("box.gltf", json.dumps(document))
                if refused:
                    self.assert_refused(read, f"s the glTF extension {name}, which is not supported")
                else:
                    self.assertEqual(len(self.places(read)), 8)

    def gltf_of(self, parts, indices, nodes, form="data", **accessor):
        """A file of a glTF document. @param form where the buffer is: in the JSON, in a file whose name has a blank, or
        in a binary file. @return its name"""
        document, blob = gltf_document(parts, indices, nodes, **accessor)
        document["extensionsRequired"] = ["KHR_mesh_quantization", "EXT_mesh_gpu_instancing"]
        document["materials"] = [{"name": "glänzend"}]
        document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 0
        if form == "binary":
            text = json.dumps(document).encode()
            text += b" " * (-len(text) % 4)
            head = struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(blob), len(text), 0x4E4F534A)
            (self.folder / "box.glb").write_bytes(head + text + struct.pack("<II", len(blob), 0x004E4942) + blob)
            return "box.glb"
        if form == "file":
            (self.folder / "ein Puffer.bin").write_bytes(blob)
        (self.folder / "box.gltf").write_text(with_buffer(document, "ein%20Puffer.bin" if form == "file" else blob))
        return "box.gltf"

    def test_gltf_quantized_positions(self):
        """Expected: the extension's table of what a normalized number c stands for, times the node's scale."""
        box = np.asarray(CORNERS) / np.abs(CORNERS).max()
        for kind, most in (("i1", 127), ("u1", 255), ("i2", 32767), ("u2", 65535)):
            low = -1.0 if kind[0] == "i" else 0.0
            codes = np.round((box.clip(low) * most)).astype(kind)
            for normalized in (True, False):
                for form in ("data", "file", "binary"):
                    with self.subTest(kind=kind, normalized=normalized, form=form):
                        scale = [8.0, 4.0, 2.0] if normalized else [8.0 / most, 4.0 / most, 2.0 / most]
                        name = self.gltf_of([codes], TRIANGLES,
                                            [{"mesh": 0, "scale": scale, "translation": [0.0, 0.0, -3.0]}], form,
                                            normalized=normalized)
                        read = self.read(name, up_axis="z")
                        expected = codes / most * (8.0, 4.0, 2.0) - (0.0, 0.0, 3.0)
                        np.testing.assert_allclose(self.places(read), np.unique(expected, axis=0), atol=1e-5)
        sparse = {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
                  "values": {"bufferView": 0, "byteOffset": 8}}
        codes = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0]], dtype="i2")
        name = self.gltf_of([codes], [0, 1, 2], [{"mesh": 0}], sparse=sparse)
        # vertex 0 lies at vertex 1
        np.testing.assert_array_equal(self.places(self.read(name, up_axis="z")), [[0, 9, 0], [9, 0, 0]])

    def test_gltf_instances(self):
        """Expected: the matrices T R S of the extension, below the matrix of the node. An instance without one of them
        has the identity."""
        box = np.asarray(CORNERS, dtype="f4")
        at = np.array([[10, 0, 0], [0, 20, 0], [0, 0, 30]], dtype="f4")
        quarter = np.sqrt(0.5)
        turns = np.array([[0, 0, 0, 1], [0, 0, quarter, quarter], [1, 0, 0, 0]])
        sizes = np.array([[1, 1, 1], [2, 1, 1], [1, 3, 1]], dtype="f4")
        for parts, turn in (({"TRANSLATION": at, "ROTATION": turns.astype("f4"), "SCALE": sizes}, turns),
                            ({"TRANSLATION": at}, None),
                            ({"TRANSLATION": at, "ROTATION": np.round(turns * 32767).astype("i2")}, turns)):
            with self.subTest(sorted(parts)):
                names = list(parts)
                node = {**instanced(**{name: 1 + i for i, name in enumerate(names)}), "translation": [0, 0, 5]}
                name = self.gltf_of([box, *parts.values()], TRIANGLES, [node])
                if parts.get("ROTATION", at).dtype != "f4":
                    document = json.loads((self.folder / name).read_text())
                    document["accessors"][1 + names.index("ROTATION")]["normalized"] = True
                    (self.folder / name).write_text(json.dumps(document))
                expected = []
                for k in range(3):
                    corners = box * (sizes[k] if "SCALE" in parts else 1.0)
                    corners = corners if turn is None else Rotation.from_quat(turn[k]).apply(corners)
                    expected.append(corners + at[k] + (0, 0, 5))
                found = self.places(self.read(name, up_axis="z"))
                expected = np.concatenate(expected)
                self.assertEqual(cdist(found, expected).min(axis=1).max() < 2e-3
                                 and cdist(expected, found).min(axis=1).max() < 2e-3, True)

    def test_gltf_that_is_broken(self):
        codes = np.zeros((3, 3), dtype="i2")
        for parts, nodes, more, words in (
                ([codes], [{"mesh": 0}], {"count": 1 << 40},
                 "an accessor of 1099511627776 elements reaches beyond its buffer"),
                ([codes], [{"mesh": 0}], {"byteOffset": 999}, "reaches beyond its buffer"),
                ([codes], [{"mesh": 0}], {"count": -3}, "count is -3, expected a whole number of 0 or more"),
                ([codes], [{"mesh": 0}], {"componentType": 5130}, "has numbers of the component type 5130"),
                ([codes], [{"mesh": 0}], {"type": "VEC2"}, 'is of the type "VEC2", expected "VEC3"'),
                ([codes, codes[:, :2]], [instanced(TRANSLATION=1)], {}, 'is of the type "VEC2", expected "VEC3"'),
                ([codes], [instanced()], {}, "instances have no TRANSLATION, ROTATION or SCALE"),
                ([codes], [instanced(SCALE=77)], {}, "SCALE of instances is 77")):
            with self.subTest(words):
                self.assert_refused(self.read(self.gltf_of(parts, [0, 1, 2], nodes, **more)), words)
        (self.folder / "short.glb").write_bytes(struct.pack("<4sIIII", b"glTF", 2, 0xFFFFFFFF, 0xFFFFFFF0, 0x4E4F534A)
                                                + b"{}")
        self.assert_refused(self.read("short.glb"), "is cut short: it says that it has 4294967295 bytes and has 22")
        name = self.gltf_of([codes], [0, 1, 2], [{"mesh": 0}], "file")
        (self.folder / "ein Puffer.bin").unlink()
        self.assert_refused(self.read(name), "names the file ein%20Puffer.bin, which cannot be read")

    def test_gltf_buffers_of_other_folders(self):
        """Each name leads to a whole buffer. A name that passes through a folder inside is read."""
        corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="f4")
        name = self.gltf_of([corners], [0, 1, 2], [{"mesh": 0}], "file")
        extensions = '"KHR_mesh_quantization", "EXT_mesh_gpu_instancing"'
        text = (self.folder / name).read_text(encoding="utf-8").replace(extensions, "")
        (self.folder / "a").mkdir()
        for step in ("../", "%2e%2e/", "..%2F", "./a/../../", str(self.folder.parent) + "/", "..\\\\"):
            uri = f"{step}{self.folder.name}/ein%20Puffer.bin"
            (self.folder / name).write_text(text.replace("ein%20Puffer.bin", uri), encoding="utf-8")
            self.assert_refused(self.read(name), f'names the buffer "{uri}", which is not in its folder')
        for step in ("", "./", "a/../"):
            (self.folder / name).write_text(text.replace("ein%20Puffer.bin", f"{step}ein%20Puffer.bin"),
                                            encoding="utf-8")
            self.assertEqual(len(self.places(self.read(name, up_axis="z"))), 3, step)

    def test_obj_keeps_coordinates_of_a_national_grid(self):
        """Two walls 0.2 m apart in UTM, where single precision keeps 0.5 m: Expected: their doubles."""
        walls = np.array([(412345.17 + across, 5941234.56 + along, up) for across in (0.0, 0.2)
                          for along, up in ((0, 0), (5, 0), (5, 3))])
        for form, more in (("{:.2f} {:.2f} {:.2f}", ""), ("{:.2f}  {:.2f}\t{:.2f} 0.5 0.5 0.5", ""),
                           ("{:.2f} {:.2f} {:.2f} 1.0", ""),
                           ("{:.9e} {:.9e} +{:.2f}", "# comment\nvn 0 0 1\n"), ("{:.2f} {:.2f} {:.2f}\r", "\ufeff")):
            text = more + "".join("v " + form.format(*corner) + "\n" for corner in walls) + "f 1 2 3\nf 4 5 6"
            if form.endswith("\r"):  # the line ends of old Macintosh, and a byte-order mark
                text = text.replace("\r\n", "\r").replace("\n", "\r")
            (self.folder / "walls.obj").write_bytes(text.encode())
            read = self.read("walls.obj")
            np.testing.assert_allclose(self.places(read), np.unique(walls, axis=0), atol=6e-3 if "e}" in form else 1e-6)
            self.assertFalse(any("single precision" in words for words in read.warnings))

    def test_coordinates_that_lose_a_centimetre_are_a_warning(self):
        head = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
                "element face 1\n"
                "property list uchar int vertex_indices\nend_header\n")
        for far, scale, warned in ((60000.0, 1.0, False), (60000.0, 10.0, True)):
            read = self.read("far.ply", head + f"{far} 0 0\n{far} 5 0\n{far} 5 3\n3 0 1 2\n", scale=scale)
            self.assertEqual(any("Box: its coordinates are so large that single precision" in words
                                 for words in read.warnings), warned, (far, scale))

    def program(self, text):
        file = self.folder / "reader"
        file.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
        os.environ["AVIANLIDAR_MESH_READER"] = str(file)

    def test_whatever_the_program_does_is_one_error(self):
        (self.folder / "box.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
        for text, words in (("kill -SEGV $$", "Assimp cannot read it: it crashes on the file (Segmentation fault)"),
                            ("exit 3", "Assimp cannot read it: the program that reads meshes ended early"),
                            ("printf n", "there is not enough memory for it"),
                            ("printf 'e\\003\\0\\0\\0\\0\\0\\0\\0bad'", "box.obj: bad")):
            with self.subTest(text=text):
                self.program(text)
                self.assert_refused(self.read("box.obj"), words)
        os.environ.update(AVIANLIDAR_MESH_SECONDS="1")
        self.program("exec sleep 600")
        self.assert_refused(self.read("box.obj"),
                            "Assimp cannot read it in 1 s: set the environment variable AVIANLIDAR_MESH_SECONDS to "
                            "allow more")
        os.environ.update(AVIANLIDAR_MESH_SECONDS="soon")
        self.assert_refused(self.read("box.obj"), "AVIANLIDAR_MESH_SECONDS is 'soon', expected a number above 0")
        os.environ.update(AVIANLIDAR_MESH_SECONDS="60", AVIANLIDAR_MESH_READER=str(self.folder / "none"))
        self.assert_refused(self.read("box.obj"), "none, cannot be started: No such file or directory")

    def test_one_process_reads_many_files(self):
        """A program that ends after an answer is started again. The first file of a process that fails is the one to
        blame."""
        real = pathlib.Path(vtkAvianLidar.__file__).parents[3] / "avianlidar" / "mesh-reader"
        names, starts = [f"box{number}.obj" for number in range(5)], self.folder / "starts"
        for number, name in enumerate(names):
            (self.folder / name).write_text(f"v 0 0 0\nv {number + 1} 0 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
        scene = {"version": 1, "objects": [{"name": name, "file": name, "material": "Wall"} for name in names]}
        request = str(self.folder / names[1]).encode()
        answer = subprocess.run([real, "0"], input=len(request).to_bytes(8, "little") + request, stdout=subprocess.PIPE,
                                check=True).stdout
        (self.folder / "answer").write_bytes(answer)
        limit = "[ $(wc -c < '{0}') -lt 4 ] || kill -SEGV $$\ncat '{1}'"
        for text, count, widths, error in (
                (f"exec '{real}' \"$@\"", 1, [1, 2, 3, 4, 5], ""), (f"cat '{self.folder / 'answer'}'", 5, [2] * 5, ""),
                (limit.format(starts, self.folder / "answer"), 4, [],
                 "box3.obj: Assimp cannot read it: it crashes on the file (Segmentation fault)")):
            starts.write_text("", encoding="utf-8")
            self.program(f"printf x >> '{starts}'\n{text}")
            read = st.Read(st.write_scene(self.folder, "many", scene))
            self.assertEqual(len(starts.read_text(encoding="utf-8")), count, text)
            if error:
                self.assert_refused(read, error)
            else:
                self.assertEqual(read.errors, [])
                self.assertEqual([float(np.ptp(st.corners(read.block(name))[..., 0])) for name in names], widths)

    def test_the_limit_of_memory_is_the_users(self):
        points, faces = 60000, 90000
        text = "".join(f"v {i} {i % 7} 0\n"
                       for i in range(points)) + "".join(f"f {i % points + 1} {(i + 1) % points + 1} "
                                                         f"{(i + 2) % points + 1}\n" for i in range(faces))
        os.environ.update(AVIANLIDAR_MESH_GIGABYTES="0.02")
        self.assert_refused(self.read("large.obj", text), "there is not enough memory for it")
        os.environ.update(AVIANLIDAR_MESH_GIGABYTES="2")
        self.assertEqual(self.read("large.obj").block("Box").GetNumberOfCells(), faces)
