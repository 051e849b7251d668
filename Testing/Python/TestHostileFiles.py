# SPDX-License-Identifier: BSD-3-Clause
"""Files on which libraries crash, never end or take all memory: each is one error that names file and reason.

The files are read one after the other in a process with the limits below; meshes in one of their own, which the reader starts."""
import base64
import gzip
import json
import os
import re
import resource
import struct
import subprocess
import sys
import tempfile
import unittest

import scenetools as st

ADDRESSES = 4 << 30  # bytes
MESH_GIGABYTES = "0.5"
STACK = 8 << 20
DEEP = 80000
CHAIN = 20000
HUGE = 2**60

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def scene(name, key="file", **more):
    return {"version": 1, "origin": {"latitude": 0, "longitude": 0, "height": 0}, "objects": [{key: name, **more}]}


def gltf(children, extras="1"):
    """A triangle in the last node; `children`: of each node."""
    corners = base64.b64encode(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)).decode()
    nodes = [{"children": c} if c else {} for c in children]
    nodes[-1]["mesh"] = 0
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                       "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + corners}]})
    return text[:-1] + ', "extras": ' + extras + "}"


def chain(length):
    return gltf([[i + 1] for i in range(length - 1)] + [[]])


def glb(text):
    data = text.encode() + b" " * (-len(text) % 4)
    return b"glTF" + struct.pack("<IIII", 2, 20 + len(data), len(data), 0x4E4F534A) + data


def collada(nodes, library="", encoding="UTF-8"):
    return (f'<?xml version="1.0" encoding="{encoding}"?>'
            '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><library_geometries>'
            '<geometry id="g"><mesh><source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 1 0</float_array>'
            '<technique_common><accessor source="#pa" count="3" stride="3"><param name="X" type="float"/>'
            '<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>'
            '<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">'
            '<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>'
            f'</library_geometries><library_nodes>{library}</library_nodes><library_visual_scenes>'
            f'<visual_scene id="s">{nodes}</visual_scene></library_visual_scenes>'
            '<scene><instance_visual_scene url="#s"/></scene></COLLADA>')


TRIANGLE = '<instance_geometry url="#g"/>'
TENFOLD = "".join(f'<node id="l{i}">' + f'<instance_node url="#l{i + 1}"/>' * 10 + "</node>" for i in range(12))



def x3d(content):
    return f'<?xml version="1.0"?><X3D profile="Full" version="3.0"><Scene>{content}</Scene></X3D>'


SHAPE = ('<Shape><IndexedFaceSet coordIndex="0 1 2 -1"><Coordinate point="0 0 0 1 0 0 0 1 0"/></IndexedFaceSet></Shape>')


def legacy(kind, content, version="3.0", form="ASCII"):
    return f"# vtk DataFile Version {version}\nt\n{form}\nDATASET {kind}\n{content}"


POINTS = "POINTS 3 float\n0 0 0 1 0 0 0 1 0\n"
WHOLE = POINTS + "POLYGONS 1 4\n3 0 1 2\n"


def binary(first):
    """A binary file of one cell, whose first number says how many points it has."""
    head = legacy("POLYDATA", "POINTS 3 float\n", form="BINARY").encode()
    return head + struct.pack(">9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + b"\nPOLYGONS 1 4\n" + struct.pack(">4i", first, 0, 1, 2)


def binary5(words=b"CONNECTIVITY vtktypeint64\n"):
    """A binary file of one cell as VTK writes it today."""
    head = legacy("POLYDATA", "POINTS 3 float\n", "5.1", "BINARY").encode()
    return (head + struct.pack(">9f", 0, 0, 0, 1, 0, 0, 0, 1, 0) + b"\nPOLYGONS 2 3\nOFFSETS vtktypeint64\n"
            + struct.pack(">2q", 0, 3) + b"\n" + words + struct.pack(">3q", 0, 1, 2) + b"\n")


def xml(kind, content):
    return f'<VTKFile type="{kind}" version="0.1" byte_order="LittleEndian"><{kind}>{content}</{kind}></VTKFile>'


def array(name, values, kind="Int64", more=""):
    return f'<DataArray type="{kind}" Name="{name}" format="ascii" {more}>{values}</DataArray>'


def surface(points=3, polys=1, offset=3, more=""):
    return xml("PolyData", f'<Piece NumberOfPoints="{points}" NumberOfPolys="{polys}">{more}<Points>'
               + array("p", "0 0 0 1 0 0 0 1 0", "Float64", 'NumberOfComponents="3"') + "</Points><Polys>"
               + array("connectivity", "0 1 2") + array("offsets", offset) + "</Polys></Piece>")


def grid(cells=1, offset=3):
    return xml("UnstructuredGrid", f'<Piece NumberOfPoints="3" NumberOfCells="{cells}"><Points>'
               + array("p", "0 0 0 1 0 0 0 1 0", "Float64", 'NumberOfComponents="3"') + "</Points><Cells>"
               + array("connectivity", "0 1 2") + array("offsets", offset) + array("types", "5", "UInt8")
               + "</Cells></Piece>")


def image(*cells):
    extent = " ".join(f"0 {n}" for n in cells)
    return xml("ImageData", f'<Piece Extent="{extent}"></Piece>').replace(
        "<ImageData>", f'<ImageData WholeExtent="{extent}" Origin="0 0 0" Spacing="1 1 1">')


def blocks(content):
    return ('<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>' + content
            + "</vtkMultiBlockDataSet></VTKFile>")


PLY = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n"
       "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n")
AC3D = "AC3Db\nMATERIAL \"\" rgb 1 1 1  amb 0.2 0.2 0.2  emis 0 0 0  spec 0.5 0.5 0.5  shi 10  trans 0\n"
AC3D_TRIANGLE = ("OBJECT poly\nnumvert 3\n0 0 0\n1 0 0\n0 1 0\nnumsurf 1\nSURF 0x20\nmat 0\nrefs 3\n0 0 0\n1 0 0\n2 0 0\n"
                 "kids 0\n")

# Whole scene files.
TEXTS = [
    ('{"version":1,"comment":' + "[" * DEEP + "]" * DEEP + ',"objects":[]}', "is nested more than 100 deep"),
    ('{"version":1,"objects":' + '{"a":' * DEEP + "1" + "}" * DEEP + "}", "is nested more than 100 deep"),
    ('{"version":1,"objects":' + "[" * DEEP, "is nested more than 100 deep"),
]

# Name and content of meshes of one triangle at most, which libraries cannot be trusted with.
MESHES = [
    ("chain.gltf", chain(CHAIN)),
    ("chain.glb", glb(chain(CHAIN))),
    ("chain.gltf.gz", gzip.compress(chain(CHAIN).encode())),
    ("values.gltf", gltf([[]], "[" * 10**6 + "]" * 10**6)),
    ("nodes.gltf", '{"asset":{"version":"2.0"},"nodes":[1,{"children":5},{"children":["x",-1,99]}]}'),
    ("nonodes.gltf", '{"asset":{"version":"2.0"},"nodes":5}'),
    ("list.gltf", "[1]"),
    ("cycle.gltf", gltf([[1], [2], [0]])),
    ("double.gltf", gltf([[i + 1] * 2 for i in range(50)] + [[]])),
    ("chain.dae", collada("<node>" * CHAIN + TRIANGLE + "</node>" * CHAIN)),
    ("chain16.dae", collada("<node>" * CHAIN + TRIANGLE + "</node>" * CHAIN, encoding="UTF-16").encode("utf-16")),
    ("own.dae", collada(f'<node id="a">{TRIANGLE}<instance_node url="#a"/></node>')),
    ("others.dae", collada('<node id="s0"><instance_node url="#a"/></node>',
                           '<node id="a"><instance_node url="#b"/></node><node id="b"><instance_node url="#a"/></node>')),
    ("tenfold.dae", collada('<node id="s0"><instance_node url="#l0"/></node>',
                            TENFOLD + f'<node id="l12">{TRIANGLE}</node>')),
    ("chain.x3d", x3d("<Group>" * CHAIN + SHAPE + "</Group>" * CHAIN)),
    ("own.x3d", x3d('<Group DEF="a"><Group USE="a"/></Group>')),
    ("chain.ac", AC3D + "OBJECT group\nkids 1\n" * CHAIN + AC3D_TRIANGLE),
    ("chain.x", "xof 0303txt 0032\n" + "Frame a {\n" * CHAIN + "}\n" * CHAIN),
    ("empty.ply", PLY.format(1) + "0\n"),
    ("cell.vtk", legacy("POLYDATA", POINTS + "POLYGONS 1 4\n99999999 0 1 2\n")),
    ("binary.vtk", binary(99999999)),
    ("below.vtk", legacy("POLYDATA", POINTS + "POLYGONS 1 4\n-3 0 1 2\n")),
    ("typeless.vtk", legacy("POLYDATA", POINTS + "POLYGONS 2 3\nOFFSETS \n0 3\nCONNECTIVITY vtktypeint64\n0 1 2\n", "5.1")),
    ("unknown.vtk", legacy("POLYDATA", POINTS + "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nCONNECTIVITY xx\n0 1 2\n", "5.1")),
    ("none.vtk", legacy("UNSTRUCTURED_GRID", POINTS + "CELLS 2 3\nOFFSETS vtktypeint64\n0 3\n0 1 2\nCELL_TYPES 1\n5\n", "5.1")),
    ("binary5.vtk", binary5(b"CONNECTIVITY \n")),
    ("cells.vtk", legacy("UNSTRUCTURED_GRID", POINTS + "CELLS 1 4\n99999999 0 1 2\nCELL_TYPES 1\n5\n")),
    ("points.vtk", legacy("POLYDATA", WHOLE.replace("POINTS 3", f"POINTS {HUGE}"))),
    ("polygons.vtk", legacy("POLYDATA", WHOLE.replace("POLYGONS 1 4", f"POLYGONS 1 {HUGE}"))),
    ("offsets.vtk", legacy("POLYDATA", POINTS + f"POLYGONS {HUGE} 3\nOFFSETS vtktypeint64\n0 3\n"
                           "CONNECTIVITY vtktypeint64\n0 1 2\n", "5.1")),
    ("types.vtk", legacy("UNSTRUCTURED_GRID", POINTS + f"CELLS 1 4\n3 0 1 2\nCELL_TYPES {HUGE}\n5\n")),
    ("vectors.vtk", legacy("POLYDATA", WHOLE + f"POINT_DATA {10**12}\nVECTORS v double\n1\n")),
    ("scalars.vtk", legacy("POLYDATA", WHOLE + f"POINT_DATA 3\nSCALARS v double {2 * 10**9}\nLOOKUP_TABLE default\n1\n")),
    ("fields.vtk", legacy("POLYDATA", WHOLE + f"FIELD FieldData 1\nx 1000000 {10**9} double\n1\n")),
    ("table.vtk", legacy("TABLE", f"ROW_DATA {10**12}\nSCALARS x double\n1\n")),
    ("graph.vtk", legacy("UNDIRECTED_GRAPH", f"VERTICES {10**12}\nEDGES {10**12}\n0 1\n")),
    ("blocks.vtk", legacy("MULTIBLOCK", f"CHILDREN {10**12}\nCHILD 1\nx\nENDCHILD\n")),
    ("image.vtk", legacy("STRUCTURED_POINTS", "DIMENSIONS 100000 100000 100000\nORIGIN 0 0 0\nSPACING 1 1 1\n")),
    ("few.vtk", legacy("STRUCTURED_GRID", "DIMENSIONS 1000 1000 1\n" + POINTS)),
    ("axes.vtk", legacy("RECTILINEAR_GRID", "DIMENSIONS 100 100 100\n" + "".join(
        f"{axis}_COORDINATES 3 float\n0 1 2\n" for axis in "XYZ"))),
    ("image.vti", image(10**6, 10**6, 10**3)),
    ("points.vtp", surface(points=HUGE)),
    ("polys.vtp", surface(polys=HUGE)),
    ("offsets.vtp", surface(offset=10**15)),
    ("cells.vtu", grid(cells=10**13)),
    ("offsets.vtu", grid(offset=10**15)),
    ("components.vtp", surface(more="<PointData>" + array("x", 0, more='NumberOfComponents="2000000000"') + "</PointData>")),
    ("fields.vtp", surface().replace("<Piece", "<FieldData>" + array("x", 1, more=f'NumberOfTuples="{10**12}"')
                                     + "</FieldData><Piece", 1)),
    ("type.vtp", surface().replace("<Piece", '<FieldData><Array type="Float" Name="x" NumberOfTuples="1">1</Array></FieldData>'
                                   "<Piece", 1)),
    ("notype.vtp", surface().replace("<Piece", '<FieldData><DataArray Name="x" NumberOfTuples="1">1</DataArray></FieldData>'
                                     "<Piece", 1)),
    ("compressor.vtp", surface().replace("<VTKFile", '<VTKFile compressor="zip"', 1)),
    ("below.vtp", surface().replace('NumberOfPolys="1"', 'NumberOfVerts="-7" NumberOfPolys="1"', 1)),
    ("extent.vti", image(2, 3, 1).replace('WholeExtent="0 2 0 3', 'WholeExtent="0 2 65535 3', 1)),
    ("elements.vtp", "<VTKFile type='PolyData'>" + "<a>" * DEEP + "</a>" * DEEP + "</VTKFile>"),
    ("elements.vtm", blocks('<Block index="0">' * DEEP + "</Block>" * DEEP)),
    ("parts.vtm", blocks('<DataSet index="0" file="points.vtp"/>')),
]

# Sound files of the same kinds, up to where the errors begin.
SOUND = [
    ("sound.obj", OBJ), ("sound.gltf", chain(500)),
    ("sound.dae", collada("<node>" * 500 + TRIANGLE + "</node>" * 500)),
    ("twice.dae", collada('<node id="s0"><instance_node url="#a"/></node><node id="s1"><instance_node url="#a"/></node>',
                          f'<node id="a">{TRIANGLE}</node>')),
    ("sound.x3d", x3d(f'<Group DEF="a">{SHAPE}</Group><Transform translation="5 0 0"><Group USE="a"/></Transform>')),
    ("sound.ac", AC3D + "OBJECT world\nkids 3\n" + 3 * AC3D_TRIANGLE),
    ("sound.ply", PLY.format(2) + "3 0 1 2\n3 2 1 0\n"),
    ("sound.vtk", legacy("POLYDATA", WHOLE)), ("soundbinary.vtk", binary(3)),
    ("sound5.vtk", legacy("POLYDATA", POINTS + "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nCONNECTIVITY vtktypeint64\n0 1 2\n",
                          "5.1")),
    ("sound5binary.vtk", binary5()),
    ("soundscalars.vtk", legacy("POLYDATA", WHOLE + "POINT_DATA 3\nSCALARS v double 1\nLOOKUP_TABLE default\n1e9 2e9 3e9\n")),
    ("sound.vtp", surface()), ("sound.vtu", grid()),
    ("comment.vtp", surface().replace("<Piece", '<!-- a > b <Piece NumberOfPoints="1e99"/> - -> --><Piece', 1)),
    ("cdata.vtp", surface().replace("</Piece>", '</Piece><![CDATA[<Piece NumberOfPoints="1e99"/> ]]]]>')),
    ("long.vtp", surface().replace("<Piece", f"<Piece Name='{'>' * 70000}' OfNumberOfPoints = '-1'", 1)), ("sound.vti", image(10, 10, 10)),
]


def read_all(files):
    """In the process of its own: one line for each file."""
    for file in files:
        read = st.Read(file)
        blocks = [block for block in read.blocks if block]
        print(json.dumps([file, read.errors, sum(block.GetNumberOfCells() for block in blocks)]), flush=True)


class HostileFiles(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = holder.name

    def save(self, name, content):
        with open(os.path.join(self.folder, name), "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())

    def read(self, files):
        """What was said of each file, in a process with limits; nothing of one that ended it."""

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
            resource.setrlimit(resource.RLIMIT_STACK, (STACK, STACK))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        said = {}
        left = list(files)
        while left:
            run = subprocess.run([sys.executable, __file__, "--read", *left], preexec_fn=limit, text=True, errors="replace",
                                 env={**os.environ, "AVIANLIDAR_MESH_GIGABYTES": MESH_GIGABYTES},
                                 stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
            lines = [json.loads(line) for line in run.stdout.splitlines() if line.startswith('["')]
            said.update({file: (errors, cells) for file, errors, cells in lines})
            left = left[len(lines) + 1:]
        return said

    def assert_one_error(self, said, file, words):
        self.assertIn(file, said, "it ended the process")
        errors, cells = said[file]
        self.assertEqual(len(errors), 1, errors)
        self.assertIn(words, errors[0])
        self.assertEqual(cells, 0)

    def test_scene_files_that_would_end_the_process_are_errors(self):
        files = [st.write_scene(self.folder, f"text{i}", text) for i, (text, _) in enumerate(TEXTS)]
        said = self.read(files)
        for file, (_, words) in zip(files, TEXTS):
            with self.subTest(file=file):
                self.assert_one_error(said, file, words)

    def test_meshes_that_may_end_the_process_are_errors_or_one_triangle(self):
        files = []
        for name, content in MESHES:
            self.save(name, content)
            files.append(st.write_scene(self.folder, name, scene(name)))
        said = self.read(files)
        for file, (name, _) in zip(files, MESHES):
            with self.subTest(name=name):
                self.assertIn(file, said, "it ended the process")
                errors, cells = said[file]
                if cells == 0:
                    self.assertEqual(len(errors), 1, errors)
                    self.assertRegex(errors[0], re.escape("objects[0].file: " + os.path.join(self.folder, name)) + ": .{10}")
                else:
                    self.assertEqual((errors, cells), ([], 1))

    def test_sound_files_are_read(self):
        files = []
        for name, content in SOUND:
            self.save(name, content)
            files.append(st.write_scene(self.folder, name, scene(name)))
        said = self.read(files)
        for file in files:
            with self.subTest(file=file):
                self.assertIn(file, said, "it ended the process")
                self.assertEqual(said[file][0], [])
                self.assertGreater(said[file][1], 0)

    def test_footprints_nested_deep_are_errors(self):
        feature = '{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"a":%s},"geometry":%s}]}'
        square = '{"type":"Polygon","coordinates":[[[0,0],[0.001,0],[0.001,0.001],[0,0]]]}'
        collection = '{"type":"GeometryCollection","geometries":['
        texts = ["[" * DEEP + "]" * DEEP, feature % ("[" * DEEP + "]" * DEEP, square),
                 feature % (1, collection * CHAIN + square + "]}" * CHAIN)]
        files = []
        for i, text in enumerate(texts):
            self.save(f"{i}.geojson", text)
            files.append(st.write_scene(self.folder, str(i), scene(f"{i}.geojson", "footprints", height=3)))
        said = self.read(files)
        for file in files:
            self.assert_one_error(said, file, "GDAL cannot read it")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--read"]:
        read_all(sys.argv[2:])
    else:
        unittest.main()
