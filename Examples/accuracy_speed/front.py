#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What do polygons and cells buy, and do standard errors hold? Prints tables: for each scene and number of rays the rms error of
energy, the processor time and the share of the true echoes that is invented or missed, once with `BeamSamples` at `Rays` and
once at `Cells`; the same of the presets; and how many true energies 1.96 standard errors hold.

    /usr/bin/python3 Examples/accuracy_speed/front.py airport airport:airport32 field my.lidarscene.json

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`)."""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "common"), str(HERE)]
import running  # noqa: E402
import trade_grid  # noqa: E402
import trade_runs  # noqa: E402
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter  # noqa: E402

RAYS = (32, 100, 400, 1000, 3000, 10000)


def measure(name, sensor, options):
    """The scene's title, the reference's own error, {(rays, samples) or preset: (rms error of energy, s of one core, share of
    the true echoes that is missed or invented, share of energies that are held)}. All else is the filter's defaults."""
    subject = trade_runs.Subject(name, sensor)
    reference = trade_runs.Reference(subject, options.reference_rays)
    settings = {(rays, samples): {"RaysPerBeam": rays, "BeamSamples": samples}
                for rays in options.rays for samples in (Filter.BEAM_SAMPLES_RAYS, Filter.BEAM_SAMPLES_CELLS)}
    settings.update({name: {"Preset": getattr(Filter, value)} for name, value in trade_grid.PRESETS.items()})
    return subject.title, reference.own["energy"], {
        setting: result(reference, values, options.seeds) for setting, values in settings.items()}


def result(reference, values, seeds):
    runs = []
    for seed in range(seeds):
        scan = trade_runs.scan(reference.subject, values, seed)
        judged = trade_runs.judge(reference, scan)
        runs.append((judged["energy"], scan.cpu, (judged["missed"] + judged["false"]) / max(judged["true"], 1), judged["held"]))
    energies, times, wrong, held = zip(*runs)
    return trade_runs.rms(np.concatenate(energies)), min(times), float(np.mean(wrong)), float(np.mean(np.concatenate(held)))


def errors(found):
    error, time, wrong, _ = found
    return f"{100 * error:.2g} %, {time:.3g} s, {100 * wrong:.2g} %"


def held(found):
    return f"{100 * found[3]:.1f} %"


def table(measured):
    """Three tables in Markdown: numbers of rays, presets, standard errors."""
    numbers = sorted({setting[0] for _, _, found in measured for setting in found if isinstance(setting, tuple)})

    def by_rays(words):
        head = ["| scene, sensor | own error of the reference | " + " | ".join(f"{n:,} rays" for n in numbers) + " |",
                "|---|---:|" + "---|" * len(numbers)]
        return head + [f"| {title} | {100 * own:.2g} % | " + " | ".join(
            f"{words(found[n, Filter.BEAM_SAMPLES_RAYS])} → {words(found[n, Filter.BEAM_SAMPLES_CELLS])}" for n in numbers) + " |"
            for title, own, found in measured]

    presets = ["| scene, sensor | " + " | ".join(f"`{name}`" for name in trade_grid.PRESETS) + " |",
               "|---|" + "---|" * len(trade_grid.PRESETS),
               *(f"| {title} | " + " | ".join(errors(found[name]) for name in trade_grid.PRESETS) + " |"
                 for title, _, found in measured)]
    return "\n".join([*by_rays(errors), "", *presets, "", *by_rays(held)])


def main(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    trade_runs.add_scenes(parser)
    parser.add_argument("--seeds", type=running.whole(1, 100), default=3, help="scans with each setting, default 3")
    parser.add_argument("--rays", type=running.whole(1, 1000000), nargs="*", default=RAYS, help="rays of a beam")
    parser.add_argument("--reference-rays", type=running.whole(1000, 1000000), default=30000, help="default 30000")
    options = parser.parse_args(argv)
    return trade_runs.measure_scenes(options, measure, table)


if __name__ == "__main__":
    main()
