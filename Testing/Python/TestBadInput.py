# SPDX-License-Identifier: BSD-3-Clause
"""Every kind of bad input to the collision tree and the echo filter: the documented message, and empty outputs."""

import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from echotools import Messages, box, scan, sensor, town

NAN, INF = float("nan"), float("inf")


def surfaces(change=None):
    """A box with all five cell arrays, then spoilt."""
    data = vtk.vtkPolyData()
    data.DeepCopy(box((50, 0, 0), (1, 10, 10), "Wall"))
    if change:
        change(data)
    return data


def beams(change=None):
    source = sensor(36, 2)
    source.Update()
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
for data, words in bad_surfaces:
    for algorithm in (al.vtkAvianLidarCollisionTree(), scan(data)):
        if algorithm.IsA("vtkAvianLidarCollisionTree"):
            algorithm.SetInputData(data)
        heard = Messages(algorithm)
        algorithm.Update()
        assert len(heard.errors) == 1, (words, heard.errors)
        assert all(word in heard.errors[0] for word in words), (words, heard.errors[0])
        assert "nput port" in heard.errors[0], heard.errors[0]
        for port in (0, 1):
            assert algorithm.GetOutput(port).GetNumberOfPoints() == 0

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
    (lambda data: data.GetPointData().GetArray("direction").SetNumberOfTuples(1), ["'direction'", "1 values"]),
    (field("range_gate", 1e17), ["range_gate", "2^52"]),
    (text_field("half_beamwidth"), ["'half_beamwidth'"]),
    (field("half_beamwidth", 0.0), ["half_beamwidth", "60 degrees"]),
    (field("half_beamwidth", -1e-3), ["half_beamwidth", "60 degrees"]),
    (field("half_beamwidth", 1.05), ["half_beamwidth", "60 degrees"]),
    (field("half_beamwidth", NAN), ["half_beamwidth"]),
    (field("beam_profile", 2), ["beam_profile"]),
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
for change, words in bad_beams:
    echo = scan(surfaces(), beams(change))
    heard = Messages(echo)
    echo.Update()
    assert len(heard.errors) == 1, (words, heard.errors)
    assert all(word in heard.errors[0] for word in words), (words, heard.errors[0])
    assert "nput port 0" in heard.errors[0], heard.errors[0]
    assert echo.GetOutput().GetNumberOfPoints() == 0 and echo.GetOutput(1).GetNumberOfPoints() == 0

# What is wrong with the filters' own properties: the message names the property.
bad_properties = [
    ("Preset", -1),
    ("Preset", 4),
    ("RaysPerBeam", 0),
    ("RaysPerBeam", -5),
    ("RaysPerBeam", 1000001),
    ("Sampling", 2),
    ("TargetRelativeError", -0.1),
    ("TargetRelativeError", 1.0),
    ("TargetRelativeError", NAN),
    ("AttenuationCoefficient", -1e-9),
    ("AttenuationCoefficient", INF),
    ("ReflectanceModel", 3),
    ("NumberOfReflections", 0),
    ("NumberOfReflections", 3),
    ("ReturnMode", -1),
    ("ReturnMode", 5),
    ("NumberOfConnections", -1),
    ("NumberOfConnections", 2000000000),  # with the rays below: more paths than can be numbered
    ("Precision", 2),
    ("NumberOfThreads", -1),
    ("MaximumCacheSize", -1),
]
for name, value in bad_properties:
    echo = scan(surfaces(), beams(), **({"RaysPerBeam": 70000} if value == 2000000000 else {}), **{name: value})
    heard = Messages(echo)
    echo.Update()
    assert len(heard.errors) == 1 and name in heard.errors[0] and "expected" in heard.errors[0], (name, heard.errors)
    assert echo.GetOutput().GetNumberOfPoints() == 0
for name, value in (("SplitRule", 4), ("BoundingVolume", -1), ("MaximumLeafSize", 0)):
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(surfaces())
    getattr(tree, "Set" + name)(value)
    heard = Messages(tree)
    tree.Update()
    assert len(heard.errors) == 1 and name in heard.errors[0] and "expected" in heard.errors[0], (name, heard.errors)
    assert tree.GetOutput().GetNumberOfPoints() == 0

# Noise that would drown the scan in false alarms is refused before it fills the memory.
loud = sensor(36, 2)
loud.SetNoisePhotonRate(1e15)
loud.SetSamplingInterval(1e-11)
loud.SetPulseWidth(0)
loud.SetLowerEnergyLimit(1e-18)
echo = scan(surfaces(), loud)
heard = Messages(echo)
echo.Update()
assert len(heard.errors) == 1 and "false alarms" in heard.errors[0], heard.errors

# Legal but empty: silence, and empty outputs.
nothing = vtk.vtkPolyData()
for data in (nothing, vtk.vtkMultiBlockDataSet()):
    echo = scan(data)
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(data)
    heard = Messages(echo, tree)
    echo.Update()
    tree.Update()
    assert not heard.errors and not heard.warnings, (heard.errors, heard.warnings)
    assert echo.GetOutput().GetNumberOfPoints() == 0 and tree.GetOutput().GetNumberOfCells() == 0
    assert echo.GetOutput(1).GetNumberOfPoints() == 360  # every beam says: no surface
no_beams = vtk.vtkPolyData()
spoilt = vtk.vtkPolyData()
spoilt.GetFieldData().PassData(beams(field("lower_energy_limit", -1.0)).GetFieldData())
for data in (no_beams, spoilt):
    echo = scan(surfaces(), data)
    heard = Messages(echo)
    echo.Update()
    assert not heard.errors and not heard.warnings
    assert echo.GetOutput().GetNumberOfPoints() == 0

# Suspicious: surfaces without coefficients are Wall, said once per scene.
plain = surfaces(lambda data: [data.GetCellData().RemoveArray(name) for name in ("kd", "ks", "kp")])
echo, wall = scan(plain), scan(surfaces())
heard = Messages(echo)
for seed in (0, 1):
    echo.SetSeed(seed)
    wall.SetSeed(seed)
    echo.Update()
    wall.Update()
    assert echo.GetOutput().GetNumberOfPoints() == wall.GetOutput().GetNumberOfPoints() > 0
assert len(heard.warnings) == 1 and "Wall" in heard.warnings[0] and "Group Datasets" in heard.warnings[0]

# Said again when a scene that had a material loses it.
material = al.vtkAvianLidarMaterial()
material.SetInputData(plain)
for algorithm in (al.vtkAvianLidarCollisionTree(), scan(material)):
    port = algorithm.GetNumberOfInputPorts() - 1
    algorithm.SetInputConnection(port, material.GetOutputPort())
    heard = Messages(algorithm)
    algorithm.Update()
    assert not heard.warnings, heard.warnings
    algorithm.SetInputDataObject(port, plain)
    algorithm.Update()
    assert len(heard.warnings) == 1 and "Wall" in heard.warnings[0], heard.warnings



def far_away(precision, distance):
    """A scene with a material, its points that far out in this type."""
    data = surfaces()
    points = vtk.vtkPoints()
    points.SetDataType(precision)
    for i in range(data.GetNumberOfPoints()):
        x, y, z = data.GetPoint(i)
        points.InsertNextPoint(x, y + distance, z)
    data.SetPoints(points)
    return data


# Points in single precision far from the origin: said once per scene, with what they are rounded to.
for algorithm in (al.vtkAvianLidarCollisionTree(), scan(surfaces())):
    port = algorithm.GetNumberOfInputPorts() - 1
    heard = Messages(algorithm)
    for near in (far_away(vtk.VTK_DOUBLE, 5e6), far_away(vtk.VTK_FLOAT, 3e4)):
        algorithm.SetInputDataObject(port, near)
        algorithm.Update()
    assert not heard.warnings and not heard.errors, (heard.warnings, heard.errors)
    algorithm.SetInputDataObject(port, far_away(vtk.VTK_FLOAT, 5e6))
    algorithm.Update()
    algorithm.Modified()
    algorithm.Update()
    assert len(heard.warnings) == 1 and "single precision" in heard.warnings[0], heard.warnings
    assert "5e+06 m" in heard.warnings[0] and "0.5 m" in heard.warnings[0], heard.warnings

# More range units than there is memory for.
units = sensor(36, 2)
units.SetSamplingInterval(1e-12)
units.SetPulseWidth(1e-9)
units.SetRangeGate(1e5)
echo = scan(surfaces(), units)
echo.SetRaysPerBeam(100000)
heard = Messages(echo)
echo.Update()
assert any(all(word in error for word in ("pulse_width", "RaysPerBeam", "range units")) for error in heard.errors), heard.errors
assert echo.GetNumberOfTreeBuilds() == 0
assert echo.GetOutput().GetNumberOfPoints() == 0

# Polygons of any kind are triangulated: quads, strips and a concave polygon; vertices and lines are no surface.
strips = vtk.vtkStripper()
strips.SetInputData(surfaces())
strips.Update()
mixed = vtk.vtkAppendPolyData()
for part in (surfaces(), strips.GetOutput()):
    only = vtk.vtkPolyData()
    only.CopyStructure(part)
    mixed.AddInputData(only)
outline = vtk.vtkOutlineFilter()
outline.SetInputData(surfaces())
outline.Update()
mixed.AddInputData(outline.GetOutput())
tree = al.vtkAvianLidarCollisionTree()
tree.SetInputConnection(mixed.GetOutputPort())
tree.Update()
assert tree.GetOutput().GetNumberOfPolys() == 24
concave = vtk.vtkPolyData()
points = vtk.vtkPoints()
polygons = vtk.vtkCellArray()
for p in ((0, 0, 0), (4, 0, 0), (4, 4, 0), (2, 1, 0), (0, 4, 0)):
    points.InsertNextPoint(*p)
polygons.InsertNextCell(5, list(range(5)))
concave.SetPoints(points)
concave.SetPolys(polygons)
tree.SetInputData(concave)
tree.Update()
mass = vtk.vtkMassProperties()
mass.SetInputData(tree.GetOutput())
assert tree.GetOutput().GetNumberOfPolys() == 3 and abs(mass.GetSurfaceArea() - 10.0) < 1e-12

# Beams of anyone's making: points with float directions of any length and the sensor's field data are enough.
own = vtk.vtkPolyData()
own_points = vtk.vtkPoints()
own_directions = vtk.vtkFloatArray()
own_directions.SetName("direction")
own_directions.SetNumberOfComponents(3)
for d in ((5.0, 0.0, 0.0), (0.0, 0.1, 0.0)):
    own_points.InsertNextPoint(0, 0, 0)
    own_directions.InsertNextTuple3(*d)
own.SetPoints(own_points)
own.GetPointData().AddArray(own_directions)
own.GetFieldData().PassData(beams().GetFieldData())
echo = scan(surfaces(), own)
heard = Messages(echo)
echo.Update()
assert not heard.errors, heard.errors
assert echo.GetOutput().GetNumberOfPoints() == 1
assert abs(echo.GetOutput().GetPointData().GetArray("azimuth").GetValue(0) - 9000.0) < 1e-9
assert np.isclose(echo.GetOutput().GetPoint(0)[0], 49.0, atol=0.01)

# Of any length, and with an azimuth in [0, 36000).
extreme = vtk.vtkPolyData()
extreme.DeepCopy(own)
doubles = vtk.vtkDoubleArray()
doubles.SetName("direction")
doubles.SetNumberOfComponents(3)
doubles.InsertNextTuple3(1e-307, 0, 0)
doubles.InsertNextTuple3(1.5e308, 1e307, 0)
extreme.GetPointData().AddArray(doubles)
echo = scan(surfaces(), extreme)
echo.Update()
assert echo.GetOutput().GetNumberOfPoints() == 2
assert np.isclose(echo.GetOutput().GetPoint(0)[0], 49.0, atol=0.01)
doubles.SetTuple3(0, -1e-17, 1, 0)
doubles.Modified()
echo = scan(box((0, 50, 0), (10, 1, 10), "Wall"), extreme)
echo.Update()
assert echo.GetOutput().GetPointData().GetArray("azimuth").GetValue(0) == 0.0
