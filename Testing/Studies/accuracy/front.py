# SPDX-License-Identifier: BSD-3-Clause
"""What do polygons and cells buy, and do standard errors hold? Prints tables: for each scene and number of rays the rms error of
energy, the processor time and the share of the true echoes that is invented or missed, once with `BeamSamples` at `Rays` and
once at `Cells`; and how many true energies 1.96 standard errors hold.

    Testing/Studies/run.py front airport airport:airport32 field my.lidarscene.json"""
import numpy as np

from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import tools
import trade_runs
from running import argument, study, whole

RAYS = (32, 100, 400, 1000, 3000, 10000)


def measure(name, sensor, options):
    """The scene's title, the reference's own error, {(rays, samples): (rms error of energy, s of one core, share of
    the true echoes that is missed or invented, share of energies that are held)}. All else is the filter's defaults."""
    subject = trade_runs.Subject(name, sensor)
    reference = trade_runs.Reference(subject, options.reference_rays)
    settings = {(rays, samples): {"RaysPerBeam": rays, "BeamSamples": samples}
                for rays in options.rays for samples in (Filter.BEAM_SAMPLES_RAYS, Filter.BEAM_SAMPLES_CELLS)}
    return [(subject.title, reference.own["energy"], {
        setting: result(reference, values, options.seeds) for setting, values in settings.items()})]


def result(reference, values, seeds):
    runs = trade_runs.judged(reference, values, range(seeds))
    energy, wrong = trade_runs.energy_and_wrong(runs)
    return energy, min(run.cpu for _, run in runs), wrong, np.mean(np.concatenate([found["held"] for found, _ in runs]))


def errors(found):
    error, time, wrong, _ = found
    return f"{100 * error:.2g} %, {time:.3g} s, {100 * wrong:.2g} %"


def held(found):
    return f"{100 * found[3]:.1f} %"


@study(trade_runs.SCENES, argument("--seeds", type=whole(1, 100), default=3, help="scans with each setting, default 3"),
       argument("--rays", type=whole(1, 1000000), nargs="*", default=RAYS, help="rays of a beam"),
       argument("--reference-rays", type=whole(1000, 1000000), default=30000, help="default 30000"))
def main(options):
    measured = list(trade_runs.measured(options, measure))
    for name, words in (("rays", errors), ("standard-errors", held)):
        tools.leave(options.out, name, ("scene, sensor", "own error of the reference", *(f"{n:,} rays" for n in options.rays)), [
            (title, f"{100 * own:.2g} %", *(f"{words(found[n, Filter.BEAM_SAMPLES_RAYS])} → {words(found[n, Filter.BEAM_SAMPLES_CELLS])}"
                                            for n in options.rays)) for title, own, found in measured])
