# SPDX-License-Identifier: BSD-3-Clause
"""The table of bad inputs to the collision tree and the echo filter, with the words that each message must hold: for one
process (TestBadInput.py) and for several ranks (TestRanksBadInput.py)."""

import vtk

from echotools import box, sensor, town

NAN, INF = float("nan"), float("inf")


def surfaces(change=None):
    """A box with all five cell arrays, then spoilt."""
    data = vtk.vtkPolyData()
    data.DeepCopy(box((50, 0, 0), (1, 10, 10), "Wall"))
    if change:
        change(data)
    return data


def beams(change=None, piece=0, pieces=1):
    source = sensor(36, 2)
    source.UpdatePiece(piece, pieces, 0)
    data = vtk.vtkPolyData()
    data.DeepCopy(source.GetOutput())
    if change:
        change(data)
    return data


def point(value):
    return lambda data: data.GetPoints().SetPoint(3, value, 0, 0)


def cell(name, value):
    return lambda data: data.GetCellData().GetArray(name).SetComponent(2, 0, value)


def without_cell_array(name):
    return lambda data: data.GetCellData().RemoveArray(name)


def two_components(name, attributes):
    def change(data):
        array = vtk.vtkDoubleArray()
        array.SetName(name)
        array.SetNumberOfComponents(2)
        count = data.GetNumberOfCells() if attributes == "cell" else data.GetNumberOfPoints()
        array.SetNumberOfTuples(count)
        array.Fill(0)
        (data.GetCellData() if attributes == "cell" else data.GetPointData()).AddArray(array)

    return change


def direction(value):
    return lambda data: data.GetPointData().GetArray("direction").SetTuple3(5, *value)


def without_direction(data):
    data.GetPointData().RemoveArray("direction")


def same_id(data):
    data.GetPointData().GetArray("beam_id").SetValue(7, 3)


def negative_id(data):
    data.GetPointData().GetArray("beam_id").SetValue(7, -1)


def field(name, value):
    return lambda data: data.GetFieldData().GetArray(name).SetComponent(0, 0, value)


def without_field(name):
    return lambda data: data.GetFieldData().RemoveArray(name)


def text_field(name):
    def change(data):
        data.GetFieldData().RemoveArray(name)
        array = vtk.vtkStringArray()
        array.SetName(name)
        array.InsertNextValue("wide")
        data.GetFieldData().AddArray(array)

    return change


def text_point(name):
    def change(data):
        data.GetPointData().RemoveArray(name)
        array = vtk.vtkStringArray()
        array.SetName(name)
        for _ in range(data.GetNumberOfPoints()):
            array.InsertNextValue("now")
        data.GetPointData().AddArray(array)

    return change


def far_triangles(data):
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(data)
    triangles.Update()
    data.DeepCopy(triangles.GetOutput())
    data.GetPoints().SetPoint(3, 1e31, 0, 0)


def float_id(data):
    data.GetCellData().RemoveArray("object_id")
    array = vtk.vtkDoubleArray()
    array.SetName("object_id")
    array.SetNumberOfTuples(data.GetNumberOfCells())
    array.Fill(0)
    array.SetValue(2, NAN)
    data.GetCellData().AddArray(array)


def mixed_blocks():
    blocks = town(count=2)
    blocks.SetBlock(2, vtk.vtkUnstructuredGrid())
    blocks.GetMetaData(2).Set(vtk.vtkCompositeDataSet.NAME(), "tetrahedra")
    return blocks


# What is wrong with the surfaces: the words that the message must hold.
bad_surfaces = [
    (surfaces(point(NAN)), ["surfaces", "point 3", "not finite"]),
    (surfaces(point(INF)), ["surfaces", "point 3", "not finite"]),
    (surfaces(cell("kd", -0.1)), ["cell 2: kd"]),
    (surfaces(cell("kd", NAN)), ["kd"]),
    (surfaces(cell("ks", 0.99)), ["kd + ks"]),
    (surfaces(cell("kp", 2e6)), ["kp"]),
    (surfaces(without_cell_array("ks")), ["kd, ks, kp"]),
    (surfaces(two_components("kd", "cell")), ["'kd'", "2 components"]),
    (surfaces(two_components("object_id", "cell")), ["'object_id'", "2 components"]),
    (surfaces(lambda data: data.GetCellData().GetArray("kd").SetNumberOfTuples(3)), ["'kd'", "3 values", "expected 6"]),
    (surfaces(lambda data: data.GetPolys().ReplaceCellAtId(2, 4, [0, 1, 2, 99])), ["point id"]),
    (surfaces(float_id), ["cell 2", "'object_id'"]),
    (surfaces(far_triangles), ["point 3", "1e30"]),
    (mixed_blocks(), ["tetrahedra", "vtkPolyData"]),
]

# What is wrong with the beams or the sensor.
bad_beams = [
    (without_direction, ["'direction'", "missing"]),
    (two_components("direction", "point"), ["'direction'", "2 components"]),
    (direction((0, 0, 0)), ["beam 5", "'direction'", "zero"]),
    (direction((NAN, 0, 1)), ["beam 5", "'direction'", "not finite"]),
    (direction((INF, 0, 1)), ["beam 5", "'direction'", "not finite"]),
    (point(NAN), ["beam 3", "position"]),
    (point(1.1e30), ["beam 3", "position", "1e30"]),
    (same_id, ["'beam_id'", "3 twice", "one sensor"]),
    (negative_id, ["beam 7", "'beam_id'"]),
    (two_components("beam_id", "point"), ["'beam_id'", "2 components"]),
    (two_components("laser_id", "point"), ["'laser_id'", "2 components"]),
    (text_point("timestamp"), ["'timestamp'", "holds no numbers"]),
    (lambda data: data.GetPointData().GetArray("direction").SetNumberOfTuples(1), ["'direction'", "1 values"]),
    (field("range_gate", 1e17), ["range_gate", "2^52"]),
    (text_field("half_beamwidth"), ["'half_beamwidth'"]),
    (field("half_beamwidth", 0.0), ["half_beamwidth", "60 degrees"]),
    (field("half_beamwidth", -1e-3), ["half_beamwidth", "60 degrees"]),
    (field("half_beamwidth", 1.05), ["half_beamwidth", "60 degrees"]),
    (field("half_beamwidth", NAN), ["half_beamwidth"]),
    (field("beam_profile", 2), ["beam_profile"]),
    (field("beam_outline", 2), ["beam_outline"]),
    (field("half_beamwidth_across", 0.2), ["half_beamwidth_across", "0.1 rad"]),
    (field("gaussian_truncation", 5.0), ["gaussian_truncation", "0.1 to 3"]),
    (field("receiver_model", 2), ["receiver_model", "neither 0"]),
    (text_field("receiver_model"), ["receiver_model"]),
    (field("receiver_model", 1), ["receiver_aperture", "photons"]),
    (field("pulse_energy", 0.0), ["pulse_energy"]),
    (field("pulse_energy", INF), ["pulse_energy"]),
    (field("pulse_energy", 1e200), ["pulse_energy", "1e-50 to 1e50 J"]),
    (field("sampling_interval", 1e300), ["sampling_interval", "1e-30 to 1e20 s"]),
    (field("display_length", -1.0), ["display_length", "1e30 m"]),
    (field("sampling_interval", 0.0), ["sampling_interval"]),
    (field("pulse_width", -1e-9), ["pulse_width"]),
    (field("pulse_width", 1e-5), ["pulse_width", "1000"]),
    (field("frequency", 0.0), ["frequency"]),
    (field("range_gate", 0.0), ["range_gate"]),
    (field("noise_photon_rate", -1.0), ["noise_photon_rate"]),
    (field("lower_energy_limit", -1e-9), ["lower_energy_limit"]),
    (field("upper_energy_limit", 1e-6), ["upper_energy_limit", "lower_energy_limit"]),
    (field("receiver_aperture", -1.0), ["receiver_aperture"]),
]
required = """half_beamwidth beam_profile pulse_energy pulse_width frequency sampling_interval range_gate noise_photon_rate
lower_energy_limit upper_energy_limit receiver_aperture""".split()
bad_beams += [(without_field(name), [f"'{name}'", "missing"]) for name in required]

# What is wrong with the filters' own properties: the message names the property.
bad_properties = [
    ("Preset", -1),
    ("Preset", 4),
    ("RaysPerBeam", 0),
    ("RaysPerBeam", -5),
    ("RaysPerBeam", 1000001),
    ("Sampling", 2),
    ("BeamSamples", 2),
    ("AttenuationCoefficient", -1e-9),
    ("AttenuationCoefficient", INF),
    ("ReflectanceModel", 4),
    ("NumberOfReflections", 0),
    ("NumberOfReflections", 3),
    ("LightEnergyFraction", -1e-9),
    ("LightEnergyFraction", 1.1e8),
    ("LightEnergyFraction", NAN),
    ("LightEnergyThreshold", -1),
    ("LightEnergyThreshold", 2),
    ("ReturnMode", -1),
    ("ReturnMode", 5),
    ("NumberOfConnections", -1),
    ("NumberOfConnections", 2000000000),  # with the rays below: more paths than can be numbered
    ("BatchCollisionDetection", 3),
    ("NumberOfThreads", -1),
    ("MaximumCacheSize", -1),
]
bad_tree_properties = [("SplitRule", 4), ("BoundingVolume", -1), ("MaximumLeafSize", 0)]
