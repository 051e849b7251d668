# SPDX-License-Identifier: BSD-3-Clause
"""Do settings hold on the whole scan that `Scan.advise` found on some of its beams? In each scene some sensors ask for
some errors; the whole scan is compared with a reference of its own, with other seeds than advice has, and so is the
next faster setting of advice's table. Leaves tables.

    AVIANLIDAR_SCENES_DIR=build/paraview/Testing/Scenes Testing/Studies/run.py advice
"""
import sys
import time

import numpy as np

import running
import tools
import trade_runs
from running import argument, built_scene, study
import avianlidar as al
from avianlidar.vtkAvianLidar import vtkAvianLidarEchoFilter as Filter

# The kinds of scenes of evidence/accuracy.md: title, file among those that the build makes; the first is shipped.
SCENES = (("footprints alone (Hongqiao)", None), ("towers (Shanghai)", "shanghai_cbd"),
          ("masts and jetways (Hongqiao)", "zsss_structures"), ("airport with terrain (Honolulu)", "phnl"),
          ("town and airport (Neubrandenburg)", "neubrandenburg"), ("houses in detail (Ingolstadt)", "ingolstadt"))
ASKED = {"energy": 0.02, "range": 0.05, "missed": 0.01}, {"energy": 0.05, "range": 0.2, "missed": 0.03}
SEEDS = 501, 502  # of scans that are judged
REFERENCE = 6400  # rays by cells, with eight connections
GHOST = 0.5  # share of the energy after two reflections, from which on an echo's energy is not judged
NAMES = {"beam_samples": "BeamSamples", "rays_per_beam": "RaysPerBeam", "sampling": "Sampling",
         "number_of_reflections": "NumberOfReflections", "number_of_connections": "NumberOfConnections"}


def setting_of(advice, row):
    return {NAMES[name]: int(advice.table[name][row]) for name in NAMES}


def next_faster(advice):
    """The slowest setting of the table that is faster than the one advised by a tenth or more; None if there is
    none."""
    times = advice.table["seconds_per_beam"]
    faster = [row for row in range(1, len(times)) if times[row] < 0.9 * times[advice.row]]
    return max(faster, key=lambda row: times[row]) if faster else None


def judge(reference, settings):
    """(the largest errors of the scans: energy, range, missed; s of one core, the median)."""
    runs = trade_runs.judged(reference, settings, SEEDS)
    found = [(trade_runs.rms(one["energy"]), trade_runs.rms(one["range"]), trade_runs.wrong(one)) for one, _ in runs]
    return tuple(np.nan_to_num(np.max(found, axis=0))), float(np.median([run.cpu for _, run in runs]))


def in_words(errors):
    energy, away, missed = errors
    return f"{100 * energy:.2g} %, {away:.2g} m, {100 * missed:.2g} %"


def holds(errors, asked):
    return all(error <= wanted for error, wanted in zip(errors, asked.values()))


def measure(title, file, sensor, beams):
    """Rows of the table, as cells."""
    subject, scan = trade_runs.subject_of(file, sensor), al.Scan(al.Scene(str(file)), sensor)
    reference = trade_runs.Reference(subject, REFERENCE, (2000003, 2000029), Filter.BEAM_SAMPLES_CELLS, 8)
    reference.strong &= reference.echoes["secondary_share"] <= GHOST
    rows = []
    for asked in ASKED:
        before = time.process_time()
        advice = scan.advise(**asked, beams=beams)
        took = time.process_time() - before
        start = [title, sensor, in_words(tuple(asked.values()))]
        if advice.row < 0:
            rows.append([*start, "none", "-", "-", "-", "-", f"{took:.0f}"])
        else:
            errors, cpu = judge(reference, setting_of(advice, advice.row))
            faster = next_faster(advice)
            other = judge(reference, setting_of(advice, faster))[0] if faster is not None else None
            default = judge(reference, {})[1]
            rows.append([*start, advice.words(advice.row), in_words(errors), "yes" if holds(errors, asked) else "no",
                         "-" if other is None else f"{in_words(other)}: {'holds' if holds(other, asked) else 'fails'}",
                         f"{default / cpu:.2g}", f"{took:.0f}"])
        print(*rows[-1], sep=" | ", file=sys.stderr, flush=True)
    return rows


@study(argument("--sensors", nargs="+", choices=al.Sensor.presets(), default=["Airport16"], help="default Airport16"),
       argument("--beams", type=running.whole(50, 1000000), default=1000, help="that advice measures on, default 1000"))
def main(options):
    files = [(title, built_scene(name) if name else running.AIRPORT) for title, name in SCENES]
    rows = [row for sensor in options.sensors for title, file in files if file
            for row in measure(title, file, sensor, options.beams)]
    tools.leave(options.out, "table", ("scene", "sensor", "asked: energy, range, wrong echoes", "advised",
                                       "on the whole scan", "holds", "the next faster one",
                                       "times as fast as the default", "s to measure"), rows, 7)
    advised = [row for row in rows if row[3] != "none"]
    faster = [row[6] for row in advised if row[6] != "-"]
    hold, fail = sum(row[5] == "yes" for row in advised), sum("fails" in text for text in faster)
    print(f"Advised in {len(advised)} of {len(rows)} cases. On the whole scan the settings hold in {hold} of these; "
          f"the next faster setting fails in {fail} of {len(faster)}.")
    return rows
