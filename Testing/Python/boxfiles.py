# SPDX-License-Identifier: BSD-3-Clause
"""One box in every mesh format that the scene reader's tests write: each function gives the file's content."""
import base64
import gzip
import json
import struct

import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

from avianlidar._cloud import add_array

# A box of three different sides, so that no axis can be taken for another; corners in binary order.
LOW, HIGH = (1.0, 2.0, 0.0), (2.0, 4.0, 3.0)
CORNERS = np.array([[(LOW, HIGH)[i >> k & 1][k] for k in range(3)] for i in range(8)])
TRIANGLES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]
COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "f4": 5126}  # of glTF
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
        text += "facet normal 0 0 0\nouter loop\n" + "".join("vertex %r %r %r\n" % tuple(map(float, points[k]))
                                                             for k in face)
        text += "endloop\nendfacet\n"
    return text + "endsolid box\n"


def ply(points, faces):
    return ("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(faces)
            + "".join("%r %r %r\n" % tuple(map(float, p)) for p in points)
            + "".join("%d %s\n" % (len(f), " ".join(map(str, f))) for f in faces))


def gltf_document(parts, faces, nodes, **accessor):
    """The JSON of a glTF file of one mesh, and its buffer, which has no name yet. @param parts an array of each
    accessor, the first of positions @param accessor changes of the first accessor"""
    blob, views, accessors = b"", [], []
    for values in (*parts, np.asarray(faces, dtype="<u2").ravel()):
        size = 1 if values.ndim == 1 else values.shape[1]
        # elements begin at multiples of 4 bytes
        step = -(-values.dtype.itemsize * size // 4) * 4 if size > 1 else values.dtype.itemsize
        rows = np.zeros((len(values), step), dtype=np.uint8)
        rows[:, :values.dtype.itemsize * size] = np.ascontiguousarray(values).view("u1").reshape(len(values), -1)
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": rows.size,
                      **({"byteStride": step} if size > 1 else {})})
        accessors.append({"bufferView": len(views) - 1, "componentType": COMPONENTS[values.dtype.str[1:]],
                          "count": len(values), "type": "SCALAR" if size == 1 else f"VEC{size}"})
        blob += rows.tobytes() + bytes(-rows.size % 4)
    accessors[0].update(accessor)
    primitive = {"attributes": {"POSITION": 0}, "indices": len(parts), "material": 0}
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": nodes,
            "materials": [{"name": "painted"}], "meshes": [{"primitives": [primitive]}], "bufferViews": views,
            "accessors": accessors, "buffers": [{"byteLength": len(blob)}]}, blob


def with_buffer(document, uri):
    """A glTF document whose buffer is of that name, or in the file itself (bytes)."""
    if isinstance(uri, bytes):
        uri = "data:application/octet-stream;base64," + base64.b64encode(uri).decode()
    document["buffers"][0]["uri"] = uri
    return json.dumps(document)


def gltf(points, faces):
    """Half of the shift is in the scene graph, half in the vertices."""
    return with_buffer(*gltf_document([np.asarray(points, dtype="<f4")], faces,
                                      [{"mesh": 0, "translation": [0.5, 0, 0]}],
                                      min=points.min(0).tolist(), max=points.max(0).tolist()))


def collada(points, faces, up):
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><up_axis>{up}</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert/></technique></profile_COMMON></effect>
</library_effects>
<library_materials><material id="m" name="painted"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="a" count="24">{" ".join(repr(float(c)) for c in points.ravel())}</float_array>
<technique_common><accessor source="#a" count="8" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
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
        text += "SURF 0x0\nmat 0\nrefs %d\n" % len(face) + "".join("%d 0 0\n" % k for k in face)
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


# The box in formats that are text, or bytes.
MESHES = {"box.obj": obj(CORNERS, TRIANGLES), "box.stl": stl(CORNERS, TRIANGLES), "box.ply": ply(CORNERS, TRIANGLES),
          "box.gltf": gltf(y_up(CORNERS) - [0.5, 0, 0], TRIANGLES), "z.dae": collada(CORNERS, TRIANGLES, "Z_UP"),
          "box.ac": ac3d(y_up(CORNERS), TRIANGLES),
          "box.3ds": three_ds(CORNERS, TRIANGLES)}
MESHES = {name: content if isinstance(content, bytes) else content.encode() for name, content in MESHES.items()}
MESHES["packed.obj.gz"] = gzip.compress(MESHES["box.obj"], mtime=0)


def poly_data(faces):
    points, polys, lines = vtkPoints(), vtkCellArray(), vtkCellArray()
    points.SetDataTypeToDouble()
    for p in CORNERS:
        points.InsertNextPoint(p)
    # Cells that no ray hits, before those that count.
    lines.InsertNextCell(2, (0, 7))
    for face in faces:
        polys.InsertNextCell(len(face), face)
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetLines(lines)
    data.SetPolys(polys)
    add_array(data.GetCellData(), "material_id", np.arange(1 + len(faces), dtype=np.int32) % 2)
    add_array(data.GetFieldData(), "material_names", ["painted", "glazed"])
    return data
