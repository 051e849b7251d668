# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of faults share: each class with producers of small inputs that are good, what it reads of them, and
how that is spoilt."""
import contextlib
import resource

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from avianlidar import vtkAvianLidar as al
from cloudtools import ORIGIN, WRITERS, add_field
from echotools import box, copy_of, given, scan, sensor, town

NAN, INF = float("nan"), float("inf")
PLACE_OF_VALUE = 3  # of the one value of an array that is spoilt


@contextlib.contextmanager
def limited(kind, size):
    """A limit of this process. @param kind RLIMIT_AS, or another one of `resource`"""
    limits = resource.getrlimit(kind)
    resource.setrlimit(kind, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(kind, limits)


def disk(size):
    """Files may not grow beyond this: as if the disk were full then."""
    return limited(resource.RLIMIT_FSIZE, size)


def make(name, **properties):
    return given(getattr(al, "vtkAvianLidar" + name)(), **properties)


def writer(name, file="echoes", **properties):
    return make(name + "Writer", FileName=file + WRITERS[name], **properties)


def outputs(algorithm):
    return [algorithm.GetOutputDataObject(port) for port in range(algorithm.GetNumberOfOutputPorts())]


def size_of(data):
    return sum(data.GetNumberOfElements(kind) for kind in (vtk.vtkDataObject.POINT, vtk.vtkDataObject.CELL,
                                                           vtk.vtkDataObject.ROW))


def error_of(data):
    """The field data `error`, or nothing."""
    array = data.GetFieldData().GetAbstractArray("error")
    return array.GetValue(0) if array else ""


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
LIMITS = {
    "half_beamwidth": (0.0, -1e-3, 1.05, "missing"), "half_beamwidth_across": (0.2,), "beam_outline": (2,),
    "beam_rotation": (), "beam_profile": (2, "missing"), "gaussian_truncation": (5.0,), "receiver_model": (1, 2),
    "pulse_energy": (0.0, 1e200, "missing"), "pulse_width": (-1e-9, 1e-5, "missing"), "frequency": (0.0, "missing"),
    "sampling_interval": (0.0, 1e300, "missing"), "range_gate": (0.0, 1e17, "missing"),
    "noise_photon_rate": (-1.0, "missing"), "lower_energy_limit": (-1e-9, "missing"),
    "upper_energy_limit": (1e-6, "missing"), "receiver_aperture": (-1.0, "missing"), "display_length": (-1.0,),
    "revolution": (0.5, 1e300)}
CLASS_NAMES = ("field", "object_classes", ("numbers",))
NAMED = ("field", "object_names", ("numbers",)), ("field", "material_names", ("numbers",))
OF_BEAMS = [("points", "position", (NAN, 1.1e30)), ("point", "direction", FINITE + ((0, 0, 0), "missing")),
            ("point", "reported_direction", FINITE), ("point", "beam_id", WHOLE + (-1, "twice")),
            ("point", "laser_id", WHOLE), ("point", "azimuth", FINITE), ("point", "vertical_angle", FINITE),
            ("point", "timestamp", FINITE)]
OF_BEAMS += [("field", name, ONE + values) for name, values in LIMITS.items()]
OF_SURFACES = [("points", "point", (NAN, INF, 1e31)), ("cell", "object_id", WHOLE), ("cell", "material_id", WHOLE),
               ("cell", "kd", FINITE + (-0.1,)), ("cell", "ks", FINITE + (0.99, "missing")),
               ("cell", "kp", FINITE + (2e6,)),
               CLASS_NAMES, *NAMED]
OF_REPORT = [("point", name, ("text", "wide", "short", 0.5, NAN)) for name in (
    "beam_id", "laser_id", "status", "skipped", "candidates", "nodes_visited", "rays_traced")]
OF_REPORT += [("point", "azimuth", FINITE), ("point", "vertical_angle", FINITE + ("missing",)),
              ("point", "skipped_bound", ARRAY)]
ORIGIN_READ = ("field", "geodetic_origin", ("text", "two", "short", NAN))
PLACE = [("field", "position", ("text", "two", NAN)), ("field", "orientation", ("text", "two", NAN))]


SETTINGS = {"RaysPerBeam": 20, "NumberOfThreads": 1}


class Producer:
    """An algorithm of ours that can be made to fail and be mended again."""

    def __init__(self, algorithm, setting, good, words, port=0):
        self.algorithm, self.setting, self.good, self.words = algorithm, setting, good, words
        self.port = algorithm.GetOutputPort(port)
        self.set(good)

    def set(self, value):
        getattr(self.algorithm, "Set" + self.setting)(value)

    def data(self):
        self.algorithm.Update()
        return self.algorithm.GetOutputDataObject(self.port.GetIndex())


def produced_beams(columns=36, channels=2):
    return Producer(given(sensor(columns, channels), SwayAmplitude=0.01), "PulseEnergy", 3.6e-4, "PulseEnergy")


def produced_surfaces():
    material = given(al.vtkAvianLidarMaterial(), InputData=surfaces())
    material.SetMaterialToCustom()
    return Producer(material, "Kd", 0.3, "Material: ")


def produced_scan(port=0):
    return Producer(scan(surfaces(), beams()), "AttenuationCoefficient", 3.5e-5, "AttenuationCoefficient", port)


def produced_echoes(**fields):
    """Of a scene with an origin and classes."""
    blocks = town()
    for name, values in {"geodetic_origin": ORIGIN, "object_classes": ["terminal", "ground", "runway", "fence",
                                                                       "no such word"] * 8, **fields}.items():
        add_field(blocks, name, values)
    # wide, for several returns
    source = given(sensor(), Position=(10.0, 20.0, 3.0), Orientation=(30.0, 2.0, 1.0), HalfBeamwidth=0.03)
    return Producer(scan(blocks, source, **SETTINGS), "AttenuationCoefficient", 3.5e-5, "AttenuationCoefficient")


NOTHING = ()
OF_IMAGE = [("point", name, ways + ("missing",)) for name, ways in (
    ("beam_id", WHOLE), ("energy_received", FINITE), ("distance_m", FINITE), ("energy", FINITE), ("object_id", WHOLE))]
# Every class with inputs: its name, properties, the producers of its inputs and what it reads of each. A later class is
# a row.
CLASSES = [
    ("EchoFilter", {}, (produced_beams, OF_BEAMS), (produced_surfaces, OF_SURFACES)),
    ("CollisionTree", {}, (produced_surfaces, OF_SURFACES)),
    ("Material", {}, (produced_surfaces, OF_SURFACES[-2:])),
    ("RangeImage", {"Columns": 36, "Rows": 2}, (produced_scan, OF_IMAGE), (lambda: produced_scan(1), OF_REPORT)),
    ("HSBColorMap", {}, (produced_scan, [("point", "energy", ARRAY), ("field", "lower_energy_limit", ONE),
                                         ("field", "upper_energy_limit", ONE)])),
    ("GeodeticTransform", {}, (produced_echoes, [ORIGIN_READ])),
    ("CloudComparison", {}, (produced_scan, NOTHING), (produced_echoes, NOTHING)),
    # A cloud of a time is the same scan when it is executed again.
    ("Tracker", {}, (lambda: produced_echoes(TimeValue=(3.0,)),
                     [("point", "timestamp", FINITE), ("field", "half_beamwidth", ONE)])),
    ("ClutterFilter", {}, (produced_echoes, [PLACE[0]])),
    ("UnitNames", {}, (produced_echoes, NOTHING)),
    ("BeamView", {"BeamId": 9}, (produced_beams, NOTHING), (produced_surfaces, NOTHING)),
    ("Landmarks", {}, (produced_beams, NOTHING), (produced_surfaces, NOTHING)),
    ("Coverage", {}, (lambda: produced_beams(18, 1), NOTHING), (produced_surfaces, NOTHING)),
    ("Medium", {"Shape": al.vtkAvianLidarMedium.SHAPE_SURFACE}, (produced_surfaces, NOTHING)),
    ("Tracks", {"Pattern": al.vtkAvianLidarTracks.PATTERN_LINES},
     (lambda: Producer(make("Tracks"), "Radius", 500.0, "Radius", 1), NOTHING)),
    ("BeamSource", {"NumberOfChannels": 2}, (  # carried along the trail of a bird
        lambda: Producer(make("Tracks", NumberOfBirds=1), "Radius", 500.0, "Radius", 1),
        [("point", "time", ARRAY + ("missing",))])),
    ("LASWriter", {}, (produced_echoes, [
        ("points", "point", (1e39,)), ("point", "intensity", FINITE), ("point", "return_number", WHOLE),
        ("point", "number_of_returns", WHOLE), ("point", "timestamp", FINITE), ("point", "vertical_angle", FINITE),
        ("point", "object_id", WHOLE), ("point", "energy", ARRAY), CLASS_NAMES,
        ORIGIN_READ])),
    ("KITTIWriter", {}, (produced_echoes, [
        ("points", "point", (1e39, NAN)), ("point", "intensity", FINITE), ("point", "object_id", WHOLE), CLASS_NAMES,
        *PLACE])),
    ("KITTIWriter", {"LabelSource": 1}, (produced_echoes, [("point", "material_id", WHOLE)])),
    ("PCDWriter", {"Organisation": 1}, (produced_echoes, [
        ("points", "point", (1e39,)), ("point", "beam_id", WHOLE), ("point", "laser_id", WHOLE),
        ("point", "energy_received", FINITE), ("point", "intensity", ARRAY), *PLACE,
        ("field", "azimuth_range", ("text", "two")),
        *(("field", name, ONE) for name in ("number_of_channels", "azimuth_step", "minimum_elevation",
                                            "elevation_step"))])),
    ("PLYWriter", {}, (produced_echoes, [("points", "point", (1e39,)), ("point", "energy", ("short",))])),
    ("GeoJSONWriter", {}, (produced_echoes, [
        ("point", "energy", FINITE + ("missing",)), ("point", "object_id", WHOLE), ("point", "material_id", WHOLE),
        ORIGIN_READ, ("field", "lower_energy_limit", ONE), CLASS_NAMES, *NAMED]))]


def algorithms():
    """(class, its good inputs, what it reads of each) of each row."""
    for name, properties, *inputs in CLASSES:
        one = writer(name[:-len("Writer")], **properties) if name.endswith("Writer") else make(name, **properties)
        yield one, [produce().data() for produce, _ in inputs], [reads for _, reads in inputs]
