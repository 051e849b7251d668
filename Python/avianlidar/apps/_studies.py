# SPDX-License-Identifier: BSD-3-Clause
"""The functions of the command's verbs that make airports, sequences and studies."""
from __future__ import annotations

import contextlib
import functools
import itertools
import pathlib
from typing import Any, Dict, Iterator, List, Tuple

from .. import reach as ranges
from .._disk import only_run
from .._files import checked_name
from .._properties import PATTERN, in_snake_case, snake
from .._ranks import Ranks
from .._recording import load_clouds
from .._sensor import Sensor
from .._terminal import bar, close_bar, in_time, table, tell, warn
from .._weather import without_air
from .coverage import _sites_page
from .coverage._answer import percent, share_of
from .coverage._design_page import Designs, answers
from .coverage._flown import write_flown
from .coverage._maps import write_maps
from .coverage._passed import write_passed
from .coverage._plan import Plan
from .coverage._report import Report
from .coverage._sites import Sites
from .inputs._on_sale import PLACE, farthest, idea
from .inputs._read import PROPERTIES, read_plan, read_scenario
from .inputs._tables import write_table
from .pages import _drawing as drawing
from .pages._words import counted
from .sequences._recorded import RecordedTracks
from .sequences._sequence import Sequence
from .sequences._tracks import BirdTracks
from .sequences._trajectory import settings_of
from .view import _view


@contextlib.contextmanager
def _goes_on(folder: pathlib.Path, pattern: str, what: str) -> Iterator[None]:
    """Adds to Ctrl-C's message the results that a further run can use. @param what name of the files of the pattern"""
    try:
        yield
    except KeyboardInterrupt:
        count = len(list(folder.glob(pattern)))
        if count:
            raise KeyboardInterrupt(f"{folder}: {what}: {count}; the same command continues") from None
        raise KeyboardInterrupt from None


def _job(options, draws: bool = True) -> Tuple[Ranks, int]:
    """The ranks of a job, and the threads of each; ImportError if a job that draws has no Matplotlib."""
    if draws:
        drawing.require()
    ranks = Ranks(ends_job=True)
    return ranks, getattr(options, "threads", 0) or (1 if ranks.size > 1 else 0)


def _changes(options) -> Dict[str, Any]:
    """The changes of a scenario that the options give."""
    changes = {"number_of_scans": options.scans, "weather": options.weather}
    return {name: value for name, value in changes.items() if value is not None}


def sequence(options) -> None:
    ranks, threads = _job(options, draws=False)
    scenario, changes = read_scenario(options.scenario), _changes(options)
    if options.weather:
        changes["scan"] = scenario["scan"] = without_air(scenario.get("scan", {}))
    for part, values in (("sensor", options.sensor_set), ("scan", options.scan_set)):
        if values:
            changes[part] = {**scenario.get(part, {}), **in_snake_case(PROPERTIES[part], dict(values), f"--{part}-set")}
    line = {"file_name": str(pathlib.Path(options.trajectory).resolve())} if options.trajectory else \
        scenario.get("trajectory", {})
    if line or options.trajectory_set:
        changes["trajectory"] = {**line, **settings_of(options.trajectory_set)}
    if options.trajectory and "trajectory" not in scenario:  # its sensor stands in the scene, not on the platform
        given = in_snake_case(PROPERTIES["sensor"], dict(options.sensor_set), "--sensor-set")
        changes["sensor"] = {**{name: value for name, value in scenario["sensor"].items() if name not in PLACE}, **given}
    sequence = Sequence(options.scenario, threads=threads, **changes)
    for one in sequence.flights.values() if ranks.rank == 0 else ():
        tell(f"{one.words}\n  {sequence.period(one)}")
    done = itertools.count(1)
    what = "scans" if ranks.size == 1 else "scans of the first rank"
    with _goes_on(options.out, "sequences/[0-9]*/done.json", "whole sequences"):
        manifest = sequence.write(options.out, ranks, None if ranks.rank else
                                  lambda *_: bar(what, next(done), sequence.scans_to_do))
    if ranks.rank == 0:
        parts = manifest["sequences"].values()
        name = pathlib.Path(options.scenario).name.split(".")[0]
        shown = _view.beside(options.out / "view.html", sequence.scene, name, sequence=options.out)
        tell(f"{options.out}: {counted(sum(p['scans'] for p in parts), 'scan')} in "
             f"{counted(len(parts), 'sequence')}, birds seen in "
             f"{sum(p['scans_with_birds_seen'] for p in parts)} of these scans; datasheet.md gives details"
             f"{', view.html shows the first sequence' if shown else ''}")


_OF_RECORDINGS = ("rate", "topic", "origin", "heading", "truth", "position", "sensor_address")


def is_recording(name: str) -> bool:
    """Whether an input is recorded scans, neither a folder of sequences nor a scenario."""
    path = pathlib.Path(name)
    return not (path / "manifest.json").exists() if path.is_dir() else path.suffix.lower() != ".json"


def _track_recordings(options) -> None:
    if len(options.sensor) > 1:
        raise ValueError(f"--sensor is given {len(options.sensor)} times, expected once for a recording: its own sensor")
    if options.weather:
        raise ValueError("--weather is for scenarios, expected none for a recording")
    names = [pathlib.Path(name).name.split(".")[0] for name in options.inputs]
    for number, name in enumerate(options.inputs):
        recording = load_clouds(name, options.rate, options.topic, options.sensor_address)
        out = options.out / checked_name(names[number], "the name of a recording") if len(names) > 1 else options.out
        found = RecordedTracks(recording, Sensor(options.sensor[0]) if options.sensor else None, options.learn,
                               dict(options.clutter_set), dict(options.tracker_set), options.origin,
                               options.heading or 0.0, options.runways, options.scans, options.truth, options.cutoff,
                               options.order, options.position).write(out, bar)
        close_bar()
        if found["scores"]:
            table([("score", name), *map(tuple, found["scores"])])
        tell(f"{name}: {counted(found['scans'], 'scan')}; times from: {recording.times_from}",
             f"{out / 'tracks.html'}: {counted(found['tracks'], 'confirmed track')} in "
             f"{in_time(found['seconds'])}{'; play.py is a state for ParaView' if recording.files else ''}")


def track(options) -> None:
    recorded = [name for name in options.inputs if is_recording(name)]
    if recorded and len(recorded) == len(options.inputs):
        drawing.require()
        _track_recordings(options)
        return
    if recorded:
        raise ValueError(f"{recorded[0]} is a recording, but other inputs are sequences or scenarios: expected one kind")
    for name in _OF_RECORDINGS:
        if getattr(options, name) is not None:
            raise ValueError(f"--{name.replace('_', '-')} is for recordings, expected none for sequences and scenarios")
    ranks, threads = _job(options)
    tracks = BirdTracks(options.inputs, options.runways, options.learn, options.cutoff, options.order,
                        dict(options.clutter_set), dict(options.tracker_set), options.sensor, threads,
                        **_changes(options))
    def page() -> bool:
        name, folder = next(iter(tracks.folders.items()))
        return _view.beside(options.out / "view.html", read_scenario(folder / "manifest.json")["scene"], name,
                            sequence=folder, tracks=options.out / "tracks.csv", tracks_of=name)
    with _goes_on(options.out, "followed/*/*.json", "sequences followed"):
        card = tracks.write(options.out, ranks, None if ranks.rank else bar, page)
    if ranks.rank == 0:
        table([("score", *card["names"]), *((row["words"], *row["cells"]) for row in card["overall"])])
        tell(f"{options.out / 'card.html'}: the report card; its tables and pictures are beside it")


def bench(options) -> None:
    from .sequences._bench import verdict, write_bench
    drawing.require()
    found = write_bench(options.folders, options.predictions, options.out, options.sequences, options.first, bar)
    tell(*(f"{scored[0].set.name}, {scored[0].set.weather}: {verdict(scored)}" for scored in found),
         f"{options.out / 'bench.html'}: the page; its tables and pictures are beside it")


def airport(options) -> None:
    from .airport._write import write
    from .airport._map import AirportMap
    from .airport._pages import counts
    extract = AirportMap(options.extract, options.heights, options.icao, options.bounds, options.obstacles, bar)
    with only_run(options.out, goes_on=False):
        kept, made = write(extract, options.out)
    close_bar()
    for name in kept.edited:
        warn(f"{options.out / name} was edited and is kept; remove this file to have it made again")
    buildings = [row for row in made.rows if "height" in row]
    if buildings and all(str(row.get("height_from")).startswith("assumed") for row in buildings):
        warn(f"{options.extract} says no height of any building: all heights are assumed by kind, "
             f"{options.out / 'assumed.csv'} lists these heights")
    tell(f"{options.out}: {extract.name}, {len(made.sides)} {'runways' if len(made.sides) > 1 else 'runway'}, "
         f"{len(buildings)} {'building' if len(buildings) == 1 else 'buildings'}; README.txt says what is assumed")
    tell(counts(made))


def _plan(options) -> Dict[str, Any]:
    """The plan with the changes that the options give."""
    return read_plan(options.plan, options.weather, getattr(options, "metar", None), **{
        part: dict(getattr(options, f"{part}_set", ())) for part in ("sensor", "coverage", "siting", "design")})


def _say_before(plan) -> None:
    if "hours" in plan.plan:
        tell(plan.plan["hours"])
    if plan.above != "ground":
        below = ("no surface is below the sensor" if plan.ground is None else
                 f"the ground below the sensor is at z = {plan.ground:.4g} m")
        warn(f"heights are above the scene's origin, and {below}")


def coverage(options) -> None:
    plans = Plan.all_of(_plan(options), options.threads)
    _say_before(plans[0])
    with only_run(options.out, goes_on=len(plans) > 1):  # complete maps of a sensor are kept
        for plan in plans:
            folder = options.out / plan.name if len(plans) > 1 else options.out
            with only_run(folder, goes_on=False) if len(plans) > 1 else contextlib.nullcontext():
                count = write_maps(plan, folder, functools.partial(bar, f"files of {plan.name}"))
                birds = [write_flown(plan, options.tracks, folder)] if options.tracks else []
                if options.trajectory:
                    birds.append(write_passed(plan, options.trajectory, folder, bar,
                                              **settings_of(options.trajectory_set, *PLACE)))
            row = plan.overall
            tell(f"{folder}: {counted(count, 'file')}; "
                 f"{plan.bird if any(plan.mix) else 'the target'} detected in one scan: "
                 f"{share_of(row)} {plan.where} (assumed: bird{', receiver' if plan.assumed else ''})",
                 *birds, *filter(None, [ranges.uncertainty(plan.name, plan.sensor)]))


def siting(options) -> None:
    ranks, _ = _job(options)
    plans = Plan.all_of(_plan(options), 1)
    if not ranks.rank:
        _say_before(plans[0])
    everywhere = [Sites(plan, options.out / "coverage", ranks, bar) for plan in plans]
    with _goes_on(options.out, "coverage/*.npy", "candidates kept"), \
            only_run(options.out, ranks, goes_on=True, known=plans[0].decides):
        for number, sites in enumerate(everywhere):
            changes = list(sites.look().changes())
            if not ranks.rank:
                _sites_page.write(sites, options.out / sites.plan.name if number else options.out, changes)
                _say_sites(sites, changes)


def _say_sites(sites, changes) -> None:
    name = sites.plan.name
    tell(f"{name}: {counted(len(sites.positions), 'candidate')}, of {sites.lattice}, for a {sites.plan.bird} "
         f"{sites.plan.where}")
    tell(f"obstacle limits: {_sites_page.kept_surfaces(sites)}")
    for row in sites.gain():
        where = "), (".join(row["sites"].replace(" ", ", ").split(";, "))
        tell(f"{row['sensors']} of {name}: {percent(row['value'], row['std_error'], sites.plan.count)} at ({where}) m")
    rows = sites.robustness(changes)
    for row in rows:
        other = (f"another winner in {row['another winner']} of {row['draws']} draws, better by at most "
                 f"{100 * row['gain at most']:.1f} %" if row["another winner"] else
                 f"the same winner in all {row['draws']} draws")
        tell(f"{row['change']}, {counted(row['sensors'], 'sensor')}: {other}")
    if not rows:
        tell("how sure the winner is was not computed, because the plan has too few draws")


def design(options) -> None:
    ranks, threads = _job(options)
    plan = Plan(_plan(options), threads)
    if not ranks.rank:
        _say_before(plan)
    study = Designs(plan, options.out, ranks, bar)
    with _goes_on(options.out, "coverage/*.npy", "designs kept"):
        study.write()
    if not ranks.rank:
        close_bar()
        refused = [one.refused for one in study.candidates if one.refused]
        if refused:
            warn(f"{len(refused)} of {len(study.candidates)} designs are left out, because the sensor refuses them: "
                 f"{refused[0]}")
        tell(*answers(study), f"{options.out / 'design.html'}: the page; its tables and pictures are beside it")


def _wanted(options) -> List[Any]:
    """The birds, flocks and other targets that the options give. The default is a herring gull."""
    birds = options.species or (ranges.own_species(options.birds) if options.birds else [])
    if not birds and not options.target:
        birds = ["herring gull"]
    if options.flock is not None:
        if not birds:
            raise ValueError(f"--flock {options.flock} is for birds, expected --species or --birds as well")
        birds = [ranges.flock(species, options.flock) for species in birds]
    if options.height is not None and "ground" not in options.target:
        raise ValueError(f"--height {options.height:g} is for the ground, expected --target ground as well")
    return birds + [ranges.target(form, options.reflectance, options.height if form == "ground" else None)
                    for form in options.target]


def reach(options) -> None:
    if options.out and options.out.suffix.lower() != ".csv":
        raise ValueError(f"{options.out}: is not the name of a table, expected one that ends in .csv")
    several = _wanted(options)
    ideas = [idea(name, Sensor(name), dict(options.sensor_set)) for name in options.sensor]
    if any(ideas):
        tell(*filter(None, [*ideas, *(farthest(one) for one in several if isinstance(one, str) and not options.birds)]))
    rows: List[Tuple[Any, ...]] = [("sensor", "target", "9 of 10, to", "half, to", "a tenth, to",
                                    "9 of 10 by 2 of 3 scans, to", "points at half of the range of half")]
    said, curve = [], []
    pairs = list(itertools.product(options.sensor, several))
    for number, (name, what) in enumerate(pairs):
        def progress(share: float, _: str = "", number: int = number, begin: float = 0.0, part: float = 1.0) -> None:
            bar("reach", round(100.0 * (number + begin + part * share) / len(pairs)), 100)
        progress(0.0)
        sensor = Sensor(name).set(**dict(options.sensor_set))
        asked = sorted(set(sensor.not_given) & set(PATTERN) - set(map(snake, dict(options.sensor_set))))
        if asked:
            raise ValueError(f"{name} does not give {', '.join(asked)}, expected these numbers in the file or by "
                             "--sensor-set: targets between the beams are not seen, so the pattern decides the answer")
        settings: Dict[str, Any] = {**ranges.air_of(sensor, options.weather), "required_detections": 2,
                                    "number_of_scans": 3}
        if options.birds:
            settings["species_file_name"] = str(options.birds)
        if options.reflectance is not None:
            settings["reflectance"] = options.reflectance
        part = 1.0 if ranges.interval(sensor) is None else 1.0 / 3.0
        found = ranges.within_beams(sensor, what, progress=functools.partial(progress, part=part), **settings)
        limits = ranges.in_interval(sensor, what, progress=functools.partial(progress, begin=part, part=1.0 - part),
                                    **settings)
        to, words = found.to(0.5), getattr(what, "words", what)
        points = ranges.points(sensor, what, 0.5 * to, **settings) if to else None
        rows.append((name, words, *(ranges.in_words(found, limits, share) for share in ranges.SHARES),
                     ranges.in_words(found, limits, 0.9, True), "–" if points is None else f"{points:.2g}"))
        said.append(ranges.sentence(name, what, found, limits, points, sensor.range_gate))
        columns = {"range": found.ranges, "one_scan": found.one_scan, "one_scan_std_error": found.error,
                   "two_of_three": found.several_scans}
        curve += [{"sensor": name, "species": words, **dict(zip(columns, map(float, row)))}
                  for row in zip(*columns.values())]
    bar("reach", 100, 100)
    table(rows)
    tell(*said)
    birds = not options.birds and any(isinstance(one, str) or one.kind == "flock" for one in several)
    sizes = "; sizes of birds are assumed" if birds else ""
    tell(f"Targets lie evenly between the lowest and the highest beam{sizes}. "
         "In brackets: the interval for units of this kind.",
         *(text for name in options.sensor if (text := ranges.uncertainty(name, Sensor(name)))))
    if options.out:
        write_table(options.out, curve)
        tell(f"{options.out}: the shares by range")


def report(options) -> None:
    report = Report(_plan(options), options.threads, bar)
    _say_before(report.plans[0])
    folder = report.write(options.out)
    tell(f"{options.out}: the report; {folder}: its tables and pictures")
