# SPDX-License-Identifier: BSD-3-Clause
"""Small good files of every format that the readers take, each with the scene file that names it, if it is a mesh."""

import base64
import gzip
import json
import os
import struct

import numpy as np
import vtk

from boxfiles import CORNERS, QUADS, TRIANGLES, ac3d, collada, gltf, ifc, obj, ply, poly_data, stl, three_ds

CLOUDS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Fuzzing", "Corpus", "PointCloud")

# Files of these formats can make Assimp follow a null pointer (STEP, and so IFC), or VTK's reader (legacy field data of a type
# that it does not know): left out unless they are asked for.
LIBRARY_FAULTS = ("box.ifc", "vtkPolyData-ASCII.vtk", "vtkPolyData-Binary.vtk", "vtkUnstructuredGrid-ASCII.vtk",
                  "vtkUnstructuredGrid-Binary.vtk")

SCENE = {
    "version": 1,
    "origin": {"latitude": 31.1979, "longitude": 121.3363, "height": 3},
    "lidar": {"position": [0, 0, 3], "inside": True},
    "materials": {"Grass": {"kd": 0.2204, "ks": 0, "kp": 1}, "glass": {"kd": 0.01, "ks": 0.9, "kp": 9000}},
    "material_map": {"*glass*": "Glass", "*": "Wall"},
    "attribution": ["somebody"],
    "comment": "anything",
    "objects": [
        {"ground": {"size": [1200, 800], "height": -1}, "material": "Grass"},
        {"file": "mesh.obj", "position": [120, -40, 0], "rotation": 90, "class": "tower", "scale": [1, 2, 3]},
        {"file": "mesh.obj", "geodetic": {"latitude": 31.2, "longitude": 121.34, "height": 3}, "rotation": [1, 1, 0]},
        {"file": "mesh.obj", "rotation": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "up_axis": "y", "name": "turned"},
        {"footprints": "houses.geojson", "filter": {"building": "*"}, "height_attribute": "height", "height": 8,
         "glazing": {"share": 0.3, "bay": 3}, "roof_material": "Wood", "features": "separate"},
    ],
}


def geojson():
    x, y = 121.3363, 31.1979

    def ring(dx, dy, size):
        square = ((0, 0), (size, 0), (size, size), (0, size), (0, 0))
        return [[x + dx + u, y + dy + v] for u, v in square]

    features = [("Polygon", [ring(0, 0, 1e-3), ring(3e-4, 3e-4, 2e-4)]), ("Polygon", [ring(2e-3, 0, 5e-4)]),
                ("MultiPolygon", [[ring(0, 2e-3, 5e-4)], [ring(1e-3, 2e-3, 5e-4)]]),
                ("LineString", [[x, y], [x + 1e-3, y + 1e-3], [x, y + 2e-3]]), ("Point", [x, y])]
    return json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"building": "yes", "height": str(5 + i), "name": f"h{i}", "width": 2},
         "geometry": {"type": kind, "coordinates": coordinates}} for i, (kind, coordinates) in enumerate(features)]})


def binary_stl():
    triangles = b"".join(struct.pack("<12fH", 0, 0, 0, *CORNERS[list(face)].ravel(), 0) for face in TRIANGLES)
    return b"box".ljust(80) + struct.pack("<I", len(TRIANGLES)) + triangles


def binary_ply():
    head = ("ply\nformat binary_little_endian 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(QUADS)}\nproperty list uchar int vertex_indices\nend_header\n")
    return head.encode() + CORNERS.astype("<f4").tobytes() + b"".join(struct.pack("<B4i", 4, *face) for face in QUADS)


def glb():
    scene = json.loads(gltf(CORNERS, TRIANGLES))
    blob = base64.b64decode(scene["buffers"][0].pop("uri").split(",")[1])
    blob += b"\0" * (-len(blob) % 4)
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def off():
    return (f"OFF\n8 {len(QUADS)} 0\n" + "".join("%r %r %r\n" % tuple(map(float, p)) for p in CORNERS)
            + "".join("4 %d %d %d %d\n" % face for face in QUADS))


def vtk_files(folder):
    """What VTK writes, each way that it writes."""
    surface = poly_data(QUADS)
    grid = vtk.vtkAppendFilter()
    grid.AddInputData(surface)
    grid.Update()
    image = vtk.vtkImageData()
    image.SetDimensions(3, 4, 2)
    image.AllocateScalars(vtk.VTK_FLOAT, 1)
    image.GetPointData().GetScalars().Fill(1)
    boxes = vtk.vtkRectilinearGrid()
    boxes.SetDimensions(2, 2, 2)
    for axis in "XYZ":
        values = vtk.vtkDoubleArray()
        values.InsertNextValue(0)
        values.InsertNextValue(3)
        getattr(boxes, f"Set{axis}Coordinates")(values)
    structured = vtk.vtkStructuredGrid()
    structured.SetDimensions(2, 2, 2)
    points = vtk.vtkPoints()
    for corner in CORNERS:
        points.InsertNextPoint(corner)
    structured.SetPoints(points)
    for ending, data, writer in (("vtp", surface, vtk.vtkXMLPolyDataWriter), ("vti", image, vtk.vtkXMLImageDataWriter),
                                 ("vtu", grid.GetOutput(), vtk.vtkXMLUnstructuredGridWriter),
                                 ("vtr", boxes, vtk.vtkXMLRectilinearGridWriter),
                                 ("vts", structured, vtk.vtkXMLStructuredGridWriter)):
        for mode in ("Ascii", "Binary"):
            writer_ = writer()
            writer_.SetInputData(data)
            getattr(writer_, f"SetDataModeTo{mode}")()
            yield f"{mode}.{ending}", _written(writer_, folder)
    for data in (surface, grid.GetOutput(), image, boxes, structured):
        for mode in ("ASCII", "Binary"):
            writer_ = vtk.vtkDataSetWriter()
            writer_.SetInputData(data)
            getattr(writer_, f"SetFileTypeTo{mode}")()
            yield f"{data.GetClassName()}-{mode}.vtk", _written(writer_, folder)


def _written(writer, folder):
    name = os.path.join(folder, "written")
    writer.SetFileName(name)
    writer.Write()
    with open(name, "rb") as file:
        data = file.read()
    os.remove(name)
    return data


def all_samples(folder, library_faults=False):
    """[(file to mutate, file to open, {name: content})], in an order that does not change."""
    def of_mesh(name, **more):
        return json.dumps({"version": 1, "objects": [{"file": name, "material": "wall", **more}]}).encode()

    mesh = obj(CORNERS, TRIANGLES).encode()
    meshes = {
        "box.obj": mesh, "box.stl": stl(CORNERS, TRIANGLES).encode(), "binary.stl": binary_stl(),
        "box.ply": ply(CORNERS, QUADS).encode(), "binary.ply": binary_ply(), "box.gltf": gltf(CORNERS, TRIANGLES).encode(),
        "box.glb": glb(), "box.dae": collada(CORNERS, TRIANGLES, "Z_UP").encode(),
        "box.3ds": three_ds(CORNERS, TRIANGLES), "box.ac": ac3d(CORNERS, QUADS).encode(), "box.off": off().encode(),
        "box.ifc": ifc(CORNERS, QUADS).encode(), "box.obj.gz": gzip.compress(mesh, mtime=0)}
    meshes.update(vtk_files(folder))
    town = {"scene.lidarscene.json": json.dumps(SCENE, indent=1).encode(), "mesh.obj": mesh,
            "houses.geojson": geojson().encode()}
    samples = [("scene.lidarscene.json", "scene.lidarscene.json", town)] * 8
    samples += [("houses.geojson", "scene.lidarscene.json", town)] * 3
    flat = {"footprints": "houses.geojson", "flat": True, "width_attribute": "width"}
    lines = {"scene.lidarscene.json": json.dumps({**SCENE, "objects": [flat]}).encode(), "houses.geojson": geojson().encode()}
    samples.append(("houses.geojson", "scene.lidarscene.json", lines))
    for name, content in meshes.items():
        if name in LIBRARY_FAULTS and not library_faults:
            continue
        samples.append((name, "scene.lidarscene.json", {"scene.lidarscene.json": of_mesh(name), name: content}))
    for name in sorted(os.listdir(CLOUDS)):
        with open(os.path.join(CLOUDS, name), "rb") as file:
            content = file.read()[1:]  # the fuzzer's files begin with the format
        if name.startswith("kitti"):
            files = {"cloud.bin": np.arange(40, dtype="<f4").tobytes(), "cloud.label": np.arange(10, dtype="<u4").tobytes()}
            samples += [("cloud.bin", "cloud.bin", files), ("cloud.label", "cloud.bin", files)]
        else:
            cloud = "cloud." + name.split("-")[0]
            samples += [(cloud, cloud, {cloud: content})] * 3
    return samples
