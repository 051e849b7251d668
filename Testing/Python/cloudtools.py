# SPDX-License-Identifier: BSD-3-Clause
"""Clouds for the tests of point cloud files, and how they are written, read and compared."""

import os

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from avianlidar import _cloud, _suffixes, vtkAvianLidar as al
from echotools import Messages, array, copy_of, given, output, scan, sensor, town

# The package's own table, so that a new writer is in every test of all: {"LAS": ".las", ...}, the first suffix of each.
WRITERS = {}
for _suffix, _name in _suffixes.WRITERS.items():
    WRITERS.setdefault(_name[len("vtkAvianLidar"):-len("Writer")], _suffix)
CLOUDS = (*WRITERS.values(), *_suffixes.OWN)
READ_BACK = [_suffix for _suffix in CLOUDS if _suffix in (*_suffixes.READERS, *_suffixes.OWN)]
ORIGIN = (31.1979, 121.3363, 3.0)  # the paper's airport


def add_field(data, name, values, unit=None):
    """A tuple of numbers, or a list of texts, as field data."""
    _cloud.add_array(data.GetFieldData(), name, values if isinstance(values, list) else np.array([values], dtype=float),
                     unit)


def add_array(data, name, values, unit=None):
    _cloud.add_array(data.GetPointData(), name, np.asarray(values), unit)


def cloud(points, kind=vtk.vtkPolyData):
    """Points without anything else; single precision stays so."""
    data = kind()
    holder = vtk.vtkPoints()
    points = np.asarray(points)
    holder.SetData(numpy_to_vtk(points.astype(np.result_type(points, np.float32)).reshape(-1, 3), deep=1))
    data.SetPoints(holder)
    return data


def extremes(kinds, order="<"):
    """Three points of x, y, z and of each kind of number, {name: kind}: its least value, 1 and its largest."""
    rows = np.zeros(3,
                    [(axis, order + "f4") for axis in "xyz"] + [(name, order + kind) for name, kind in kinds.items()])
    rows["x"] = (1, 2, 3)
    for name, kind in kinds.items():
        limits = np.finfo(kind) if kind[0] == "f" else np.iinfo(kind)
        rows[name] = [limits.min, 1, limits.max]
    return rows, "".join(" ".join(repr(value.item()) for value in row) + "\n" for row in rows).encode("ascii")


def assert_extremes(got, rows, kinds):
    np.testing.assert_array_equal(points(got)[:, 0], (1, 2, 3))
    for name, kind in kinds.items():
        assert array(got, name).dtype == np.dtype(kind), name
        np.testing.assert_array_equal(array(got, name), rows[name], name)


def echoes(origin=ORIGIN, orientation=(30.0, 2.0, 1.0), columns=90, channels=4, **settings):
    """Echoes of a town of boxes with classes, as from a scene with an origin; a copy to change."""
    beams = given(sensor(columns, channels), Position=(10.0, 20.0, 3.0), Orientation=orientation,
                  HalfBeamwidth=0.03)  # wide enough for several returns
    data = copy_of(output(scan(town(), beams, **settings)))
    if origin:
        add_field(data, "geodetic_origin", origin, "deg deg m")
    classes = ("terminal", "ground", "runway", "fence", "no such word")
    add_field(data, "object_classes", [classes[i % len(classes)] for i in range(40)])
    assert data.GetNumberOfPoints() > 50
    return data


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData()) if data.GetNumberOfPoints() else np.zeros((0, 3))


def names(data):
    return [data.GetPointData().GetArrayName(i) for i in range(data.GetPointData().GetNumberOfArrays())]


def unit(data, name):
    return data.GetPointData().GetArray(name).GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL())


def field(data, name):
    """Values of field data as a list."""
    holder = data.GetFieldData().GetAbstractArray(name)
    if holder.IsA("vtkStringArray"):
        return [holder.GetValue(i) for i in range(holder.GetNumberOfValues())]
    return vtk_to_numpy(holder).ravel().tolist()


def write(writer, data, name, **properties):
    """Writes and returns the warnings; nothing may go wrong, and nothing but the file may be left."""
    before = set(os.listdir("."))
    heard = Messages(writer)
    given(writer, InputData=data, FileName=name, **properties)
    assert writer.Write() == 1 and not heard.errors, heard.errors
    left = {one for one in set(os.listdir(".")) - before if ".part" in one}
    assert os.path.exists(name) and not left, left
    return heard.warnings


def assert_refused(test, writer, data, name, words):
    """Writing it fails with one error that says so, and leaves no file."""
    heard = Messages(writer)
    given(writer, InputData=data, FileName=name)
    test.assertEqual(writer.Write(), 0)
    test.assertEqual(len(heard.errors), 1, heard.errors)
    test.assertIn(words, heard.errors[0])
    test.assertFalse(os.path.exists(name))


def read(name, said=(), **properties):
    """The cloud in a file; nothing may be said, or one warning that names the file and has these words."""
    reader = al.vtkAvianLidarPointCloudReader()
    heard = Messages(reader)
    given(reader, FileName=name, **properties).Update()
    assert not heard.errors and len(heard.warnings) == bool(said), (heard.errors, heard.warnings)
    assert all(words in heard.warnings[0] for words in (*said, *([name] if said else ()))), heard.warnings
    data = reader.GetOutput()
    assert data.GetNumberOfVerts() == data.GetNumberOfPoints()
    bright = "energy" if data.GetPointData().HasArray("energy") else "intensity"
    active = data.GetPointData().GetScalars()
    assert (active.GetName() if active else None) == (bright if data.GetPointData().HasArray(bright) else None)
    return data


def read_error(name):
    """The one error of reading a file, which holds in all ways."""
    from filetools import said_of  # not for those who read no bad file
    errors, _, wrong = said_of(str(name))
    assert len(errors) == 1 and str(name) in errors[0] and not wrong, (errors, wrong)
    return errors[0]


def pose_line(rotation, place):
    return " ".join(f"{value:.9g}" for value in np.column_stack([rotation, place]).ravel()) + "\n"


def write_sequence(folder, scans, times, pose):
    """A sequence in the folders of KITTI. @param scans points and labels @param pose a line, of all scans"""
    for name, suffix, of_scans in zip(("velodyne", "labels"), (".bin", ".label"), zip(*scans)):
        (folder / name).mkdir(parents=True)
        for number, values in enumerate(of_scans):
            values.tofile(folder / name / f"{number:06d}{suffix}")
    (folder / "times.txt").write_text("".join(f"{time:.6f}\n" for time in times))
    (folder / "poses.txt").write_text(pose * len(scans))
    (folder / "calib.txt").write_text("P0: 1 0 0 0 0 1 0 0 0 0 1 0\nTr: 1 0 0 0 0 1 0 0 0 0 1 0\n")


def geodetic(data, frame):
    """The points in another frame, by the filter that is tested against other programs."""
    transform = given(al.vtkAvianLidarGeodeticTransform(), InputData=data, MovePoints=True)
    getattr(transform, "SetTargetFrameTo" + frame)()
    return points(output(transform))


def assert_same_arrays(one, two, left_out=()):
    """Every array of the first is in the second with the same values and unit."""
    for name in names(one):
        if name not in left_out:
            np.testing.assert_array_equal(array(two, name), array(one, name), name)
            assert unit(one, name) == unit(two, name), name
