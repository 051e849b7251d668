# SPDX-License-Identifier: BSD-3-Clause
"""The beam report of a scan lit again is that of a filter without a past, and what somebody holds of an earlier one
stays as it was."""

import vtk

from echotools import arrays, assert_same_bits, scan, sensor, town

blocks = town(count=20)
lidar = sensor()
chain = scan(blocks, lidar)
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
    fresh = scan(blocks, beams)
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
