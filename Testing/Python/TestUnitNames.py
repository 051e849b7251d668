# SPDX-License-Identifier: BSD-3-Clause
"""Tables keep units in the names of their columns. (TestHelperFiles writes CSV files, TestEchoFiles VTK's.)"""

import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from cloudtools import cloud, echoes, field, names, points, unit
from echotools import array

data = echoes()


def renamed(source):
    filter_ = al.vtkAvianLidarUnitNames()
    filter_.SetInputData(source)
    filter_.Update()
    return filter_.GetOutputDataObject(0)


# Names get their unit, values are shared, order and input stay.
table = renamed(data)
for before, after in zip(names(data), names(table), strict=True):
    its = unit(data, before)
    assert after == (f"{before} [{its}]" if its and its != "1" else before), after
    assert unit(table, after) == its
    assert np.shares_memory(array(table, after), array(data, before))
assert {"energy [J]", "azimuth [0.01 deg]", "intensity", "beam_id"} < set(names(table)) and "energy" in names(data)
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
