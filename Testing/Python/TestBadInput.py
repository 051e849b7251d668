# SPDX-License-Identifier: BSD-3-Clause
"""Every kind of bad input to the collision tree and the echo filter: the documented message, and empty outputs."""

import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from avianlidar._scene import COEFFICIENTS
from badinput import bad_beams, bad_properties, bad_surfaces, bad_tree_properties, beams, field, surfaces
from echotools import Messages, box, scan, sensor

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

for change, words in bad_beams:
    echo = scan(surfaces(), beams(change))
    heard = Messages(echo)
    echo.Update()
    assert len(heard.errors) == 1, (words, heard.errors)
    assert all(word in heard.errors[0] for word in words), (words, heard.errors[0])
    assert "nput port 0" in heard.errors[0], heard.errors[0]
    assert echo.GetOutput().GetNumberOfPoints() == 0 and echo.GetOutput(1).GetNumberOfPoints() == 0

for name, value in bad_properties:
    echo = scan(surfaces(), beams(), **({"RaysPerBeam": 70000} if value == 2000000000 else {}), **{name: value})
    heard = Messages(echo)
    echo.Update()
    assert len(heard.errors) == 1 and name in heard.errors[0] and "expected" in heard.errors[0], (name, heard.errors)
    assert echo.GetOutput().GetNumberOfPoints() == 0
for name, value in bad_tree_properties:
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(surfaces())
    getattr(tree, "Set" + name)(value)
    heard = Messages(tree)
    tree.Update()
    assert len(heard.errors) == 1 and name in heard.errors[0] and "expected" in heard.errors[0], (name, heard.errors)
    assert tree.GetOutput().GetNumberOfPoints() == 0

# An input that is missing: one error that says which, and how to connect it; connected, all is well.
for make in (al.vtkAvianLidarEchoFilter, al.vtkAvianLidarCoverage):
    for connected, words in ((1, "Input port 0 (beams) is not connected"), (0, "Input port 1 (surfaces) is not connected")):
        algorithm = make()
        algorithm.SetInputData(connected, (beams(), surfaces())[connected])
        heard = Messages(algorithm)
        algorithm.Update()
        assert len(heard.errors) == 1 and words in heard.errors[0] and "Change Input" in heard.errors[0], heard.errors
        algorithm.SetInputData(1 - connected, (surfaces(), beams())[connected])
        algorithm.Update()
        assert len(heard.errors) == 1 and algorithm.GetOutputDataObject(0).GetNumberOfElements(0) > 0, heard.errors

# Inputs the other way round: an error that says which, and what belongs there.
for make, port in ((al.vtkAvianLidarEchoFilter, 1), (al.vtkAvianLidarCoverage, 1), (al.vtkAvianLidarCollisionTree, 0)):
    algorithm = make()
    if port:
        algorithm.SetInputData(0, beams())
    algorithm.SetInputData(port, beams())
    heard = Messages(algorithm)
    algorithm.Update()
    words = (f"Input port {port}, surfaces: these are beams, expected polygons", "Change Input")
    assert len(heard.errors) == 1 and all(word in heard.errors[0] for word in words), heard.errors
echo = scan(surfaces(), surfaces())
heard = Messages(echo)
echo.Update()
words = ("Input port 0 (beams), point array 'direction' is missing", "output Beams of a beam source (in ParaView: Edit > Change Input > Beams)")
assert len(heard.errors) == 1 and all(word in heard.errors[0] for word in words), heard.errors

# Points and lines alone are no surface: a warning, once. Nothing at all is a legal scene.
rays = vtk.vtkLineSource()
rays.Update()
echo = scan(rays.GetOutput(), beams())
heard = Messages(echo)
for _ in range(2):
    echo.Modified()
    echo.Update()
assert not heard.errors and len(heard.warnings) == 1, heard.warnings
assert "Input port 1, surfaces: 2 points without a polygon, expected surfaces" in heard.warnings[0], heard.warnings

# Something astray far away: a warning, once, and the same echoes.
both = vtk.vtkAppendPolyData()
both.AddInputData(surfaces())
both.AddInputData(box((1e16, 0, 0), (1, 10, 10), "Wall"))
both.Update()
near, astray = scan(surfaces(), beams()), scan(both.GetOutput(), beams())
heard = Messages(astray)
near.Update()
astray.Update()
assert not heard.errors and len(heard.warnings) == 1, heard.warnings
assert "Input port 1, surfaces: points lie 1e+16 m apart, expected at most 1e8 m" in heard.warnings[0], heard.warnings
assert astray.GetOutput().GetNumberOfPoints() == near.GetOutput().GetNumberOfPoints() > 0

echo = scan(vtk.vtkPolyData(), beams())
heard = Messages(echo)
echo.Update()
assert not heard.errors and not heard.warnings and echo.GetOutput().GetNumberOfPoints() == 0, heard.warnings

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
plain = surfaces(lambda data: [data.GetCellData().RemoveArray(name) for name in COEFFICIENTS])
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
    port = min(1, algorithm.GetNumberOfInputPorts() - 1)  # the surfaces
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
    port = min(1, algorithm.GetNumberOfInputPorts() - 1)  # the surfaces
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
