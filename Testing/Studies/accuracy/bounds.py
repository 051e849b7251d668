# SPDX-License-Identifier: BSD-3-Clause
"""Do the bounds of integrated beams hold? Prints a table: for each scene the energies in range units of some integrated
beams against the mean of many scans that sample the same beams, direct echoes alone. The difference has to stay within
the stated bound (`energy_std_error`) and the standard error of that mean.

    Testing/Studies/run.py bounds airport corridor my.lidarscene.json"""
import numpy as np

from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import tools
import trade_runs
from running import argument, column, rms, scanned, some_beams, study, whole


def scan(subject, beams, **settings):
    """Direct echoes alone, by range units."""
    return scanned(beams, subject.tree, **{"AttenuationCoefficient": subject.attenuation,
                                           "ReturnMode": Filter.RETURN_MODE_RANGE_UNITS, "NumberOfReflections": 1,
                                           "Noise": False, **settings})


def units(subject, lidar):
    """{(beam, range unit): (energy, its standard error or bound)}, J"""
    echoes = lidar.GetOutput()
    numbers = np.floor(column(echoes, "distance_m") / subject.unit).astype(int)
    return dict(zip(zip(column(echoes, "beam_id"), numbers),
                    zip(column(echoes, "energy_received"), column(echoes, "energy_std_error"))))


def measure(name, sensor, options):
    """A row of the table."""
    subject = trade_runs.subject_of(name, sensor)
    beams = subject.sensor.GetOutput()
    # Over two reflections beams in cells trace rays; integrated ones do not, unless light may go on from their
    # surfaces.
    report = scan(subject, beams, NumberOfReflections=2, NumberOfConnections=0).GetOutput(1)
    echoing = np.unique(column(scan(subject, beams).GetOutput(), "beam_id"))
    exact = np.intersect1d(echoing, column(report, "beam_id")[column(report, "rays_traced") == 0])
    drawn = np.random.default_rng(options.seed).permutation(exact)[:options.beams]
    some = some_beams(beams, np.flatnonzero(np.isin(column(beams, "beam_id"), drawn)))
    found = units(subject, scan(subject, some))
    means = [units(subject,
                   scan(subject, some, BeamSamples=Filter.BEAM_SAMPLES_RAYS, RaysPerBeam=options.rays, Seed=seed))
             for seed in range(options.scans)]
    # Where some scans perceive nothing the mean of the others is too large.
    keys = [key for key in found if all(key in mean for mean in means)]
    true = np.array([[mean[key][0] for mean in means] for key in keys])
    energy, bound = np.array([found[key] for key in keys]).T
    error = true.std(1, ddof=1) / np.sqrt(options.scans)
    off = abs(energy - true.mean(1))
    return [(subject.title, f"{len(exact)} of {len(echoing)}", len(drawn), f"{len(keys)} of {len(found)}",
             f"{rms(off / energy):.1e}", f"{rms(error / energy):.1e}", f"{np.mean(bound / energy):.1e}",
             f"{np.max(bound / energy):.1e}", f"{np.max(np.maximum(off - bound, 0) / error):.1f} standard errors")]


@study(trade_runs.SCENES, argument("--beams", type=whole(1, 100000), default=50, help="beams of a scene, default 50"),
       argument("--scans", type=whole(3, 1000), default=20, help="scans by rays, default 20"),
       argument("--rays", type=whole(100, 1000000), default=100000, help="of each beam, default 100000"),
       argument("--seed", type=whole(0, 1000000), default=1, help="of the choice of beams, default 1"))
def main(options):
    tools.leave(options.out, "polygons-bounds", ("scene, sensor", "integrated beams with an echo", "compared",
                                                 "their range units", "rms difference",
                                                 "rms standard error of the rays", "bound: mean", "largest",
                                                 "most beyond the bound"),
                list(trade_runs.measured(options, measure)))
