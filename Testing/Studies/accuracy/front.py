# SPDX-License-Identifier: BSD-3-Clause
"""What do polygons and cells buy, and do standard errors hold? Leaves tables: for each scene and number of rays the rms
error of energy, the processor time and the share of the true echoes that is invented or missed, with `BeamSamples` at
`Rays` and at `Cells`; and how many true energies 1.96 standard errors hold.

    Testing/Studies/run.py front airport airport:airport32 field my.lidarscene.json"""
import numpy as np

from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

import tools
import trade_runs
from running import argument, study, whole

RAYS = (32, 100, 400, 1000, 3000, 10000)
SAMPLES = {"Rays": Filter.BEAM_SAMPLES_RAYS, "Cells": Filter.BEAM_SAMPLES_CELLS}


def measure(name, sensor, options):
    """Rows: what both tables have. All other settings are the filter's defaults."""
    subject = trade_runs.subject_of(name, sensor)
    reference = trade_runs.Reference(subject, options.reference_rays)
    for rays in options.rays:
        for method, samples in SAMPLES.items():
            settings = {"RaysPerBeam": rays, "BeamSamples": samples}
            runs = trade_runs.judged(reference, settings, range(options.seeds))
            energy, wrong = trade_runs.energy_and_wrong(runs)
            held = np.mean(np.concatenate([found["held"] for found, _ in runs]))
            yield (subject.title, f"{100 * reference.own['energy']:.2g} %", rays, method, f"{100 * energy:.2g} %",
                   f"{min(run.cpu for _, run in runs):.3g}", f"{100 * wrong:.2g} %", f"{100 * held:.1f} %")


@study(trade_runs.SCENES, argument("--seeds", type=whole(1, 100), default=3, help="scans with each setting, default 3"),
       argument("--rays", type=whole(1, 1000000), nargs="*", default=RAYS, help="rays of a beam"),
       argument("--reference-rays", type=whole(1000, 1000000), default=30000, help="default 30000"))
def main(options):
    rows = list(trade_runs.measured(options, measure))
    of_rays, of_cells = ([row for row in rows if row[3] == method] for method in ("Rays", "Cells"))
    start = ("scene, sensor", "own error of the reference", "RaysPerBeam")
    tools.leave(options.out, "accuracy-cells-rays", (
        *start, "BeamSamples", "energy, rms", "s of one core", "echoes missed or invented"), [row[:-1] for row in rows])
    tools.leave(options.out, "standard-errors", (
        *start, "echoes within 1.96 standard errors, Rays", "echoes within 1.96 standard errors or the bound, Cells"), [
        (*one[:3], one[-1], other[-1]) for one, other in zip(of_rays, of_cells)])
