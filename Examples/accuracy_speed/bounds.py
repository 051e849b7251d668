#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Do the bounds of integrated beams hold? Prints a table: for each scene the energies in range units of some integrated
beams against the mean of many scans that sample the same beams, direct echoes alone. The difference has to stay within
the stated bound (`energy_std_error`) and the standard error of that mean.

    /usr/bin/python3 Examples/accuracy_speed/bounds.py airport corridor my.lidarscene.json

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`)."""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "common"), str(HERE)]
import running  # noqa: E402
import trade_runs  # noqa: E402
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter  # noqa: E402

DIRECT = {"NumberOfReflections": 1, "Noise": False}


def scan(subject, beams, **settings):
    lidar = Filter()
    lidar.SetInputDataObject(0, beams)
    lidar.SetSurfacesConnection(subject.tree.GetOutputPort())
    lidar.SetAttenuationCoefficient(subject.attenuation)
    lidar.SetReturnMode(lidar.RETURN_MODE_RANGE_UNITS)
    for name, value in {**DIRECT, **settings}.items():
        getattr(lidar, "Set" + name)(value)
    running.update(lidar)
    return lidar


def column(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name)).copy()


def taken(beams, places):
    """A copy of the beams at these places."""
    old, new = vtkIdList(), vtkIdList()
    for k, place in enumerate(places):
        old.InsertNextId(int(place))
        new.InsertNextId(k)
    points = vtkPoints()
    points.SetDataType(beams.GetPoints().GetDataType())
    points.InsertPoints(new, old, beams.GetPoints())
    found = vtkPolyData()
    found.SetPoints(points)
    found.GetPointData().CopyAllOn()
    found.GetPointData().CopyAllocate(beams.GetPointData(), len(places))
    found.GetPointData().CopyData(beams.GetPointData(), old, new)
    found.GetFieldData().ShallowCopy(beams.GetFieldData())
    return found


def units(subject, lidar):
    """{(beam, range unit): (energy, its standard error or bound)}, J"""
    echoes = lidar.GetOutput()
    numbers = np.floor(column(echoes, "distance_m") / subject.unit).astype(int)
    return dict(zip(zip(column(echoes, "beam_id"), numbers),
                    zip(column(echoes, "energy_received"), column(echoes, "energy_std_error"))))


def measure(name, sensor, options):
    """The scene's title, {column of the table: its text}."""
    subject = trade_runs.Subject(name, sensor)
    beams = subject.sensor.GetOutput()
    # Over two reflections beams in cells trace rays; integrated ones do not, unless light may go on from their surfaces.
    report = scan(subject, beams, NumberOfReflections=2, NumberOfConnections=0).GetOutput(1)
    echoing = np.unique(column(scan(subject, beams).GetOutput(), "beam_id"))
    exact = np.intersect1d(echoing, column(report, "beam_id")[column(report, "rays_traced") == 0])
    drawn = np.random.default_rng(options.seed).permutation(exact)[:options.beams]
    some = taken(beams, np.flatnonzero(np.isin(column(beams, "beam_id"), drawn)))
    found = units(subject, scan(subject, some))
    means = [units(subject, scan(subject, some, BeamSamples=Filter.BEAM_SAMPLES_RAYS, RaysPerBeam=options.rays, Seed=seed))
             for seed in range(options.scans)]
    # Where some scans perceive nothing the mean of the others is too large.
    keys = [key for key in found if all(key in mean for mean in means)]
    true = np.array([[mean[key][0] for mean in means] for key in keys])
    energy, bound = np.array([found[key] for key in keys]).T
    error = true.std(1, ddof=1) / np.sqrt(options.scans)
    off = abs(energy - true.mean(1))
    return subject.title, {
        "integrated beams with an echo": f"{len(exact)} of {len(echoing)}",
        "compared": f"{len(drawn)}", "their range units": f"{len(keys)} of {len(found)}",
        "rms difference": f"{np.sqrt(np.mean((off / energy)**2)):.1e}",
        "rms standard error of the rays": f"{np.sqrt(np.mean((error / energy)**2)):.1e}",
        "bound: mean": f"{np.mean(bound / energy):.1e}", "largest": f"{np.max(bound / energy):.1e}",
        "most beyond the bound": f"{np.max(np.maximum(off - bound, 0) / error):.1f} standard errors"}


def table(measured):
    names = list(measured[0][1])
    return "\n".join(["| scene, sensor | " + " | ".join(names) + " |", "|---|" + "---:|" * len(names),
                      *("| " + " | ".join([title, *found.values()]) + " |" for title, found in measured)])


def main(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    trade_runs.add_scenes(parser)
    parser.add_argument("--beams", type=running.whole(1, 100000), default=50, help="beams of a scene, default 50")
    parser.add_argument("--scans", type=running.whole(3, 1000), default=20, help="scans by rays, default 20")
    parser.add_argument("--rays", type=running.whole(100, 1000000), default=100000, help="of each beam, default 100000")
    parser.add_argument("--seed", type=running.whole(0, 1000000), default=1, help="of the choice of beams, default 1")
    options = parser.parse_args(argv)
    return trade_runs.measure_scenes(options, measure, table)


if __name__ == "__main__":
    main()
