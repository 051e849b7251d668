# SPDX-License-Identifier: BSD-3-Clause
"""What the verbs of the command `avianlidar` do; of `apps` each imports what not all of them need."""
from __future__ import annotations

import contextlib
import itertools
import pathlib
import sys
import warnings
from typing import Any, Callable, Dict, Iterable, Iterator, List, Tuple

import numpy as np

from . import BirdTracks, Cloud, Scan, Scene, Sensor, Sequence, _display, _scene, _sheet, load_cloud, save
from . import vtkAvianLidar as _wrapped
from ._advice import check_suffix as check_advice
from ._advice import notes_of, table_rows
from ._cloud import vertices
from ._disk import only_run, replacing
from ._pipeline import update
from ._properties import in_snake_case
from ._ranks import Ranks
from ._sight import extent, of_scene
from ._suffixes import OF_SENSOR, PACKETS, POINTS
from ._weather import weather, without_air
from ._writers import check_suffix, check_target
from .apps import _design_page, _pictures
from .apps import reach as ranges
from .apps._answer import percent
from .apps._maps import Plan, read_plan, write_table
from .apps._report import Report
from .apps._sequence import PROPERTIES, read_scenario
from .apps._sites import Sites

_shown: List[Any] = []  # the bar on the terminal


def bar(what: str, done: float, total: float) -> None:
    """A bar on a terminal for each work that is named; nothing in a log."""
    if not _shown or _shown[0].desc != what:
        close_bar()
        if not sys.stderr.isatty():
            return
        from tqdm import tqdm
        _shown.append(tqdm(total=total, file=sys.stderr))
        _shown[0].desc = what
    _shown[0].update(done - _shown[0].n)


def close_bar(leave: bool = True) -> None:
    """@param leave it on the terminal"""
    while _shown:
        last = _shown.pop()
        last.leave = leave
        last.close()


def tell(*lines: Any) -> None:
    """Lines to the output, below the bar."""
    close_bar()
    print(*lines, sep="\n")


def say(text: str) -> None:
    """One line to the error stream, at the end of the work."""
    close_bar(leave=False)
    print(f"avianlidar: {' '.join(text.split())}", file=sys.stderr)


def warn(text: str) -> None:
    """One line to the error stream, above a bar."""
    for shown in _shown:
        shown.clear()
    print(f"avianlidar: warning: {' '.join(text.split())}", file=sys.stderr)


def _table(rows: Iterable[Tuple[Any, ...]]) -> None:
    """Columns as wide as their words."""
    lines = [[str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    tell(*("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines))


def _check_outs(options, check: Callable[[pathlib.Path], None]) -> None:
    """Errors of names before the work. @param check by suffix"""
    for number, out in enumerate(options.out):
        check(out)
        if out.suffix.lower() == ".png":
            import matplotlib
            matplotlib.use("Agg")
        check_target(out, [*options.out[:number], pathlib.Path(options.scene)])


def _alarms(cloud) -> str:
    """How many echoes no surface has given."""
    ids = list(cloud.get("object_id", ()))
    return "".join(f", {ids.count(number)} of them {words} (object_id {number})" for number, words in
                   ((-1, "a false alarm of the noise"), (-2, "of the air")) if number in ids)


def _scan_of(options) -> Scan:
    """The scan that options describe."""
    def percent_of(what: str):
        return lambda share, _: bar(what, round(100 * share), 100)

    scene = Scene(options.scene, material=options.material, scale=options.scale, up_axis=options.up_axis,
                  progress=percent_of("scene"))
    sensor = Sensor(options.sensor, position=options.position or scene.lidar_position or (0, 0, 0)).set(**dict(options.sensor_set))
    scan = Scan(scene, sensor, progress=percent_of(options.verb))
    preset = getattr(options, "preset", None)
    if preset:
        scan.preset = preset
        scene.tree.SetPreset(preset == "Paper")
    return scan.set(**{"number_of_threads": options.threads, **weather(options.weather), **dict(options.scan_set)})


def scan(options) -> None:
    _check_outs(options, lambda out: check_suffix(out, (".png",)))
    scan = _scan_of(options)
    for out in options.out:
        if out.suffix.lower() == ".geojson" and not scan.scene.geodetic_origin:
            raise ValueError(f"{out}: GeoJSON needs longitude and latitude, and the scene has no origin on the Earth")
    echoes = scan.echoes.annotated()
    for out in options.out:
        if out.suffix.lower() == ".png":
            with replacing(out) as name:
                scan.plot_range_image("energy").figure.savefig(name, format="png", dpi=150)
        else:
            save(echoes, out)
        labels = f", labels in {out.with_suffix('.label').name}" if out.suffix.lower() == ".bin" else ""
        tell(f"{out}: {echoes.number_of_points} echoes of {scan.report.number_of_points} beams{_alarms(echoes)}{labels}")
    if not options.quiet:
        tell(*notes_of(echoes.fields))


def advise(options) -> None:
    _check_outs(options, check_advice)
    advice = _scan_of(options).advise(options.energy, options.range, options.missed, options.beams)
    _table(table_rows(advice))
    tell(advice)
    for out in options.out:
        advice.save(out)
        tell(f"{out}: the advice")


def _of_packets(options, *files) -> Dict[str, Any]:
    """What options choose of packets."""
    chosen = {name: getattr(options, name) for name in ("time", "sensor_address") if getattr(options, name) is not None}
    for name, value in chosen.items():
        if not any(file.suffix.lower() in PACKETS for file in files):
            raise ValueError(f"--{name.replace('_', '-')} {value} chooses packets, expected a file {' or '.join(PACKETS)}: "
                             f"it is {files[0]}")
    return chosen


def _cloud(file, chosen: Dict[str, Any]):
    """A cloud in the scene's frame, where the file says it. @param chosen of packets"""
    suffix = file.suffix.lower()
    return load_cloud(file, **{"local_coordinates": True} if suffix in (".las", ".laz") else chosen if suffix in PACKETS else {})


def _has_points_only(file: pathlib.Path) -> bool:
    """Whether a file holds points without triangles."""
    suffix = file.suffix.lower()
    if suffix == ".ply":
        with open(file, "rb") as stream:
            header = stream.read(65536).partition(b"end_header")[0]
        return not any(line.split()[1:2] == [b"face"] and line.split()[2:] != [b"0"] for line in header.splitlines())
    return suffix in POINTS or suffix == ".vtp" and not load_cloud(file).data.GetNumberOfPolys()


def _words(value: Any) -> str:
    """A value of a file or of field data as a user reads it."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_words(part)}" for key, part in value.items())
    parts = value.tolist() if hasattr(value, "tolist") else value
    return ", ".join(f"{part:.10g}" if isinstance(part, float) else str(part) for part in parts) if isinstance(parts, (list, tuple)) \
        else str(parts)


def _say_cloud(file: pathlib.Path, cloud: Cloud, quiet: bool) -> None:
    print(f"{file}: a cloud of {cloud.number_of_points} points{_alarms(cloud)}")
    if not cloud.number_of_points:
        return
    fields = cloud.fields
    known = {"extent": extent(cloud.data.GetBounds()) if "crs_wkt" not in fields else _words(cloud.data.GetBounds())}
    if file.suffix.lower() in OF_SENSOR:
        known["frame"] = "of the sensor: right, forward and up for east, north and up"
    units = cloud.field_units
    for name in ("geodetic_origin", "position", "crs_wkt"):
        if name in fields:
            known[name] = f"{_words(fields[name])} {units[name]}"
    _table(known.items())
    rows: List[Tuple[Any, ...]] = [("array", "unit", "least", "greatest")]
    for name, values in cloud.items():
        finite = values[np.isfinite(values)] if np.isfinite(values).any() else np.array([np.nan])
        rows.append((name, cloud.units[name] or "-", f"{finite.min():.6g}", f"{finite.max():.6g}"))
    _table(rows)
    for line in () if quiet else notes_of(fields):
        print(line)


def info(options) -> None:
    file, name = options.file, options.file.name.lower()
    if not file.is_file():
        raise FileNotFoundError(f"no such file: {file}")
    chosen = _of_packets(options, file)
    rows: Dict[str, Any]
    bounds = None
    if name.endswith(".lidarsensor.json"):
        what, rows = "a sensor", _display.sensor_rows(Sensor(file))
    elif name.endswith(".coverage.json"):
        plan = read_plan(file)
        what, rows = "a plan of coverage", {
            key: plan[key] for key in ("scene", "sensor", "compare_with", "coverage", "weather", "mix", "heights", "regions", "spread", "runways", "siting", "design") if plan.get(key)}
        if "year" in plan:
            rows["year"] = "; ".join(f"{', '.join(part['weather']) or 'as in coverage'} {100 * part['share']:.3g} %" for part in plan["year"])
    elif name.endswith(".json") and not name.endswith(".lidarscene.json"):
        scenario = read_scenario(file)
        what, rows = "a scenario of sequences", {key: scenario[key] for key in ("scene", "sensor", "weather", "number_of_scans") if key in scenario}
    elif _has_points_only(file):
        _say_cloud(file, _cloud(file, chosen), options.quiet)
        return
    else:
        scene = Scene(file)
        what, rows, bounds = "a scene", _display.scene_rows(scene), scene.bounds if scene.number_of_triangles else None
    print(f"{file}: {what}")
    _table((key, _words(value)) for key, value in rows.items())
    for text in of_scene(bounds) if bounds else ():
        warn(text)


def _compared(*clouds) -> Any:
    """The comparison of two clouds of VTK."""
    measure = _wrapped.vtkAvianLidarCloudComparison()
    for port, cloud in enumerate(clouds):
        measure.SetInputDataObject(port, cloud)
    update(measure)
    return measure


def compare(options) -> None:
    files = options.a, options.b
    if options.out:
        check_suffix(options.out)
        check_target(options.out, files)
    chosen = _of_packets(options, *files)
    clouds = [_cloud(file, chosen) for file in files]
    of_sensor = [file.suffix for file in files if file.suffix.lower() in OF_SENSOR]
    if len(of_sensor) == 1:
        warn(f"a {of_sensor[0]} file is in the frame of its sensor, the other file is not")
    ways = "SimulatedToReference", "ReferenceToSimulated"
    measure, (a, b) = _compared(*(cloud.data for cloud in clouds)), (file.name for file in files)
    _table([("distance of nearest points (m)", f"{a} to {b}", f"{b} to {a}"),
            *((words, *(f"{getattr(measure, f'Get{name}{way}')():.6g}" for way in ways)) for words, name in (
                ("root mean square", "RMSE"), ("largest", "Hausdorff"),
                ("density-aware Chamfer distance (1)", "DensityAwareChamfer"))),
            ("number of points", *(cloud.number_of_points for cloud in clouds))])
    print(f"Hausdorff distance: {measure.GetHausdorffDistance():.6g} m")
    alarms = [f"{file.name} has {cloud.number_of_points} echoes{_alarms(cloud)}" for file, cloud in zip(files, clouds) if _alarms(cloud)]
    if alarms:
        left = [cloud.points[cloud["object_id"] >= 0] if "object_id" in cloud else cloud.points for cloud in clouds]
        print(f"All numbers here count echoes that no surface has returned: {'; '.join(alarms)}." +
              (f" Without them the Hausdorff distance is {_compared(*map(vertices, left)).GetHausdorffDistance():.6g} m."
               if all(map(len, left)) else ""))
    print(f"density-aware Chamfer distance: {measure.GetDensityAwareChamferDistance():.6g} "
          f"(alpha = {measure.GetChamferAlpha():g} 1/m)")
    if options.out:
        save(Cloud(measure.GetOutputDataObject(0)), options.out)
        print(f"{options.out}: {a} with nearest_distance (m)")


def convert(options) -> None:
    chosen = _of_packets(options, options.file)
    to_mcap = options.out.suffix.lower() == ".mcap"
    if not to_mcap:
        check_suffix(options.out)
    check_target(options.out)
    if to_mcap:
        from .apps import _mcap
        print(f"{options.out}: {_mcap.write(options.file, options.out)} scans of {options.file}")
        return
    cloud = _cloud(options.file, chosen)
    save(cloud, options.out)
    print(f"{options.out}: {cloud.number_of_points} points of {options.file}")


def sensors(options) -> None:
    if options.fit:
        if options.name:
            raise ValueError(f"sensors: {options.name} and --fit {options.fit}, expected one of them")
        _fit(options)
        return
    if options.out:
        raise ValueError(f"sensors: -o {options.out} is where a fitted sensor goes, expected --fit FILE, too")
    if options.name:
        _table(_display.sensor_rows(Sensor(options.name)).items())
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about sensors that nobody has chosen
        all_rows = {name: _display.sensor_rows(Sensor(name)) for name in Sensor.presets()}
    keys = [key for key in next(iter(all_rows.values())) if key not in ("position", "what")]
    _table([("name", *keys), *((name, *(rows.get(key, "") for key in keys)) for name, rows in all_rows.items())])


def _fit(options) -> None:
    if options.out:
        check_target(options.out)
    sensor = Sensor(options.fit)
    description = sensor.description
    found = sensor.fit()
    points = description["sheet"]["points"]
    _table([("reflectance", "light (klx)", "seen with", "range of the sheet (m)", "fitted (m)", "off", "off if left out", "source"),
            *((f"{point['reflectance']:g}", f"{point.get('light', 0):g}", f"{point.get('probability', _sheet.HALF):g}"
               + ("" if "probability" in point else ", assumed"), f"{point['range']:g}", f"{predicted:.1f}", f"{100 * off:+.1f} %",
               "-" if left != left else f"{100 * left:+.1f} %", point["source"])
              for point, predicted, off, left in zip(points, found.predicted, found.residuals, found.left_out))])
    print(*(f"{name} {value:.4g}" for name, value in found.numbers.items()),
          *([f"board of the maker {found.board:.3g} m"] if found.board == found.board else []), sep=", ")
    if found.limit:
        print(found.limit)
    print(f"ranges by this receiver are good for {100 * found.bar:.0f} %" if found.bar == found.bar else
          "what ranges by this receiver are good for is not known: no point can be left out of the fit")
    if options.out:
        _sheet.write(description, found, options.out)
        print(options.out)


def materials(_) -> None:
    of = {_wrapped.vtkAvianLidarMaterial.GetMaterialName(i): _wrapped.vtkAvianLidarMaterial.GetMaterialSource(i) for i in range(100)}
    _table([("name", *_scene.COEFFICIENTS, "source"),
            *((name, *(f"{value:g}" for value in values), of[name]) for name, values in _scene.materials().items())])


@contextlib.contextmanager
def _goes_on(folder: pathlib.Path, pattern: str, what: str) -> Iterator[None]:
    """Ctrl-C says what is there to go on with. @param what the files of that pattern are"""
    try:
        yield
    except KeyboardInterrupt:
        count = len(list(folder.glob(pattern)))
        raise KeyboardInterrupt(*[f"{folder}: {what}: {count}; the same command goes on"] if count else []) from None


def _job(options, draws: bool = True) -> Tuple[Ranks, int]:
    """The ranks of a job, and threads for each; ImportError where a job that draws has no Matplotlib."""
    if draws:
        _pictures.gradient()
    ranks = Ranks(ends_job=True)
    return ranks, getattr(options, "threads", 0) or (1 if ranks.size > 1 else 0)


def _changes(options) -> Dict[str, Any]:
    """What options change of a scenario."""
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
    sequence = Sequence(options.scenario, threads=threads, **changes)
    done, what = itertools.count(1), "scans" if ranks.size == 1 else "scans of the first rank"
    with _goes_on(options.out, "sequences/[0-9]*/done.json", "whole sequences"):
        manifest = sequence.write(options.out, ranks, None if ranks.rank else
                                  lambda *_: bar(what, next(done), sequence.scans_to_do))
    if ranks.rank == 0:
        parts = manifest["sequences"].values()
        tell(f"{options.out}: {sum(p['scans'] for p in parts)} scans in {len(parts)} sequences, birds seen in "
             f"{sum(p['scans_with_birds_seen'] for p in parts)} of them; datasheet.md says more")


def track(options) -> None:
    ranks, threads = _job(options)
    tracks = BirdTracks(options.inputs, options.runways, options.learn, options.cutoff, options.order,
                        dict(options.clutter_set), dict(options.tracker_set), options.sensor, threads, **_changes(options))
    with _goes_on(options.out, "followed/*/*.json", "sequences followed"):
        card = tracks.write(options.out, ranks, None if ranks.rank else bar)
    if ranks.rank == 0:
        _table([("score", *card["names"]), *((row["words"], *row["cells"]) for row in card["overall"])])
        print(f"{options.out / 'card.html'}: the report card; its tables and pictures are beside it")


def bench(options) -> None:
    from .apps._bench import Bench, verdict
    _pictures.gradient()  # needs Matplotlib: said before the work
    found = Bench(options.folders, options.predictions, options.sequences, options.first).write(options.out, bar)
    tell(*(f"{scored[0].set.name}, {scored[0].set.weather}: {verdict(scored)}" for scored in found),
         f"{options.out / 'bench.html'}: the page; its tables and pictures are beside it")


def airport(options) -> None:
    from .apps._airport import Airport
    made = Airport(options.extract, options.heights, options.icao, options.bounds, options.obstacles, bar)
    with only_run(options.out, goes_on=False):
        kept = made.write(options.out)
    close_bar()
    for name in kept.edited:
        warn(f"{options.out / name} was edited and stays as it is; remove it to have it made again")
    buildings = [row for row in made.rows if "height" in row]
    if buildings and all(row.get("height_from") == "assumed" for row in buildings):
        warn(f"{options.extract} says no height of any building: all are assumed by kind, {options.out / 'assumed.csv'} lists them")
    print(f"{options.out}: {made.name}, {len(made.sides)} {'runways' if len(made.sides) > 1 else 'runway'}, "
          f"{len(buildings)} {'building' if len(buildings) == 1 else 'buildings'}; README.txt says what is assumed")
    print(made.counts)


def _plan(options) -> Dict[str, Any]:
    """The plan with what options change."""
    return read_plan(options.plan, options.weather, getattr(options, "metar", None),
                     **{part: dict(getattr(options, f"{part}_set", ())) for part in ("sensor", "coverage", "siting", "design")})


def _say_before(plan) -> None:
    if "hours" in plan.plan:
        print(plan.plan["hours"])
    if plan.above != "ground":
        below = "no surface is below the sensor" if plan.ground is None else f"the ground below the sensor is at z = {plan.ground:.4g} m"
        warn(f"heights are above the scene's origin, and {below}")


def coverage(options) -> None:
    plans = Plan.all_of(_plan(options), options.threads)
    _say_before(plans[0])
    with only_run(options.out, goes_on=len(plans) > 1):  # maps of a sensor that are whole stay
        for plan in plans:
            folder = options.out / plan.name if len(plans) > 1 else options.out
            with only_run(folder, goes_on=False) if len(plans) > 1 else contextlib.nullcontext():
                names = plan.write(folder, lambda done, total, name=plan.name: bar(f"files of {name}", done, total))
            row = plan.overall
            tell(f"{folder}: {len(names)} files; {plan.coverage.species or 'the target'} detected in one scan: "
                 f"{row['detection_probability']:.3f} +- {row['detection_std_error']:.3f} {plan.where} (assumed: bird"
                 f"{', receiver' if plan.assumed else ''})")


def siting(options) -> None:
    ranks, _ = _job(options)
    plans = Plan.all_of(_plan(options), 1)
    if not ranks.rank:
        _say_before(plans[0])
    everywhere = [Sites(plan, options.out / "coverage", ranks, bar) for plan in plans]
    with _goes_on(options.out, "coverage/*.npy", "candidates kept"), only_run(options.out, ranks, goes_on=True, known=plans[0].decides):
        for number, sites in enumerate(everywhere):
            changes = list(sites.look().changes())
            if not ranks.rank:
                sites.write(options.out / sites.plan.name if number else options.out, changes)
                _say_sites(sites, changes)


def _say_sites(sites, changes) -> None:
    name = sites.plan.name
    tell(f"{name}: {len(sites.positions)} candidates, of {sites.lattice}, for a {sites.plan.bird} {sites.plan.where}")
    print(f"obstacle limits: {sites.kept_surfaces}")
    for row in sites.gain():
        where = "), (".join(row["sites"].replace(" ", ", ").split(";, "))
        print(f"{row['sensors']} of {name}: {percent(row['value'], row['std_error'], sites.plan.count)} at ({where}) m")
    rows = sites.robustness(changes)
    for row in rows:
        print(f"{row['change']}, {row['sensors']} {'sensors' if row['sensors'] > 1 else 'sensor'}: another winner in {row['another winner']} of "
              f"{row['draws']} draws, better by at most {100 * row['gain at most']:.1f} %")
    if not rows:
        print("how sure the winner is was not looked at: fewer draws than that takes")


def design(options) -> None:
    ranks, threads = _job(options)
    plan = Plan(_plan(options), threads)
    if not ranks.rank:
        _say_before(plan)
    study = _design_page.Designs(plan, options.out, ranks, bar)
    with _goes_on(options.out, "coverage/*.npy", "designs kept"):
        study.write()
    if not ranks.rank:
        close_bar()
        refused = [one.refused for one in study.candidates if one.refused]
        if refused:
            warn(f"{len(refused)} of {len(study.candidates)} designs are none, as the sensor refuses them: {refused[0]}")
        tell(*_design_page.answers(study),
             f"{options.out / 'design.html'}: the page; its tables and pictures are beside it")


def reach(options) -> None:
    if options.out and options.out.suffix.lower() != ".csv":
        raise ValueError(f"{options.out}: is not the name of a table, expected one that ends in .csv")
    rows: List[Tuple[Any, ...]] = [("sensor", "bird", "9 of 10, to", "half, to", "a tenth, to", "9 of 10 by 2 of 3 scans, to")]
    said, curve = [], []
    for name in options.sensor:
        sensor = Sensor(name).set(**dict(options.sensor_set))
        for species in options.species or ["herring gull"]:
            found = ranges.within_beams(sensor, species, **ranges.air_of(sensor, options.weather), required_detections=2, number_of_scans=3)
            rows.append((name, species, ranges.metres(found.to(0.9)), ranges.half(sensor, found), ranges.metres(found.to(0.1)), ranges.metres(found.to(0.9, True))))
            said.append(ranges.sentence(name, species, sensor, found))
            curve += [{"sensor": name, "species": species, "range": float(to), "one_scan": float(one), "one_scan_std_error": float(error), "two_of_three": float(two)}
                      for to, one, error, two in zip(found.ranges, found.one_scan, found.error, found.several_scans)]
    _table(rows)
    print(*said, sep="\n")
    print("Birds lie evenly between the lowest and the highest beam; sizes of birds are assumed. In brackets: what the fit of the receiver to its sheet leaves open.")
    if options.out:
        write_table(options.out, curve)
        print(f"{options.out}: the shares by range")


def report(options) -> None:
    report = Report(_plan(options), options.threads, bar)
    _say_before(report.plans[0])
    folder = report.write(options.out)
    tell(f"{options.out}: the report; {folder}: its tables and pictures")
