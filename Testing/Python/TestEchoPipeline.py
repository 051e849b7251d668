# SPDX-License-Identifier: BSD-3-Clause
"""The echo filter in a pipeline: the same bits however it is run, tracing only what is new, progress and abort."""

import numpy as np
import vtk

from avianlidar import vtkAvianLidar as al
from echotools import RAYS, array, arrays, assert_same_bits, box, scan, sensor, town

blocks = town()
source = sensor()
source.Update()
beams = source.GetOutput()
order = np.random.default_rng(0).permutation(beams.GetNumberOfPoints())
shuffled = vtk.vtkPolyData()
points = vtk.vtkPoints()
points.SetDataTypeToDouble()
shuffled.SetPoints(points)
shuffled.GetPointData().CopyAllocate(beams.GetPointData())
for new, old in enumerate(order):
    points.InsertNextPoint(beams.GetPoint(int(old)))
    shuffled.GetPointData().CopyData(beams.GetPointData(), int(old), new)
shuffled.GetFieldData().PassData(beams.GetFieldData())

# By default all beams of this town are integrated, and none needs a ray: what is about rays traces them. With 3 rays
# only those are integrated that at most 3 triangles enter; the others have cells.
SAMPLED = {"BeamSamples": RAYS}
MIXED = {"RaysPerBeam": 3}


def rays_of(scanned):
    return array(scanned.GetOutput(1), "rays_traced")


for properties in (MIXED, SAMPLED, {}):  # the last stays
    reference = scan(blocks, NumberOfThreads=1, **properties)
    reference.Update()
    echoes = reference.GetOutput()
    assert echoes.GetNumberOfPoints() > 50
    assert echoes.GetNumberOfVerts() == echoes.GetNumberOfPoints()
    assert echoes.GetPoints().GetDataType() == vtk.VTK_DOUBLE
    with_echo = np.isin(array(reference.GetOutput(1), "beam_id"), array(echoes, "beam_id"))
    integrated = np.mean(rays_of(reference)[with_echo] == 0)
    assert integrated == 1 if not properties else integrated == 0 if properties is SAMPLED else 0.1 < integrated < 0.9

    # Threads.
    for threads in (0, 2, 3):
        other = scan(blocks, NumberOfThreads=threads, **properties)
        other.Update()
        assert_same_bits(echoes, other.GetOutput())

    # Pieces: each by itself, then appended.
    for pieces in (2, 3, 5):
        append = vtk.vtkAppendPolyData()
        count = 0
        for piece in range(pieces):
            part = scan(blocks, **properties)
            part.UpdatePiece(piece, pieces, 0)
            copy = vtk.vtkPolyData()
            copy.DeepCopy(part.GetOutput())
            append.AddInputData(copy)
            count += part.GetOutput(1).GetNumberOfPoints()
        append.Update()
        assert count == reference.GetOutput(1).GetNumberOfPoints()
        assert_same_bits(echoes, append.GetOutput())

    # Beams in another order.
    other = scan(blocks, shuffled, **properties)
    other.Update()
    assert_same_bits(echoes, other.GetOutput())

    # A tree that comes with the surfaces, of any kind, is used and changes nothing.
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(blocks)
    for rule in range(4):
        for volume in range(3):
            tree.SetSplitRule(rule)
            tree.SetBoundingVolume(volume)
            other = scan(tree, **properties)
            other.Update()
            assert other.GetNumberOfTreeBuilds() == 0
            assert_same_bits(echoes, other.GetOutput())
            # Zero copies through a deep copy within one process.
            copy = vtk.vtkPolyData()
            copy.DeepCopy(tree.GetOutput())
            other = scan(copy, **properties)
            other.Update()
            assert other.GetNumberOfTreeBuilds() == 0
    assert reference.GetNumberOfTreeBuilds() == 1

    # Accelerations change costs, not echoes.
    for beam_constraint in (True, False):
        for batch in range(3):  # rays, groups, beams
            other = scan(blocks, BeamConstraint=beam_constraint, BatchCollisionDetection=batch, **properties)
            other.Update()
            assert_same_bits(echoes, other.GetOutput())

# Printed, numbers have all their digits.
printed = al.vtkAvianLidarEchoFilter()
printed.SetRaysPerBeam(1000000)
printed.SetSeed(-123456789)
for line in ("RaysPerBeam: 1000000", "Seed: -123456789", "AttenuationCoefficient: 3.5e-05 1/m", "MaximumCacheSize: 1024 MiB"):
    assert line in str(printed), line

# Trace once, light many times: a changed property gives what a fresh filter gives, without tracing.
changes = [
    ("AttenuationCoefficient", 1e-3),
    ("ReturnMode", al.vtkAvianLidarEchoFilter.RETURN_MODE_STRONGEST),
    ("Noise", False),
    ("ReturnMode", al.vtkAvianLidarEchoFilter.RETURN_MODE_RANGE_UNITS),
]


def light_again(has_rays, **properties):
    known = scan(blocks, **properties)
    known.Update()
    for name, value in changes:
        properties[name] = value
        getattr(known, "Set" + name)(value)
        known.Update()
        fresh = scan(blocks, **properties)
        fresh.Update()
        assert (fresh.GetNumberOfTracedRays() > 0) == has_rays
        assert known.GetNumberOfTracedRays() == 0, (name, known.GetNumberOfTracedRays())
        assert_same_bits(known.GetOutput(), fresh.GetOutput())
    return known


light_again(False)  # integrated beams never have a ray
light_again(True, **MIXED)
known = light_again(True, **SAMPLED)
known.SetSeed(3)
known.Update()
assert known.GetNumberOfTracedRays() > 0

# Materials and limits come from upstream: they light again, too.
wall = al.vtkAvianLidarMaterial()
wall.SetInputData(box((100, 0, 0), (1, 20, 20)))
lidar = sensor()
lidar.SetElevationStep(0.1)
chain = scan(wall, lidar, **SAMPLED)
chain.Update()
assert chain.GetNumberOfTracedRays() > 0
before = array(chain.GetOutput(), "energy_received").copy()
wall.SetMaterialToMetal()
chain.Update()
assert chain.GetNumberOfTracedRays() == 0
assert not np.array_equal(before, array(chain.GetOutput(), "energy_received"))
lidar.SetPulseEnergy(7.2e-4)
chain.Update()
assert chain.GetNumberOfTracedRays() == 0

# A block that gets another name gives it to its echoes, though no data was modified.
named = scan(town(count=4))
named.Update()
houses = named.GetInputDataObject(1, 0)
houses.GetMetaData(2).Set(vtk.vtkCompositeDataSet.NAME(), "barn")
named.SetAttenuationCoefficient(4e-5)
named.Update()
assert named.GetOutput().GetFieldData().GetAbstractArray("object_names").GetValue(2) == "barn"

# A cache of no size changes nothing but the work.
uncached = scan(blocks, MaximumCacheSize=0, **SAMPLED)
uncached.Update()
uncached.SetAttenuationCoefficient(1e-3)
uncached.Update()
assert uncached.GetNumberOfTracedRays() > 0
fresh = scan(blocks, AttenuationCoefficient=1e-3, **SAMPLED)
fresh.Update()
assert_same_bits(uncached.GetOutput(), fresh.GetOutput())

# Progress rises from the calling thread; abort within blocks, with empty and valid outputs. Rays take long enough for that.
busy = scan(blocks, sensor(720, 8), NumberOfThreads=1, **SAMPLED)
seen = []
busy.AddObserver("ProgressEvent", lambda *_: seen.append(busy.GetProgress()))
busy.Update()
assert len(seen) >= 100, len(seen)  # every few thousand rays with hits
assert all(a <= b for a, b in zip(seen, seen[1:])) and seen[-1] == 1.0

busy.SetNumberOfThreads(2)
calls = []


def stop(*_):
    calls.append(1)
    if len(calls) == 10:
        busy.AbortExecuteOn()


busy.RemoveAllObservers()
busy.AddObserver("ProgressEvent", stop)
busy.SetSeed(1)
busy.Update()
assert 10 <= len(calls) <= 12, len(calls)  # no block begins after the wish to stop
assert busy.GetOutput().GetNumberOfPoints() == 0 and busy.GetOutput(1).GetNumberOfPoints() == 0
busy.RemoveAllObservers()
busy.AbortExecuteOff()
busy.SetSeed(0)
busy.Modified()
busy.Update()
assert busy.GetNumberOfTracedRays() > 0  # an aborted run leaves no cache
again = scan(blocks, sensor(720, 8), **SAMPLED)
again.Update()
assert_same_bits(busy.GetOutput(), again.GetOutput())

# Arrays carry their units, all of them, and the beams' arrays arrive with the echoes.
data = arrays(echoes)
units = {
    "J": "energy energy_received return_energy energy_std_error",
    "m": "distance_m",
    "1": "intensity return_number number_of_returns label_share secondary_share",
    "0.01 deg": "azimuth",
    "deg": "vertical_angle incidence_angle",
    "us": "timestamp",
    "": "beam_id laser_id object_id material_id",
}
report_units = {
    "J": "skipped_bound",
    "0.01 deg": "azimuth",
    "deg": "vertical_angle",
    "1": "candidates nodes_visited rays_traced",
    "": "beam_id laser_id status skipped",
}
field_units = {
    "m": "position display_length range_gate perceivable_range range_noise range_noise_floor range_walk range_quantum minimum_range overlap_range defocus_range",
    "deg": "beam_rotation sun_azimuth sun_elevation orientation minimum_elevation elevation_step azimuth_range azimuth_step",
    "rad": "half_beamwidth half_beamwidth_across",
    "Hz": "rotation_rate frequency noise_photon_rate",
    "s": "firing_interval pulse_width sampling_interval",
    "J": "pulse_energy lower_energy_limit upper_energy_limit noise_bound light_energy_constraint_bound further_reflections_bound "
         "skipped_energy_bound missed_detail_energy",
    "m2": "receiver_aperture",
    "nm": "wavelength filter_bandwidth",
    "W/(m2 sr nm)": "background_radiance",
    "W/(m2 nm)": "sunlight",
    "mm/h": "rain_rate",
    "dB": "dynamic_range",
    "1/m": "attenuation_coefficient",
}


def units_of(data):
    """{name: unit} of point or field data; the unit of an array without one is empty."""
    found = {}
    for i in range(data.GetNumberOfArrays()):
        information = data.GetAbstractArray(i).GetInformation()
        key = vtk.vtkDataArray.UNITS_LABEL()
        found[data.GetArrayName(i)] = information.Get(key) if information.Has(key) else ""
    return found


def by_name(table):
    return {name: unit for unit, names in table.items() for name in names.split()}


assert units_of(echoes.GetPointData()) == by_name(units), units_of(echoes.GetPointData())
assert units_of(reference.GetOutput(1).GetPointData()) == by_name(report_units)
for port in (0, 1):
    found = units_of(reference.GetOutput(port).GetFieldData())
    assert {name: unit for name, unit in found.items() if unit not in ("", "1")} == by_name(field_units), found
assert np.all(data["energy"] <= 6.25e-5) and np.all(data["energy"] > 2e-6)
assert np.all((data["intensity"] >= 0) & (data["intensity"] <= 255))
assert np.all(data["label_share"] > 0) and np.all(data["label_share"] <= 1)
assert np.allclose(np.linalg.norm(data["points"], axis=1), data["distance_m"], rtol=1e-12)
azimuth = np.degrees(np.arctan2(data["points"][:, 0], data["points"][:, 1])) % 360
assert np.allclose(azimuth * 100, data["azimuth"], atol=1e-6)
names = echoes.GetFieldData().GetAbstractArray("object_names")
assert names.GetValue(int(data["object_id"][0])).startswith("house ")

# The report has one vertex per beam.
report = fresh.GetOutput(1)
assert report.GetNumberOfPoints() == 360
status = array(report, "status")
assert set(np.unique(status)) <= {0, 1, 2, 3, 4}
# With Rays each beam has its rays, whether it meets anything or not; by default, none has any.
assert np.all(rays_of(fresh) >= 100) and np.any(status == 1)
assert np.all(rays_of(reference) == 0)
