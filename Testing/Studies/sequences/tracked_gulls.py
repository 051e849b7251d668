# SPDX-License-Identifier: BSD-3-Clause
"""Gulls that Search905 scans in clear air without clutter: what the tracker makes of them, by its model of motion.

    Testing/Studies/run.py tracked_gulls --out build/tracked-gulls
"""
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkPlaneSource

import tools
from avianlidar import vtkAvianLidar as al
from running import set_all, study

SCANS, BIRDS, SEEDS, FIRST = 60, 30, (0, 1), 10000
PATTERNS = ("Crossings", "Circles")
MODELS = (
    ("constant velocity, `AccelerationDensity` 10 m²/s³", {"MotionModel": 0}),
    ("the same, 20 m²/s³", {"MotionModel": 0, "AccelerationDensity": 20}),
    ("turns, 5 m²/s³, `TurnRateDensity` 10 deg²/s³", {"AccelerationDensity": 5, "TurnRateDensity": 10}),
    ("**turns, 10 m²/s³, 40 deg²/s³ (default)**", {}),
    ("turns, 20 m²/s³, 100 deg²/s³", {"AccelerationDensity": 20, "TurnRateDensity": 100}),
    ("default, 2 of 3 scans confirm", {"ConfirmHits": 2, "ConfirmScans": 3}),
)


def scans_of(pattern, seed):
    """(clouds, ways of the birds) of 60 revolutions, gulls within 300 m; the only surface is a leaf far below."""
    sensor, birds, echo = al.vtkAvianLidarBeamSource(), al.vtkAvianLidarTracks(), al.vtkAvianLidarEchoFilter()
    sensor.SetPresetToSearch905()
    set_all(sensor, {"Position": (0, 0, 3), "NumberOfRevolutions": SCANS})
    getattr(birds, "SetPatternTo" + pattern)()
    set_all(birds, {"Species": "herring gull", "NumberOfBirds": BIRDS, "Seed": seed, "TimeRange": (0, 2 * SCANS), "Radius": 300,
                    "Heights": (15, 40)})
    plane, material = vtkPlaneSource(), al.vtkAvianLidarMaterial()
    set_all(plane, {"Origin": (-0.01, -0.01, -50), "Point1": (0.01, -0.01, -50), "Point2": (-0.01, 0.01, -50)})
    material.SetInputConnection(plane.GetOutputPort())
    material.SetMaterialToGrass()
    for port, algorithm in enumerate((sensor, material, birds)):
        echo.SetInputConnection(port, algorithm.GetOutputPort())
    echo.SetReportMovers(False)
    clouds = []
    for scan in range(SCANS):
        echo.UpdateTimeStep(2.0 * scan)
        clouds.append(echo.GetOutput(0).NewInstance())
        clouds[-1].DeepCopy(echo.GetOutput(0))
    return clouds, birds.GetOutputDataObject(1)


def place_of(ways, bird, time):
    """Where a bird is at a time, m."""
    cell = ways.GetCell(bird)
    ids = [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
    places, times = vtk_to_numpy(ways.GetPoints().GetData())[ids], vtk_to_numpy(ways.GetPointData().GetArray("time"))[ids]
    return np.array([np.interp(time, times, places[:, axis]) for axis in range(3)])


def squares(tracker, ways, objects, of_points):
    """Of each track of four positions or more: the square of its last position's error over its covariance."""
    tracks = tracker.GetOutput(0)
    arrays = [vtk_to_numpy(tracks.GetPointData().GetArray(name)) for name in ("time", "position_covariance")]
    ids = vtk_to_numpy(tracks.GetCellData().GetArray("track_id"))
    for number in range(tracks.GetNumberOfCells()):
        cell = tracks.GetCell(number)
        birds = objects[of_points == ids[number]]
        if cell.GetNumberOfPoints() < 4 or not len(birds) or birds[0] < FIRST:
            continue
        last = cell.GetPointId(cell.GetNumberOfPoints() - 1)
        time, (xx, yy, zz, xy, yz, xz) = (array[last] for array in arrays)
        error = np.array(tracks.GetPoint(last)) - place_of(ways, birds[0] - FIRST, time)
        yield error @ np.linalg.solve([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], error)


def follow(scans, settings):
    """Sightings of birds, those in a confirmed track, changes of track, confirmed tracks, those of several birds, and the squares."""
    seen = confirmed = changes = 0
    owners, found = {}, []
    for seed, (clouds, ways) in scans.items():
        tracker, last = set_all(al.vtkAvianLidarTracker(), settings), {}
        for cloud in clouds:
            tracker.SetInputData(cloud)
            tracker.Update()
            points = tracker.GetOutput(1)
            if points.GetNumberOfPoints() == 0:
                continue
            objects, of_points, sure = (vtk_to_numpy(points.GetPointData().GetArray(name)) for name in ("object_id", "track_id", "track_confirmed"))
            for bird in np.unique(objects[objects >= FIRST]):
                seen += 1
                tracks = of_points[(objects == bird) & (sure > 0)]
                if len(tracks):
                    confirmed += 1
                    changes += last.get(bird, tracks[0]) != tracks[0]
                    last[bird] = tracks[0]
                    owners.setdefault((seed, tracks[0]), set()).add(bird)
            found += squares(tracker, ways, objects, of_points)
    return confirmed / seen, changes, sum(len(birds) > 1 for birds in owners.values()), len(owners), float(np.mean(found))


@study()
def main(options):
    scans = {pattern: {seed: scans_of(pattern, seed) for seed in SEEDS} for pattern in PATTERNS}
    rows = []
    for words, settings in MODELS:
        rows.append([words])
        for pattern in PATTERNS:
            share, changes, mixed, tracks, square = follow(scans[pattern], settings)
            rows[-1] += [f"{share:.2f}", str(changes), f"{mixed} of {tracks}", f"{square:.2f}"]
    tools.leave(options.out, "tracks-gulls", ("", "straight: confirmed", "changes", "mixed", "error²", "circles: confirmed", "changes", "mixed",
                                              "error²"), rows)
