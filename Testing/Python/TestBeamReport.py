# SPDX-License-Identifier: BSD-3-Clause
"""The beam report keeps arrays from one execution to the next and writes what changed: it is the report of a filter
without a past, and what somebody holds of an earlier one stays as it was."""

import vtk
from vtk.util import numpy_support

from echotools import arrays, assert_same_bits, box, scan, sensor, town

blocks = town(count=20)
lidar = sensor()
# Refinement near the limit writes every report anew.
chain = scan(blocks, lidar, RefineNearLimit=False)
chain.Update()


def shown(report):
    """What does not tell the cost, which depends on what was known before."""
    values = arrays(report)
    return {name: values[name].tobytes() for name in ("beam_id", "status", "points")}


def check(what, held):
    """After an update, with the earlier outputs held by somebody or not."""
    kept = []
    for port in range(2):
        shallow, deep = vtk.vtkPolyData(), vtk.vtkPolyData()
        deep.DeepCopy(chain.GetOutput(port))
        if held:
            shallow.ShallowCopy(chain.GetOutput(port))
        kept.append((shallow, deep))
    chain.Update()
    for shallow, deep in kept:
        if held:
            assert_same_bits(shallow, deep)
    beams = vtk.vtkPolyData()
    beams.DeepCopy(lidar.GetOutput())
    fresh = scan(blocks, beams, RefineNearLimit=False)
    fresh.SetAttenuationCoefficient(chain.GetAttenuationCoefficient())
    fresh.SetSeed(chain.GetSeed())
    fresh.Update()
    assert_same_bits(chain.GetOutput(), fresh.GetOutput())
    assert shown(chain.GetOutput(1)) == shown(fresh.GetOutput(1)), (what, held)
    assert chain.GetOutput(1).GetNumberOfVerts() == fresh.GetOutput(1).GetNumberOfVerts()
    assert chain.GetOutput(1).GetPointData().GetScalars().GetName() == "status"
    assert chain.GetOutput(1).GetBounds() == fresh.GetOutput(1).GetBounds()
    return kept[1][1]


for held in (False, True):
    for attenuation in (1e-3, 8e-3, 3.5e-5):
        chain.SetAttenuationCoefficient(attenuation)
        check("attenuation", held)
    for limit in (2.1e-6, 2e-5, 1e-6):
        lidar.SetLowerEnergyLimit(limit)
        check("limit", held)
    lidar.SetUpperEnergyLimit(2.1e-5 if held else 2.6e-5)
    before = check("upper limit", held)
    assert shown(before) != shown(chain.GetOutput(1))  # some are saturated now
    lidar.SetDisplayLength(500.0 if held else 700.0)
    check("display length", held)
    lidar.SetPosition(1.0 if held else 2.0, 0.0, 0.0)
    check("position", held)
    chain.SetSeed(7 if held else 8)
    check("seed", held)

# What did not change is the same array, and what did says so.
report = chain.GetOutput(1)
ids = report.GetPointData().GetArray("beam_id")
status, ids_time = report.GetPointData().GetArray("status"), ids.GetMTime()
times = status.GetMTime(), report.GetPoints().GetData().GetMTime()
chain.SetAttenuationCoefficient(9e-3)
chain.Update()
report = chain.GetOutput(1)
assert report.GetPointData().GetArray("beam_id") is ids and ids.GetMTime() == ids_time
assert report.GetPointData().GetArray("status") is not status  # it was held here
assert report.GetPointData().GetArray("status").GetMTime() > times[0]
assert report.GetPoints().GetData().GetMTime() > times[1]
del report, ids, status


def kept():
    """The two arrays that a change of air is sure to change."""
    data = chain.GetOutput(1)
    return data.GetPointData().GetArray("status"), data.GetPoints().GetData()


def weak(data):
    reference = vtk.vtkWeakReference()
    reference.Set(data)
    return reference


def values(arrays_of_vtk):
    return [numpy_support.vtk_to_numpy(data).tobytes() for data in arrays_of_vtk]


def other_air(attenuation):
    """What the two arrays said before and when they were modified."""
    before = values(kept()), [data.GetMTime() for data in kept()]
    chain.SetAttenuationCoefficient(attenuation)
    chain.Update()
    for old, new in zip(before[0], values(kept())):
        assert old != new
    for old, data in zip(before[1], kept()):
        assert data.GetMTime() > old
    return before[0]


# Nobody holds them: they are written to.
unheld = [weak(data) for data in kept()]
other_air(1e-3)
for reference, data in zip(unheld, kept()):
    assert reference.Get() is data
del reference, data

# Somebody holds their values, though not the arrays.
sharing = [vtk.vtkIntArray(), vtk.vtkDoubleArray()]
for shallow, data in zip(sharing, kept()):
    shallow.ShallowCopy(data)
del data
before = other_air(9e-3)
assert values(sharing) == before
seen = [numpy_support.vtk_to_numpy(data) for data in kept()]
before = other_air(1e-3)
assert [view.tobytes() for view in seen] == before


def holders(**properties):
    """Who holds the report's array besides the output and this function."""
    sky = scan(box((500, 0, 0), (1, 1, 1), "Wall"), sensor(2500, 4), RefineNearLimit=False, **properties)
    sky.Update()
    sky.SetAttenuationCoefficient(1e-3)
    sky.Update()
    return sky.GetOutput(1).GetPointData().GetArray("status").GetReferenceCount() - 2


# Kept for the next execution only where that may go on from it, and where there is room: a MiB holds what the scan keeps
# of these beams, which meet next to nothing, or their report, but not both.
assert holders() == 1
assert holders(MaximumCacheSize=2) == 1
assert holders(MaximumCacheSize=1) == 0
assert holders(MaximumCacheSize=0) == 0
assert holders(TargetRelativeError=0.5) == 0
