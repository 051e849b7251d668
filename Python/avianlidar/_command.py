# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar`, also `python3 -m avianlidar`."""
from __future__ import annotations

import argparse
import os
import pathlib
import sys
import time
import traceback
import warnings
from typing import Any, Dict, List, Optional

EXAMPLES = """examples:
  avianlidar scan airport.lidarscene.json --sensor Search905 --position 0 0 3 -o echoes.las
  avianlidar sequence hongqiao.scenario.json -o sequences --scans 100
  avianlidar coverage hongqiao.coverage.json -o maps --coverage-set species=crow
  avianlidar siting hongqiao.coverage.json -o sites --siting-set spacing=100
  avianlidar report hongqiao.coverage.json -o report.html
  avianlidar sequence hongqiao.scenario.json -o still --sensor-set sway_amplitude=0 --sensor-set encoder_jitter=0
"""


class Parser(argparse.ArgumentParser):
    """A bad argument ends with one line and the exit code 2."""

    def error(self, message: str):
        self.exit(2, f"{self.prog}: {message} (--help says more)\n")


def _value(text: str) -> Any:
    """`name=value` as it is meant: numbers, tables of them by commas, switches, words."""
    def one(word):
        try:
            return int(word)
        except ValueError:
            pass
        try:
            return float(word)
        except ValueError:
            return {"on": True, "off": False}.get(word.lower(), word)
    name, equals, value = text.partition("=")
    if not equals or not name:
        raise argparse.ArgumentTypeError(f"expected name=value, not '{text}'")
    parts = [one(word) for word in value.split(",")]
    return name, parts[0] if len(parts) == 1 else tuple(parts)


class Bar:
    """How far the work is: a line that is written over on a terminal, else one at each tenth of it."""

    def __init__(self, what: str, total: int, before: int = 0):
        self.what, self.total, self.before, self.began, self.last = what, total, before, time.monotonic(), 0
        self.terminal = sys.stderr.isatty()

    def __call__(self, done: int) -> None:
        tenth = 10 * done // max(self.total, 1)
        if not self.terminal and tenth == self.last:
            return
        self.last = tenth
        text, passed = f"{self.what}: {done}/{self.total}", time.monotonic() - self.began
        if passed > 1.0 and done > self.before:
            rate = (done - self.before) / passed
            left = int((self.total - done) / rate)
            text += f", {rate:.1f}/s, {left // 60}:{left % 60:02d} left"
        print(f"\r{text}\033[K" if self.terminal else text, end="" if self.terminal else "\n", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self.terminal:
            print(file=sys.stderr)


def _scan(options) -> None:
    from . import Scan, Sensor, load_scene, save
    scene = load_scene(options.scene)
    place = options.position or scene.lidar_position or (0, 0, 0)
    sensor = Sensor(options.sensor, position=place, **dict(options.sensor_set))
    bar = Bar("scan", 100)
    scan = Scan(scene, sensor, number_of_threads=options.threads,
                progress=(lambda share, _: bar(int(100 * share))) if bar.terminal else None, **dict(options.scan_set))
    echoes = scan.echoes
    bar.close()
    save(echoes, options.out)
    print(f"{options.out}: {echoes.number_of_points} echoes of {sensor.beams.number_of_points} beams")


def _sequence(options) -> None:
    from . import Sequence
    from ._ranks import Ranks
    from ._sequence import read_scenario
    ranks = Ranks()
    scenario = read_scenario(options.scenario)
    changes: Dict[str, Any] = {} if options.scans is None else {"number_of_scans": options.scans}
    for part, values in (("sensor", options.sensor_set), ("scan", options.scan_set)):
        if values:
            changes[part] = {**scenario.get(part, {}), **dict(values)}
    sequence = Sequence(scenario, threads=options.threads or (1 if ranks.size > 1 else 0), **changes)
    bar: Optional[Bar] = None
    finished = 0

    def progress(number: int, done: int, all_of_them: int) -> None:
        nonlocal bar, finished
        if ranks.rank:
            return
        if bar is None:
            bar = Bar("scans" if ranks.size == 1 else "scans of the first rank", 0)
            bar.total = sequence.scans_to_do(options.out, ranks)
        finished += 1
        bar(finished)
    manifest = sequence.write(options.out, ranks, progress)
    if bar:
        bar.close()
    if ranks.rank == 0:
        parts = manifest["sequences"].values()
        print(f"{options.out}: {sum(p['scans'] for p in parts)} scans in {len(parts)} sequences, birds seen in "
              f"{sum(p['scans_with_birds_seen'] for p in parts)} of them; datasheet.md says more")


def _plan(options) -> Dict[str, Any]:
    """The plan with what options change."""
    from ._maps import read_plan
    return read_plan(options.plan, **{part: dict(getattr(options, f"{part}_set", ())) for part in ("sensor", "coverage", "siting")})


def _say_ground(plan) -> None:
    if plan.above != "ground":
        below = "no surface is below the sensor" if plan.ground is None else f"the ground below the sensor is at z = {plan.ground:.4g} m"
        print(f"avianlidar: warning: heights are above the scene's origin, and {below}", file=sys.stderr)


class Bars:
    """A bar for each work that is named."""

    def __init__(self) -> None:
        self.bar: Optional[Bar] = None

    def __call__(self, what: str, done: int, total: int) -> None:
        if self.bar is None or self.bar.what != what:
            self.close()
            self.bar = Bar(what, total)
        self.bar(done)

    def close(self) -> None:
        if self.bar:
            self.bar.close()


def _coverage(options) -> None:
    from ._maps import Plan
    options.out.mkdir(parents=True, exist_ok=True)
    plans = Plan.all_of(_plan(options), options.threads)
    _say_ground(plans[0])
    for plan in plans:
        bars = Bars()
        folder = options.out / plan.name if len(plans) > 1 else options.out
        names = plan.write(folder, lambda done, total, name=plan.name, bars=bars: bars(f"files of {name}", done, total))
        bars.close()
        row = plan.overall
        print(f"{folder}: {len(names)} files; {plan.coverage.species or 'the target'} detected in one scan: "
              f"{row['detection_probability']:.3f} +- {row['detection_std_error']:.3f} {plan.where} (assumed: bird"
              f"{', receiver' if plan.assumed else ''})")


def _siting(options) -> None:
    from . import _pictures  # needs Matplotlib: said before the work
    from ._maps import Plan
    from ._ranks import Ranks
    from ._sites import Sites
    _pictures.gradient()
    options.out.mkdir(parents=True, exist_ok=True)
    ranks, bars = Ranks(), Bars()
    plan = Plan(_plan(options), 1)
    if not ranks.rank:
        _say_ground(plan)
    sites = Sites(plan, options.out / "coverage", ranks, bars)
    changes = list(sites.changes())
    bars.close()
    if ranks.rank:
        return
    sites.write(options.out, changes)
    for network in sites.networks:
        where = ", ".join(f"({x:g}, {y:g}, {z:g})" for x, y, z in sites.positions[list(network.sites)])
        print(f"{len(network.sites)} of {plan.name}: {network.value:.3f} at {where} m")
    for row in sites.robustness(changes):
        print(f"{row['change']}, {row['sensors']} sensor(s): another winner in {row['another winner']} of {row['draws']} draws, better by at most "
              f"{100 * row['gain at most']:.1f} %")


def _report(options) -> None:
    from ._report import Report
    bars = Bars()
    report = Report(_plan(options), options.threads, bars)
    _say_ground(report.plans[0])
    folder = report.write(options.out)
    bars.close()
    print(f"{options.out}: the report; {folder}: its tables and pictures")


def parser() -> Parser:
    """The command's arguments."""
    whole = Parser(prog="avianlidar", description="Simulates what a bird-watching lidar receives.", epilog=EXAMPLES,
                   formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = whole.add_subparsers(dest="verb", required=True, metavar="verb", parser_class=Parser)
    scan = verbs.add_parser("scan", help="one scan of a scene", description="One scan of a scene, written as a file.")
    scan.add_argument("scene", help="a .lidarscene.json file")
    scan.add_argument("--sensor", default="Airport16", help="a preset, or a .lidarsensor.json file; default Airport16")
    scan.add_argument("--position", nargs=3, type=float, metavar=("X", "Y", "Z"),
                      help="of the sensor, m; default: where the scene says")
    scan.set_defaults(run=_scan)
    sequence = verbs.add_parser("sequence", help="labelled scans of birds, to train on",
                                description="Labelled scans of a scenario in the layout of SemanticKITTI. Started again it "
                                "goes on where it was; `mpiexec -n 2 pvbatch --sym -m avianlidar` shares the work.")
    sequence.add_argument("scenario", help="a scenario file, or the manifest.json of another sequence")
    sequence.add_argument("--scans", type=int, help="number of scans, instead of the scenario's")
    sequence.set_defaults(run=_sequence)
    coverage = verbs.add_parser("coverage", help="maps of where a bird would be detected",
                                description="Maps of where a bird would be detected, and why not elsewhere (GeoTIFF, GeoJSON), shares "
                                "(CSV) and clutter (VTP), by a plan: a folder for each sensor if the plan compares some.")
    coverage.set_defaults(run=_coverage)
    siting = verbs.add_parser("siting", help="where lidars should stand",
                              description="Candidates by rank (CSV, GeoJSON, VTP), the best networks and what changes them, by a plan. "
                              "Started again it goes on where it was; `mpiexec -n 2 pvbatch --sym -m avianlidar` shares the work.")
    siting.set_defaults(run=_siting)
    report = verbs.add_parser("report", help="maps, sections, shares and sites as one page of HTML",
                              description="One page of HTML that needs no network, by a plan; tables and pictures are in a folder beside it.")
    report.set_defaults(run=_report)
    for verb in (coverage, siting, report):
        verb.add_argument("plan", help="a .coverage.json file")
        verb.add_argument("--coverage-set", action="append", default=[], type=_value, metavar="NAME=VALUE",
                          help="a property of the coverage, for example species=crow")
        if verb is not coverage:
            verb.add_argument("--siting-set", action="append", default=[], type=_value, metavar="NAME=VALUE",
                              help="a part of the plan's siting, for example spacing=100; files are named from the plan's folder")
    for verb, what in ((scan, "file: .las, .pcd, .bin, .geojson, .vtp or .csv"), (sequence, "folder"),
                       (coverage, "folder"), (siting, "folder"), (report, "file: .html")):
        verb.add_argument("-o", "--out", required=True, type=pathlib.Path, help=what)
        verb.add_argument("--sensor-set", action="append", default=[], type=_value, metavar="NAME=VALUE",
                          help="a property of the sensor; may be given many times")
        if verb in (scan, sequence):
            verb.add_argument("--scan-set", action="append", default=[], type=_value, metavar="NAME=VALUE",
                              help="a property of the scan, for example rays_per_beam=400")
        if verb is not siting:  # one thread a site; ranks share them
            verb.add_argument("--threads", type=int, default=0, help="default 0: as many as there are cores")
    return whole


def main(argv: Optional[List[str]] = None) -> int:
    """Run the command. @return 0; 2 after an error, which is said in one line"""
    options = parser().parse_args(argv)
    warnings.showwarning = lambda message, *_, **__: print(f"avianlidar: warning: {message}", file=sys.stderr)
    code = 2
    try:
        options.run(options)
        code = 0
    except KeyboardInterrupt:
        print("avianlidar: stopped", file=sys.stderr)
        code = 130
    except ImportError as error:
        print(f"avianlidar: {error}; this verb needs the Python module", file=sys.stderr)
    except (RuntimeError, OSError, ValueError, TypeError, LookupError) as error:
        words = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) and error.filename else str(error)
        print(f"avianlidar: {' '.join(words.split()) or type(error).__name__}", file=sys.stderr)
    finally:  # also after what is not expected, which is raised with its traceback
        sys.stdout.flush()
        if code and _is_parallel():
            if sys.exc_info()[0]:
                traceback.print_exc()
            sys.stderr.flush()
            os._exit(code)  # the other ranks must not wait for this one
    return code


def _is_parallel() -> bool:
    from ._ranks import Ranks
    return Ranks().size > 1
