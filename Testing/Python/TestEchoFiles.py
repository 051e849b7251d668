# SPDX-License-Identifier: BSD-3-Clause
"""Echoes and trees through files: everything in field data comes back, no tree built twice. Tables keep units in the
names of their columns (TestHelperFiles writes CSV files)."""

import os
import pathlib
import re
import subprocess
import sys

import numpy as np
import vtk

import avianlidar
from avianlidar import vtkAvianLidar as al
from avianlidar._cloud import add_array
from cloudtools import cloud, field, names, points, unit
from echotools import Messages, array, assert_same_bits, given, output, scan, town

echo = scan(town())
echo.Update()
echoes = echo.GetOutput()


def through_file(data, name):
    avianlidar.save(data, name)
    reader = vtk.vtkXMLPolyDataReader()
    reader.SetFileName(name)
    return output(reader)


# .vtp: the points, all arrays, and everything in field data.
back = through_file(echoes, "TestEchoFiles.vtp")
assert_same_bits(echoes, back)
fields, again = echoes.GetFieldData(), back.GetFieldData()
written = {fields.GetArrayName(i) for i in range(fields.GetNumberOfArrays())}
beam_fields = echo.GetInputDataObject(0, 0).GetFieldData()
assert written.issuperset(beam_fields.GetArrayName(i) for i in range(beam_fields.GetNumberOfArrays()))
assert written.issuperset("avian_lidar_version scene_checksum perceivable_range object_names material_names".split())
for name in sorted(written):
    one, two = ([data.GetAbstractArray(name).GetVariantValue(i).ToString()
                 for i in range(data.GetAbstractArray(name).GetNumberOfValues())] for data in (fields, again))
    assert one == two, name
assert back.GetPointData().GetArray("energy").GetInformation().Get(vtk.vtkDataArray.UNITS_LABEL()) == "J"

# They are every property, but for those that the class's comment names.
header = (pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Filters"
          / "vtkAvianLidarEchoFilter.h").read_text("utf-8")
comment = " ".join(header.replace("\n *", " ").split()).split("every property of this filter in snake case", 1)[1]
exceptions = comment.split("`avian_lidar_version`")[0].partition("but for ")[2]
properties = {name[3:] for name in dir(echo) if name.startswith("Set") and hasattr(echo, "Get" + name[3:])
              and not hasattr(vtk.vtkPolyDataAlgorithm, name)}
excepted = properties.intersection(re.findall(r"\w+", exceptions))
unsaid = {name for name in properties if not fields.HasArray(re.sub("(?<!^)(?=[A-Z])", "_", name).lower())}
assert unsaid == excepted, unsaid ^ excepted

# Field data are enough to make the file again: the sensor and the settings by their names.
source = al.vtkAvianLidarBeamSource()
for name in ("pulse_energy", "half_beamwidth", "azimuth_step", "elevation_step", "minimum_elevation"):
    getattr(source, "Set" + name.title().replace("_", ""))(again.GetArray(name).GetValue(0))
source.SetNumberOfChannels(int(again.GetArray("number_of_channels").GetComponent(0, 0)))
remade = scan(town(), source, RaysPerBeam=int(again.GetArray("rays_per_beam").GetValue(0)), Seed=0)
assert_same_bits(echoes, output(remade))

# A tree stays behind where surfaces go into a file, and is built again, without a word.
tree = al.vtkAvianLidarCollisionTree()
tree.SetInputData(town())
tree.Update()
assert tree.GetNumberOfBuilds() == 1
other = scan(through_file(tree.GetOutput(), "TestEchoFiles.vtp"))
heard = Messages(other)
other.Update()
assert other.GetNumberOfTreeBuilds() == 1 and not heard.warnings, heard.warnings
assert_same_bits(echoes, other.GetOutput())

# Who asks for one thread gets no others. (A process of its own: threads stay.)
ONE_THREAD = """
import os, sys
from echotools import *
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName("TestEchoFiles.vtp")
reader.Update()
other = scan(reader.GetOutput(), NumberOfThreads=1)
other.UpdateInformation()
before = len(os.listdir("/proc/self/task"))
other.Update()
assert other.GetNumberOfTreeBuilds() == 1
print(len(os.listdir("/proc/self/task")) - before)
"""
if os.path.isdir("/proc/self/task"):
    environment = {**os.environ, "OMP_NUM_THREADS": "4", "PYTHONPATH": os.pathsep.join(sys.path)}
    more = subprocess.run([sys.executable, "-c", ONE_THREAD], env=environment, check=True, capture_output=True,
                          text=True).stdout
    assert more.split()[-1] == "0", more

# A tree of another geometry: one warning, and a tree that fits is built.
transform = vtk.vtkTransform()
transform.Translate(1.0, 0.0, 0.0)
move = vtk.vtkTransformPolyDataFilter()
move.SetTransform(transform)
move.SetInputConnection(tree.GetOutputPort())
other = scan(move)
heard = Messages(other)
other.Update()
assert other.GetNumberOfTreeBuilds() == 1
assert len(heard.warnings) == 1 and "another geometry" in heard.warnings[0], heard.warnings
other.SetSeed(2)
other.Update()
assert len(heard.warnings) == 1
os.remove("TestEchoFiles.vtp")


def renamed(source):
    return output(given(al.vtkAvianLidarUnitNames(), InputData=source))


# Names in a table get their unit, values are shared, order and input stay.
table = renamed(echoes)
for before, after in zip(names(echoes), names(table), strict=True):
    its = unit(echoes, before)
    assert after == (f"{before} [{its}]" if its and its != "1" else before), after
    assert unit(table, after) == its
    assert np.shares_memory(array(table, after), array(echoes, before))
assert {"energy [J]", "azimuth [0.01 deg]", "intensity", "beam_id"} < set(names(table)) and "energy" in names(echoes)
assert field(table, "lower_energy_limit") == field(echoes, "lower_energy_limit")
np.testing.assert_array_equal(points(table), points(echoes))

for name, its, joined in (("a", "m", "a [m]"), ("a", "1", "a"), ("a", "", "a"), ("", "m", " [m]")):
    assert al.vtkAvianLidarUnitNames.NameWithUnit(name, its) == joined

# Cells, rows, texts; nothing at all.
box, rows = cloud([[0, 0, 0]]), vtk.vtkTable()
for holder in (box.GetCellData(), rows.GetRowData()):
    add_array(holder, "length", np.zeros(1), "m")
    add_array(holder, "words", ["x"])
for holder in (renamed(box).GetCellData(), renamed(rows).GetRowData()):
    assert holder.HasArray("length [m]") and holder.HasArray("words")
assert renamed(vtk.vtkPolyData()).GetNumberOfPoints() == 0
