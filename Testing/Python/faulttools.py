# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of faults share: each class with small inputs that are good, what it reads of them, and how that is
spoilt."""
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from avianlidar import vtkAvianLidar as al
from cloudtools import WRITERS, add_field, echoes
from echotools import box, copy_of, given, scan, sensor

NAN, INF = float("nan"), float("inf")
PLACE_OF_VALUE = 3  # of the one value of an array that is spoilt


def make(name, **properties):
    return given(getattr(al, "vtkAvianLidar" + name)(), **properties)


def writer(name, file="echoes", **properties):
    return make(name + "Writer", FileName=file + WRITERS[name], **properties)


def beams(piece=0, pieces=1):
    source = sensor(36, 2)
    source.SetSwayAmplitude(0.01)
    source.UpdatePiece(piece, pieces, 0)
    return source.GetOutput()


def surfaces():
    surface = box((50, 0, 0), (1, 60, 10), "Wall", "wall")
    add_field(surface, "object_classes", ["fence"])
    return surface


def attributes(data, where):
    return {"point": data.GetPointData, "cell": data.GetCellData, "field": data.GetFieldData}[where]()


def text_array(count, text="no number"):
    array = vtk.vtkStringArray()
    for _ in range(count):
        array.InsertNextValue(text)
    return array


SPOILERS = {
    "text": lambda values: text_array(len(values)),
    "wide": lambda values: np.stack([values, values], axis=-1).reshape(len(values), -1),
    "short": lambda values: values[:-1],
    "two": lambda values: np.concatenate([values, values]),
    "twice": lambda values: np.where(np.arange(len(values)) == PLACE_OF_VALUE, values[-1], values),
    "numbers": lambda values: np.zeros(1),
}


def spoil(data, where, name, how):
    """A copy with that array, or the points, changed: a key of SPOILERS, "missing", or a value (or tuple) for one
    element."""
    data = copy_of(data)
    if where == "points":
        data.GetPoints().SetPoint(PLACE_OF_VALUE, how, 0, 0)
        return data
    holder = attributes(data, where)
    there = holder.GetAbstractArray(name)
    assert there, (where, name)
    values = None if there.IsA("vtkStringArray") else vtk_to_numpy(there)
    holder.RemoveArray(name)
    if how == "missing":
        return data
    if how in SPOILERS:
        values = SPOILERS[how](values)
    else:
        values = values.astype(float)
        if isinstance(how, tuple):
            values[PLACE_OF_VALUE] = how
        else:
            values.flat[min(PLACE_OF_VALUE, len(values) - 1) * (values.size // len(values))] = how
    array = values if isinstance(values, vtk.vtkAbstractArray) else numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName(name)
    holder.AddArray(array)
    return data


# What is read: (where, name, how it is spoilt).
ARRAY = ("text", "wide", "short")
FINITE = ARRAY + (NAN, INF)
WHOLE = FINITE + (0.5, 1e300)
ONE = ("text", "two", NAN, INF)
LIMITS = {"half_beamwidth": (0.0, -1e-3, 1.05, "missing"), "half_beamwidth_across": (0.2,), "beam_outline": (2,),
          "beam_rotation": (), "beam_profile": (2, "missing"), "gaussian_truncation": (5.0,), "receiver_model": (1, 2),
          "pulse_energy": (0.0, 1e200, "missing"), "pulse_width": (-1e-9, 1e-5, "missing"),
          "frequency": (0.0, "missing"), "sampling_interval": (0.0, 1e300, "missing"),
          "range_gate": (0.0, 1e17, "missing"), "noise_photon_rate": (-1.0, "missing"),
          "lower_energy_limit": (-1e-9, "missing"), "upper_energy_limit": (1e-6, "missing"),
          "receiver_aperture": (-1.0, "missing"), "display_length": (-1.0,), "revolution": (0.5, 1e300)}
OF_BEAMS = [("points", "position", (NAN, 1.1e30)), ("point", "direction", FINITE + ((0, 0, 0), "missing")),
            ("point", "reported_direction", FINITE), ("point", "beam_id", WHOLE + (-1, "twice")),
            ("point", "laser_id", WHOLE), ("point", "azimuth", FINITE), ("point", "vertical_angle", FINITE),
            ("point", "timestamp", FINITE)]
OF_BEAMS += [("field", name, ONE + values) for name, values in LIMITS.items()]
OF_SURFACES = [("points", "point", (NAN, INF, 1e31)), ("cell", "object_id", WHOLE), ("cell", "material_id", WHOLE),
               ("cell", "kd", FINITE + (-0.1,)), ("cell", "ks", FINITE + (0.99, "missing")),
               ("cell", "kp", FINITE + (2e6,)), ("field", "object_classes", ("numbers",)),
               ("field", "object_names", ("numbers",)), ("field", "material_names", ("numbers",))]
OF_REPORT = [("point", name, ("text", "wide", "short", 0.5, NAN)) for name in (
    "beam_id", "laser_id", "status", "skipped", "candidates", "nodes_visited", "rays_traced")]
OF_REPORT += [("point", "azimuth", FINITE), ("point", "vertical_angle", FINITE), ("point", "skipped_bound", ARRAY)]
ORIGIN = ("field", "geodetic_origin", ("text", "two", "short", NAN))
PLACE = [("field", "position", ("text", "two", NAN)), ("field", "orientation", ("text", "two", NAN))]
CLASSES = ("field", "object_classes", ("numbers",))


def algorithms():
    """Each class with good inputs, and what it reads of each."""
    done = scan(surfaces(), beams())
    done.Update()
    cloud = echoes()
    yield make("EchoFilter"), [beams(), surfaces()], [OF_BEAMS, OF_SURFACES]
    yield make("CollisionTree"), [surfaces()], [OF_SURFACES]
    yield make("Material"), [surfaces()], [OF_SURFACES[-2:]]
    yield make("RangeImage", Columns=36, Rows=2), [done.GetOutput(0), done.GetOutput(1)], [
        [("point", "beam_id", WHOLE), ("point", "energy_received", FINITE), ("point", "distance_m", FINITE),
         ("point", "energy", FINITE), ("point", "object_id", WHOLE)], OF_REPORT]
    yield make("HSBColorMap"), [done.GetOutput(0)], [
        [("point", "energy", ARRAY), ("field", "lower_energy_limit", ONE), ("field", "upper_energy_limit", ONE)]]
    yield make("GeodeticTransform"), [cloud], [[ORIGIN]]
    yield make("CloudComparison"), [done.GetOutput(0), cloud], [[], []]
    yield make("Tracker"), [done.GetOutput(0)], [[("point", "timestamp", FINITE), ("field", "half_beamwidth", ONE)]]
    yield make("ClutterFilter"), [cloud], [[PLACE[0]]]
    yield make("UnitNames"), [cloud], [[]]
    yield writer("LAS"), [cloud], [[
        ("points", "point", (1e39,)), ("point", "intensity", FINITE), ("point", "return_number", WHOLE),
        ("point", "number_of_returns", WHOLE), ("point", "timestamp", FINITE), ("point", "vertical_angle", FINITE),
        ("point", "object_id", WHOLE), ("point", "energy", ARRAY), CLASSES, ORIGIN]]
    yield writer("KITTI"), [cloud], [[("points", "point", (1e39, NAN)), ("point", "intensity", FINITE),
                                      ("point", "object_id", WHOLE), CLASSES] + PLACE]
    yield writer("KITTI", LabelSource=1), [cloud], [[("point", "material_id", WHOLE)]]
    yield writer("PCD", Organisation=1), [cloud], [
        [("points", "point", (1e39,)), ("point", "beam_id", WHOLE), ("point", "laser_id", WHOLE),
         ("point", "energy_received", FINITE), ("point", "intensity", ARRAY)] + PLACE
        + [("field", name, ONE)
           for name in ("number_of_channels", "azimuth_step", "minimum_elevation", "elevation_step")]
        + [("field", "azimuth_range", ("text", "two"))]]
    yield writer("PLY"), [cloud], [[("points", "point", (1e39,)), ("point", "energy", ("short",))]]
    yield writer("GeoJSON"), [cloud], [[("point", "energy", FINITE + ("missing",)), ("point", "object_id", WHOLE),
                                        ("point", "material_id", WHOLE), ORIGIN, ("field", "lower_energy_limit", ONE),
                                        ("field", "object_names", ("numbers",)), CLASSES,
                                        ("field", "material_names", ("numbers",))]]
