#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How many echoes does a setting invent or miss, and what does it cost? Prints a table: for each scene and setting the
share of the true echoes that were missed or invented, and the processor time as a multiple of what the default takes.

    /usr/bin/python3 Examples/accuracy_speed/detection.py airport field my.lidarscene.json
    /usr/bin/python3 Examples/accuracy_speed/detection.py airport:airport32 --seeds 5

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`)."""
import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "common"), str(HERE)]
import running  # noqa: E402
import trade_runs  # noqa: E402
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter  # noqa: E402

SETTINGS = {"default": {}, "`Rays`": {"BeamSamples": Filter.BEAM_SAMPLES_RAYS},
            "`Draft`": {"Preset": Filter.PRESET_DRAFT}, "`Standard`": {"Preset": Filter.PRESET_STANDARD}}


def measure(name, sensor, options):
    """{setting: (missed or invented as a share, s of one core)}, and the number of true echoes."""
    subject = trade_runs.Subject(name, sensor)
    reference = trade_runs.Reference(subject, options.reference_rays)
    found = {setting: [] for setting in SETTINGS}
    for seed in range(options.seeds):  # settings take turns
        for setting, values in SETTINGS.items():
            scan = trade_runs.scan(subject, values, seed)
            judged = trade_runs.judge(reference, scan)
            found[setting].append((judged["missed"], judged["false"], scan.cpu))
    true = len(reference.echoes["beam_id"])
    return subject.title, true, len(reference.undecided["beam_id"]), {
        setting: (100 * np.mean([m for m, *_ in rows]) / true, 100 * np.mean([f for _, f, _ in rows]) / true,
                  min(cpu for *_, cpu in rows)) for setting, rows in found.items()}


def table(measured):
    lines = ["| scene, sensor | true echoes | " + " | ".join(SETTINGS) + " |", "|---|---:|" + "---:|" * len(SETTINGS)]
    for title, true, undecided, found in measured:
        usual = found["default"][2]
        cells = [f"{missed + false:.1f} % ({missed:.1f} + {false:.1f}), {cpu / usual:.2f}"
                 for missed, false, cpu in found.values()]
        lines.append(f"| {title} | {true} (± {undecided}) | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    trade_runs.add_scenes(parser)
    parser.add_argument("--seeds", type=running.whole(1, 100), default=5, help="scans with each setting, default 5")
    parser.add_argument("--reference-rays", type=running.whole(1000, 1000000), default=10000, help="default 10000")
    options = parser.parse_args(argv)
    return trade_runs.measure_scenes(options, measure, table)


if __name__ == "__main__":
    main()
