# SPDX-License-Identifier: BSD-3-Clause
"""What the verbs of the command `avianlidar` do; each imports what it needs."""
from __future__ import annotations

import contextlib
import itertools
import pathlib
import sys
import warnings
from typing import Any, Callable, Dict, Iterable, Iterator, List, Tuple

from ._suffixes import PACKETS, TABLES


class Bars:
    """A bar on a terminal for each work that is named; nothing in a log."""

    shown: Any = None  # the bar that is on the terminal

    def __call__(self, what: str, done: float, total: float) -> None:
        if Bars.shown is None or Bars.shown.desc != what:
            self.close()
            if not sys.stderr.isatty():
                return
            from tqdm import tqdm
            Bars.shown = tqdm(total=total, file=sys.stderr)
            Bars.shown.desc = what
        Bars.shown.update(done - Bars.shown.n)

    @staticmethod
    def close(leave: bool = True) -> None:
        """Be done with it. @param leave it on the terminal"""
        if Bars.shown is not None:
            Bars.shown.leave = leave
            Bars.shown.close()
            Bars.shown = None


def say(text: str) -> None:
    """One line to the error stream, at the end of the work."""
    Bars.close(leave=False)
    print(f"avianlidar: {' '.join(text.split())}", file=sys.stderr)


def warn(text: str) -> None:
    """One line to the error stream, above a bar."""
    if Bars.shown is not None:
        Bars.shown.clear()
    print(f"avianlidar: warning: {' '.join(text.split())}", file=sys.stderr)


def _table(rows: Iterable[Tuple[Any, ...]], file=None) -> None:
    """Columns as wide as their words."""
    lines = [[str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    for line in lines:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip(), file=file)


def _scene(options, bars: Bars):
    from . import Scene
    return Scene(options.scene, material=options.material, scale=options.scale, up_axis=options.up_axis,
                 progress=lambda share, _: bars("scene", round(100 * share), 100))


def _check_outs(options, check: Callable[[pathlib.Path], None]) -> None:
    """Errors of names before the work. @param check by suffix"""
    from ._writers import check_target
    for number, out in enumerate(options.out):
        check(out)
        if out.suffix.lower() == ".png":
            import matplotlib
            matplotlib.use("Agg")
        check_target(out, [*options.out[:number], pathlib.Path(options.scene)])


def _alarms(cloud) -> str:
    """How many echoes no surface has given."""
    said = ""
    for number, words in ((-1, "a false alarm of the noise"), (-2, "of the air")):
        found = int((cloud["object_id"] == number).sum()) if "object_id" in cloud else 0
        said += f", {found} of them {words} (object_id {number})" if found else ""
    return said


def _scan_of(options, bars: Bars, scene):
    """The scan that options describe."""
    from . import Scan, Sensor
    from ._weather import weather
    sensor = Sensor(options.sensor, position=options.position or scene.lidar_position or (0, 0, 0)).set(**dict(options.sensor_set))
    scan = Scan(scene, sensor, progress=lambda share, _: bars(options.verb, round(100 * share), 100))
    preset = getattr(options, "preset", None)
    if preset:
        scan.preset = preset
        scene.tree.SetPreset(preset == "Paper")
    return scan.set(**{"number_of_threads": options.threads, **weather(options.weather), **dict(options.scan_set)})


def scan(options) -> None:
    from . import save
    from ._advice import notes_of
    from ._disk import replacing
    from ._writers import check_suffix
    _check_outs(options, lambda out: check_suffix(out, (".png",)))
    bars = Bars()
    scene = _scene(options, bars)
    if not scene.geodetic_origin:
        for out in options.out:
            if out.suffix.lower() == ".geojson":
                raise ValueError(f"{out}: GeoJSON needs longitude and latitude, and the scene has no origin on the Earth")
    scan = _scan_of(options, bars, scene)
    echoes = scan.echoes.annotated()
    bars.close()
    for out in options.out:
        if out.suffix.lower() == ".png":
            with replacing(out) as name:
                scan.plot_range_image("energy").figure.savefig(name, format="png", dpi=150)
        else:
            save(echoes, out)
        labels = f", labels in {out.with_suffix('.label').name}" if out.suffix.lower() == ".bin" else ""
        print(f"{out}: {echoes.number_of_points} echoes of {scan.report.number_of_points} beams{_alarms(echoes)}{labels}")
    if not options.quiet:
        print(*notes_of(echoes.fields), sep="\n")


def advise(options) -> None:
    from ._advice import check_suffix, table_rows
    _check_outs(options, check_suffix)
    bars = Bars()
    scan = _scan_of(options, bars, _scene(options, bars))
    advice = scan.advise(options.energy, options.range, options.missed, options.beams)
    bars.close()
    _table(table_rows(advice))
    print(advice)
    for out in options.out:
        advice.save(out)
        print(f"{out}: the advice")


def _cloud(file, options=None):
    """A cloud in the scene's frame, where the file says it; of packets what the options `time` and `sensor_address` choose."""
    from . import load_cloud
    suffix = file.suffix.lower()
    chosen = {name: getattr(options, name) for name in ("time", "sensor_address") if getattr(options, name, None) is not None} if suffix in PACKETS else {}
    return load_cloud(file, **({"local_coordinates": True} if suffix in (".las", ".laz") else chosen))


def _check_packets(options, *files) -> None:
    for name in ("time", "sensor_address"):
        if getattr(options, name) is not None and not any(file.suffix.lower() in PACKETS for file in files):
            raise ValueError(f"--{name.replace('_', '-')} {getattr(options, name)} chooses packets, expected a file {' or '.join(PACKETS)}: it is {files[0]}")


def _has_points_only(file: pathlib.Path) -> bool:
    """Whether a file holds points without triangles."""
    suffix = file.suffix.lower()
    if suffix == ".ply":
        with open(file, "rb") as stream:
            header = stream.read(65536).partition(b"end_header")[0]
        return not any(line.split()[1:2] == [b"face"] and line.split()[2:] != [b"0"] for line in header.splitlines())
    return suffix in (".las", ".laz", ".pcd", ".bin", *TABLES, *PACKETS) or suffix == ".vtp" and not _cloud(file).data.GetNumberOfPolys()


def _words(value: Any) -> str:
    """A value of a file or of field data as a user reads it."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_words(part)}" for key, part in value.items())
    parts = value.tolist() if hasattr(value, "tolist") else value
    return ", ".join(f"{part:.10g}" if isinstance(part, float) else str(part) for part in parts) if isinstance(parts, (list, tuple)) \
        else str(parts)


def _say_cloud(file: pathlib.Path, options) -> None:
    import numpy as np

    from ._advice import notes_of
    from ._sight import extent
    cloud = _cloud(file, options)
    print(f"{file}: a cloud of {cloud.number_of_points} points{_alarms(cloud)}")
    if not cloud.number_of_points:
        return
    fields = cloud.fields
    known = {"extent": extent(cloud.data.GetBounds()) if "crs_wkt" not in fields else _words(cloud.data.GetBounds())}
    if file.suffix.lower() in (".bin", *PACKETS):
        known["frame"] = "of the sensor: right, forward and up for east, north and up"
    units = cloud.field_units
    for name in ("geodetic_origin", "position", "crs_wkt"):
        if name in fields:
            known[name] = f"{_words(fields[name])} {units[name]}"
    _table(known.items())
    rows: List[Tuple[Any, ...]] = [("array", "unit", "least", "greatest")]
    for name, values in cloud.items():
        finite = values[np.isfinite(values)]
        ends = (f"{finite.min():.6g}", f"{finite.max():.6g}") if len(finite) else ("nan", "nan")
        rows.append((name, cloud.units[name] or "-", *ends))
    _table(rows)
    if not options.quiet:
        for line in notes_of(fields):
            print(line)


def info(options) -> None:
    from . import Scene, Sensor, _display
    from ._sight import of_scene
    from .apps._maps import read_plan
    from .apps._sequence import read_scenario
    file, name = options.file, options.file.name.lower()
    if not file.is_file():
        raise FileNotFoundError(f"no such file: {file}")
    _check_packets(options, file)
    rows: Dict[str, Any]
    scene = None
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
        _say_cloud(file, options)
        return
    else:
        scene = Scene(file)
        what, rows = "a scene", _display.scene_rows(scene)
    print(f"{file}: {what}")
    _table((key, _words(value)) for key, value in rows.items())
    if scene and scene.number_of_triangles:
        for text in of_scene(scene.bounds):
            warn(text)


def _without_alarms(clouds) -> str:
    """The Hausdorff distance of echoes that surfaces have returned."""
    from . import vtkAvianLidar as wrapped
    from ._cloud import vertices
    from ._pipeline import update
    left = [cloud.points[cloud["object_id"] >= 0] if "object_id" in cloud else cloud.points for cloud in clouds]
    if not all(map(len, left)):
        return ""
    measure = wrapped.vtkAvianLidarCloudComparison()
    for port, points in enumerate(left):
        measure.SetInputDataObject(port, vertices(points))
    update(measure)
    return f" Without them the Hausdorff distance is {measure.GetHausdorffDistance():.6g} m."


def compare(options) -> None:
    from . import Cloud, save
    from . import vtkAvianLidar as wrapped
    from ._pipeline import update
    from ._writers import check_suffix, check_target
    if options.out:
        check_suffix(options.out)
        check_target(options.out, [options.a, options.b])
    _check_packets(options, options.a, options.b)
    measure = wrapped.vtkAvianLidarCloudComparison()
    clouds = [_cloud(file, options) for file in (options.a, options.b)]
    of_sensor = [file.suffix for file in (options.a, options.b) if file.suffix.lower() in (".bin", *PACKETS)]
    if len(of_sensor) == 1:
        warn(f"a {of_sensor[0]} file is in the frame of its sensor, the other file is not")
    for port, cloud in enumerate(clouds):
        measure.SetInputDataObject(port, cloud.data)
    update(measure)
    there, back = f"{options.a.name} to {options.b.name}", f"{options.b.name} to {options.a.name}"
    _table([("distance of nearest points (m)", there, back),
            ("root mean square", f"{measure.GetRMSESimulatedToReference():.6g}", f"{measure.GetRMSEReferenceToSimulated():.6g}"),
            ("largest", f"{measure.GetHausdorffSimulatedToReference():.6g}", f"{measure.GetHausdorffReferenceToSimulated():.6g}"),
            ("density-aware Chamfer distance (1)", f"{measure.GetDensityAwareChamferSimulatedToReference():.6g}",
             f"{measure.GetDensityAwareChamferReferenceToSimulated():.6g}"),
            ("number of points", *(cloud.number_of_points for cloud in clouds))])
    print(f"Hausdorff distance: {measure.GetHausdorffDistance():.6g} m")
    alarms = [f"{file.name} has {cloud.number_of_points} echoes{_alarms(cloud)}" for file, cloud in zip((options.a, options.b), clouds) if _alarms(cloud)]
    if alarms:
        print(f"All numbers here count echoes that no surface has returned: {'; '.join(alarms)}.{_without_alarms(clouds)}")
    print(f"density-aware Chamfer distance: {measure.GetDensityAwareChamferDistance():.6g} "
          f"(alpha = {measure.GetChamferAlpha():g} 1/m)")
    if options.out:
        save(Cloud(measure.GetOutputDataObject(0)), options.out)
        print(f"{options.out}: {options.a.name} with nearest_distance (m)")


def convert(options) -> None:
    from . import save
    from ._writers import check_suffix, check_target
    _check_packets(options, options.file)
    if options.out.suffix.lower() == ".mcap":
        from .apps import _mcap
        check_target(options.out)
        print(f"{options.out}: {_mcap.write(options.file, options.out)} scans of {options.file}")
        return
    check_suffix(options.out)
    check_target(options.out)
    cloud = _cloud(options.file, options)
    save(cloud, options.out)
    print(f"{options.out}: {cloud.number_of_points} points of {options.file}")


def sensors(options) -> None:
    from . import Sensor, _display
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
    from . import Sensor
    from ._sheet import HALF, write
    from ._writers import check_target
    if options.out:
        check_target(options.out)
    sensor = Sensor(options.fit)
    description = sensor.description
    found = sensor.fit()
    points = description["sheet"]["points"]
    _table([("reflectance", "light (klx)", "seen with", "range of the sheet (m)", "fitted (m)", "off", "off if left out", "source"),
            *((f"{point['reflectance']:g}", f"{point.get('light', 0):g}", f"{point.get('probability', HALF):g}"
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
        write(description, found, options.out)
        print(options.out)


def materials(_) -> None:
    from . import materials as known
    from . import vtkAvianLidar as wrapped
    from ._scene import COEFFICIENTS
    of = {wrapped.vtkAvianLidarMaterial.GetMaterialName(i): wrapped.vtkAvianLidarMaterial.GetMaterialSource(i) for i in range(100)}
    _table([("name", *COEFFICIENTS, "source"),
            *((name, *(f"{value:g}" for value in values), of[name]) for name, values in known().items())])


@contextlib.contextmanager
def _goes_on(folder: pathlib.Path, pattern: str, what: str) -> Iterator[None]:
    """Ctrl-C says what is there to go on with. @param what the files of that pattern are"""
    try:
        yield
    except KeyboardInterrupt:
        count = len(list(folder.glob(pattern)))
        raise KeyboardInterrupt(*[f"{folder}: {what}: {count}; the same command goes on"] if count else []) from None


def sequence(options) -> None:
    from . import Sequence
    from ._properties import in_snake_case
    from ._ranks import Ranks
    from ._weather import without_air
    from .apps._sequence import PROPERTIES, read_scenario
    ranks = Ranks(ends_job=True)
    scenario = read_scenario(options.scenario)
    changes: Dict[str, Any] = {} if options.scans is None else {"number_of_scans": options.scans}
    if options.weather:
        scenario["scan"] = without_air(scenario.get("scan", {}))
        changes.update(weather=options.weather, scan=scenario["scan"])
    for part, values in (("sensor", options.sensor_set), ("scan", options.scan_set)):
        if values:
            changes[part] = {**scenario.get(part, {}), **in_snake_case(PROPERTIES[part], dict(values), f"--{part}-set")}
    sequence = Sequence(options.scenario, threads=options.threads or (1 if ranks.size > 1 else 0), **changes)
    bars, done, what = Bars(), itertools.count(1), "scans" if ranks.size == 1 else "scans of the first rank"
    with _goes_on(options.out, "sequences/[0-9]*/done.json", "whole sequences"):
        manifest = sequence.write(options.out, ranks, None if ranks.rank else
                                  lambda *_: bars(what, next(done), sequence.scans_to_do))
    bars.close()
    if ranks.rank == 0:
        parts = manifest["sequences"].values()
        print(f"{options.out}: {sum(p['scans'] for p in parts)} scans in {len(parts)} sequences, birds seen in "
              f"{sum(p['scans_with_birds_seen'] for p in parts)} of them; datasheet.md says more")


def track(options) -> None:
    from . import BirdTracks
    from ._ranks import Ranks
    from .apps import _pictures  # needs Matplotlib: said before the work
    _pictures.gradient()
    ranks, bars = Ranks(ends_job=True), Bars()
    changes: Dict[str, Any] = {} if options.scans is None else {"number_of_scans": options.scans}
    if options.weather:
        changes["weather"] = options.weather
    tracks = BirdTracks(options.inputs, options.runways, options.learn, options.cutoff, options.order,
                        dict(options.clutter_set), dict(options.tracker_set), options.sensor,
                        options.threads or (1 if ranks.size > 1 else 0), **changes)
    with _goes_on(options.out, "followed/*/*.json", "sequences followed"):
        card = tracks.write(options.out, ranks, (lambda *_: None) if ranks.rank else bars)
    bars.close()
    if ranks.rank == 0:
        _table([("score", *card["names"]), *((row["words"], *row["cells"]) for row in card["overall"])])
        print(f"{options.out / 'card.html'}: the report card; its tables and pictures are beside it")


def bench(options) -> None:
    from .apps import _pictures  # needs Matplotlib: said before the work
    from .apps._bench import Bench, verdict
    _pictures.gradient()
    bars = Bars()
    found = Bench(options.folders, options.predictions, options.sequences, options.first).write(options.out, bars)
    bars.close()
    for scored in found:
        print(f"{scored[0].set.name}, {scored[0].set.weather}: {verdict(scored)}")
    print(f"{options.out / 'bench.html'}: the page; its tables and pictures are beside it")


def airport(options) -> None:
    from ._disk import only_run
    from .apps._airport import Airport
    bars = Bars()
    made = Airport(options.extract, options.heights, options.icao, options.bounds, options.obstacles, bars)
    with only_run(options.out, goes_on=False):
        kept = made.write(options.out)
    bars.close()
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
    from .apps._maps import read_plan
    return read_plan(options.plan, options.weather, getattr(options, "metar", None),
                     **{part: dict(getattr(options, f"{part}_set", ())) for part in ("sensor", "coverage", "siting", "design")})


def _say_before(plan) -> None:
    if "hours" in plan.plan:
        print(plan.plan["hours"])
    if plan.above != "ground":
        below = "no surface is below the sensor" if plan.ground is None else f"the ground below the sensor is at z = {plan.ground:.4g} m"
        warn(f"heights are above the scene's origin, and {below}")


def coverage(options) -> None:
    from ._disk import only_run
    from .apps._maps import Plan
    plans = Plan.all_of(_plan(options), options.threads)
    _say_before(plans[0])
    with only_run(options.out, goes_on=len(plans) > 1):  # maps of a sensor that are whole stay
        for plan in plans:
            bars = Bars()
            folder = options.out / plan.name if len(plans) > 1 else options.out
            with only_run(folder, goes_on=False) if len(plans) > 1 else contextlib.nullcontext():
                names = plan.write(folder, lambda done, total, name=plan.name, bars=bars: bars(f"files of {name}", done, total))
            bars.close()
            row = plan.overall
            print(f"{folder}: {len(names)} files; {plan.coverage.species or 'the target'} detected in one scan: "
                  f"{row['detection_probability']:.3f} +- {row['detection_std_error']:.3f} {plan.where} (assumed: bird"
                  f"{', receiver' if plan.assumed else ''})")


def siting(options) -> None:
    from ._disk import only_run
    from ._ranks import Ranks
    from .apps import _pictures  # needs Matplotlib: said before the work
    from .apps._maps import Plan
    from .apps._sites import Sites
    _pictures.gradient()
    ranks, bars = Ranks(ends_job=True), Bars()
    plans = Plan.all_of(_plan(options), 1)
    if not ranks.rank:
        _say_before(plans[0])
    everywhere = [Sites(plan, options.out / "coverage", ranks, bars) for plan in plans]
    with _goes_on(options.out, "coverage/*.npy", "candidates kept"), only_run(options.out, ranks, goes_on=True, known=plans[0].decides):
        for number, sites in enumerate(everywhere):
            changes = list(sites.look().changes())
            bars.close()
            if not ranks.rank:
                sites.write(options.out / sites.plan.name if number else options.out, changes)
                _say_sites(sites, changes)


def _say_sites(sites, changes) -> None:
    from .apps._answer import percent
    name = sites.plan.name
    print(f"{name}: {len(sites.positions)} candidates, of {sites.lattice}, for a {sites.plan.bird} {sites.plan.where}")
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
    from ._ranks import Ranks
    from .apps import _design_page, _pictures  # needs Matplotlib: said before the work
    from .apps._maps import Plan
    _pictures.gradient()
    ranks, bars = Ranks(ends_job=True), Bars()
    plan = Plan(_plan(options), options.threads or (1 if ranks.size > 1 else 0))
    if not ranks.rank:
        _say_before(plan)
    study = _design_page.Designs(plan, options.out, ranks, bars)
    with _goes_on(options.out, "coverage/*.npy", "designs kept"):
        study.write()
    bars.close()
    if not ranks.rank:
        refused = [one.refused for one in study.candidates if one.refused]
        if refused:
            warn(f"{len(refused)} of {len(study.candidates)} designs are none, as the sensor refuses them: {refused[0]}")
        print("\n".join(_design_page.answers(study)))
        print(f"{options.out / 'design.html'}: the page; its tables and pictures are beside it")


def reach(options) -> None:
    from . import Sensor
    from .apps import reach as ranges
    from .apps._maps import write_table
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
    if options.out:
        write_table(options.out, curve)
    _table(rows)
    print(*said, sep="\n")
    print("Birds lie evenly between the lowest and the highest beam; sizes of birds are assumed. In brackets: what the fit of the receiver to its sheet leaves open.")
    if options.out:
        print(f"{options.out}: the shares by range")


def report(options) -> None:
    from .apps._report import Report
    bars = Bars()
    report = Report(_plan(options), options.threads, bars)
    _say_before(report.plans[0])
    folder = report.write(options.out)
    bars.close()
    print(f"{options.out}: the report; {folder}: its tables and pictures")
