# SPDX-License-Identifier: BSD-3-Clause
"""Tables keep units: in the names of a CSV file, through the filter, and in VTK's XML files by themselves."""

import os

import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from cloudtools import assert_same_arrays, cloud, echoes, field, names, points, unit
from echotools import array

data = echoes()


def renamed(source):
    filter_ = al.vtkAvianLidarUnitNames()
    filter_.SetInputData(source)
    filter_.Update()
    return filter_.GetOutputDataObject(0)


# Names get their unit, values are shared, order and input stay.
table = renamed(data)
expected = {
    "energy": "energy [J]", "distance_m": "distance_m [m]", "azimuth": "azimuth [0.01 deg]",
    "timestamp": "timestamp [us]", "incidence_angle": "incidence_angle [deg]", "intensity": "intensity",
    "beam_id": "beam_id", "return_number": "return_number",
}
assert len(names(table)) == len(names(data))
for before, after in zip(names(data), names(table)):
    its = unit(data, before)
    assert after == (f"{before} [{its}]" if its and its != "1" else before), after
    assert after == expected.get(before, after), after
    assert unit(table, after) == its
    np.testing.assert_array_equal(array(table, after), array(data, before))
assert "energy" in names(data)
array(data, "energy")[0] += 1.0
assert array(table, "energy [J]")[0] == array(data, "energy")[0]
array(data, "energy")[0] -= 1.0
assert field(table, "lower_energy_limit") == field(data, "lower_energy_limit")
np.testing.assert_array_equal(points(table), points(data))

for name, its, joined in (("a", "m", "a [m]"), ("a", "1", "a"), ("a", "", "a"), ("", "m", " [m]")):
    assert al.vtkAvianLidarUnitNames.NameWithUnit(name, its) == joined

# Cells, rows, texts, arrays without names; nothing at all.
box = vtk.vtkPolyData()
box.DeepCopy(cloud([[0, 0, 0]]))
rows = vtk.vtkTable()
for holder in (box.GetCellData(), rows.GetRowData()):
    length = vtk.vtkFloatArray()
    length.SetName("length")
    length.GetInformation().Set(vtk.vtkDataArray.UNITS_LABEL(), "m")
    texts = vtk.vtkStringArray()
    texts.SetName("words")
    holder.AddArray(length)
    holder.AddArray(texts)
assert renamed(box).GetCellData().HasArray("length [m]") and renamed(box).GetCellData().HasArray("words")
assert renamed(rows).GetRowData().HasArray("length [m]") and renamed(rows).GetRowData().HasArray("words")
assert renamed(vtk.vtkPolyData()).GetNumberOfPoints() == 0

# CSV: numbers with 15 digits, read back by name.
columns = [table.GetPointData().GetArray(name) for name in names(table)]
columns = [column for column in columns if column and column.GetNumberOfComponents() == 1]
with open("TestUnitNames.csv", "w", encoding="ascii") as file:
    file.write(",".join(column.GetName() for column in columns) + "\n")
    for i in range(table.GetNumberOfPoints()):
        file.write(",".join(f"{column.GetTuple1(i):.15g}" for column in columns) + "\n")
reader = vtk.vtkDelimitedTextReader()
reader.SetFileName("TestUnitNames.csv")
reader.SetHaveHeaders(True)
reader.DetectNumericColumnsOn()
reader.Update()
back = reader.GetOutput()
os.remove("TestUnitNames.csv")
energy = back.GetColumnByName("energy [J]")
values = np.array([energy.GetVariantValue(i).ToDouble() for i in range(energy.GetNumberOfValues())])
np.testing.assert_allclose(values, array(data, "energy"), rtol=1e-14)

# XML files (DataMode Binary, see the README) keep units where they are, and field data with them.
writer = vtk.vtkXMLPolyDataWriter()
writer.SetInputData(data)
writer.SetFileName("TestUnitNames.vtp")
writer.SetDataModeToBinary()
assert writer.Write()
again = vtk.vtkXMLPolyDataReader()
again.SetFileName("TestUnitNames.vtp")
again.Update()
os.remove("TestUnitNames.vtp")
assert_same_arrays(data, again.GetOutput())
units = again.GetOutput().GetFieldData().GetArray("range_gate").GetInformation()
assert units.Get(vtk.vtkDataArray.UNITS_LABEL()) == "m"
