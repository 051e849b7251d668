# SPDX-License-Identifier: BSD-3-Clause
"""The verbs of the command `avianlidar`. A function imports modules of `apps` that only some verbs need."""
import glob
import pathlib
import textwrap
import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from . import Cloud, Scan, Scene, Sensor, _display, _scene, _sheet, load_cloud, load_clouds, save
from . import vtkAvianLidar as _wrapped
from ._advice import check_suffix as check_advice
from ._advice import notes_of, table_rows, to_act_on
from ._bags import SUFFIXES
from ._cloud import add_array, vertices
from ._disk import only_run, replacing, write_whole
from ._numbers import figures
from ._pipeline import update
from ._sight import extent, of_scene
from ._suffixes import OF_SENSOR, PACKETS, POINTS
from ._terminal import bar, close_bar, table, tell, warn
from ._waveforms import WAVEFORMS
from ._weather import weather
from ._writers import check_suffix, check_target, refuse
from .apps._studies import airport, bench, coverage, design, reach, report, sequence, siting, track  # noqa: F401 verbs
from .apps.inputs._air import check_received
from .apps.inputs._read import read_plan, read_scenario
from .apps.sequences._trajectory import MARKUP, read_trajectory, settings_of

OUTSIDE = 0.1  # share of recorded points outside all beams from which on the sensor is doubtful
WIDTH = 110  # characters of a line about one sensor


def _check_outs(options, check: Callable[[pathlib.Path], None]) -> None:
    """Raises errors of output names before the work starts. @param check function that checks the suffix"""
    for number, out in enumerate(options.out):
        check(out)
        if out.suffix.lower() == ".png":
            import matplotlib
            matplotlib.use("Agg")
        check_target(out, [*options.out[:number], pathlib.Path(options.scene)])


def _unreturned(cloud) -> dict[str, np.ndarray]:
    """Whether each point is no echo of a surface, by words for the kind of points."""
    kinds: dict[str, np.ndarray] = {}
    if "object_id" in cloud:
        kinds = {"false alarms of the noise (object_id -1)": cloud["object_id"] == -1,
                 "echoes of the air (object_id -2)": cloud["object_id"] == -2}
    elif "classification" in cloud:  # of LAS
        kinds = {"noise (classification 7 or 18)": np.isin(cloud["classification"], (7, 18))}
    return {words: points for words, points in kinds.items() if points.any()}


def _alarms(cloud) -> str:
    """Words on the number of echoes that come from no surface."""
    return "".join(f", {points.sum()} of them {words}" for words, points in _unreturned(cloud).items())


def _percent_of(what: str) -> Callable[[float, str], None]:
    """A progress function for a bar."""
    return lambda share, _: bar(what, round(100 * share), 100)


def _scan_of(options) -> Scan:
    """The scan that the options describe."""
    scene = Scene(options.scene, material=options.material, scale=options.scale, up_axis=options.up_axis,
                  progress=_percent_of("scene"))
    line = read_trajectory(options.trajectory, scene, **settings_of(options.trajectory_set)) if options.trajectory else None
    place = options.position or (None if line else scene.lidar_position) or (0, 0, 0)
    sensor = Sensor(options.sensor, position=place, trajectory=line)
    scan = Scan(scene, sensor.set(**dict(options.sensor_set)), progress=_percent_of(options.verb))
    preset = getattr(options, "preset", None)
    if preset:
        scan.preset = preset
        scene.tree.SetPreset(preset == "Paper")
    scan.set(**{"number_of_threads": options.threads, **weather(options.weather), **dict(options.scan_set)})
    check_received(scan, options.sensor, "--sensor Search905")
    return scan


def _say_place(options, scan: Scan) -> None:
    """Prints where the lidar stands, what placed it there, and what the scene leaves out or assumes."""
    place, known = scan.sensor.position, scan.scene.lidar_position
    if options.trajectory:
        tell("the lidar is at ({:.10g}, {:.10g}, {:.10g}) m when the scan begins, as --trajectory and --position say"
             .format(*scan.sensor.beams.fields["position"]), *_display.scene_notes(scan.scene))
        return
    why = "as --sensor-set says"
    if place == tuple(options.position or known or (0, 0, 0)):
        why = ("as --position says" if options.position else "as the scene file says" if known else
               "the default; --position X Y Z moves it")
    tell("the lidar stands at ({:.10g}, {:.10g}, {:.10g}) m, ".format(*place) + why)
    tell(*_display.scene_notes(scan.scene))


def scan(options) -> None:
    _check_outs(options, lambda out: check_suffix(out, (".png",)))
    for number, file in enumerate(options.waveforms):
        if file.suffix.lower() not in WAVEFORMS:
            raise refuse("write waveforms to", file, list(WAVEFORMS))
        check_target(file, [*options.out, *options.waveforms[:number], pathlib.Path(options.scene)])
    if options.beam is not None and not any(file.suffix.lower() == ".png" for file in options.waveforms):
        raise ValueError(f"--beam {options.beam} is the beam of a picture, expected --waveforms FILE.png")
    scan = _scan_of(options)
    scan.record_waveforms = scan.record_waveforms or bool(options.waveforms)
    for out in options.out:
        if out.suffix.lower() == ".geojson" and not scan.scene.geodetic_origin:
            raise ValueError(f"{out}: GeoJSON needs longitude and latitude, and the scene has no origin on the Earth")
    if not options.quiet:
        _say_place(options, scan)
    echoes = scan.echoes.annotated()
    if options.beam is not None:
        scan.waveforms.check(options.beam)
    for out in options.out:
        if out.suffix.lower() == ".png":
            with replacing(out) as name:
                scan.plot_range_image("energy").figure.savefig(name, format="png", dpi=150)
        else:
            save(echoes, out)
        text = f"{out}: {echoes.number_of_points} echoes of {scan.report.number_of_points} beams{_alarms(echoes)}"
        tell(text + (f", labels in {out.with_suffix('.label').name}" if out.suffix.lower() == ".bin" else ""))
    for file in options.waveforms:
        _write_waveforms(scan, file, options.beam)
    if not options.quiet:
        tell(*to_act_on(echoes.fields))


def _write_waveforms(scan: Scan, file: pathlib.Path, beam: int | None) -> None:
    import matplotlib
    matplotlib.use("Agg")
    waveforms = scan.waveforms
    if file.suffix.lower() == ".png":
        beam = waveforms.strongest().beam_id if beam is None else beam
        waveforms.save(file, beam_id=beam)
        tell(f"{file}: the waveform of beam {beam}, one of {len(np.unique(waveforms.beam_ids))}")
        return
    waveforms.save(file, scan.echoes if file.suffix.lower() == ".las" else None)
    tell(f"{file}: waveforms of {len(np.unique(waveforms.beam_ids))} beams, {waveforms.number_of_stretches} stretches "
         f"with {waveforms.number_of_points} samples in all")


def advise(options) -> None:
    _check_outs(options, check_advice)
    scan = _scan_of(options)
    _say_place(options, scan)
    advice = scan.advise(options.energy, options.range, options.missed, options.beams)
    table(table_rows(advice))
    tell(advice)
    for out in options.out:
        advice.save(out)
        tell(f"{out}: the advice")


def _of_packets(options, *files) -> dict[str, Any]:
    """The options that choose packets, by name."""
    chosen = {name: getattr(options, name) for name in ("time", "sensor_address") if getattr(options, name) is not None}
    for name, value in chosen.items():
        if not any(file.suffix.lower() in PACKETS for file in files):
            raise ValueError(f"--{name.replace('_', '-')} {value} chooses packets, expected a file "
                             f"{' or '.join(PACKETS)}, got {files[0]}")
    return chosen


def _cloud(file, chosen: dict[str, Any]):
    """A cloud, in the scene's frame if the file gives the frame. @param chosen options for packets"""
    if file.suffix.lower() in (".las", ".laz"):
        return load_cloud(file, local_coordinates=True)
    return load_cloud(file, **chosen if file.suffix.lower() in PACKETS else {})


def _has_points_only(file: pathlib.Path) -> bool:
    """Whether a file holds points and no triangles."""
    suffix = file.suffix.lower()
    if suffix == ".ply":
        with open(file, "rb") as stream:
            header = stream.read(65536).partition(b"end_header")[0]
        return not any(line.split()[1:2] == [b"face"] and line.split()[2:] != [b"0"] for line in header.splitlines())
    return suffix in POINTS or suffix == ".vtp" and not load_cloud(file).data.GetNumberOfPolys()


def _words(value: Any) -> str:
    """A value of a file or of field data in words for a user."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_words(part)}" for key, part in value.items())
    parts = value.tolist() if hasattr(value, "tolist") else value
    if not isinstance(parts, (list, tuple)):
        return str(parts)
    return ", ".join(f"{part:.10g}" if isinstance(part, float) else str(part) for part in parts)


def _say_cloud(file: pathlib.Path, cloud: Cloud, quiet: bool) -> None:
    tell(f"{file}: a cloud of {cloud.number_of_points} points{_alarms(cloud)}")
    if not cloud.number_of_points:
        return
    fields = cloud.fields
    bounds = cloud.data.GetBounds()
    known = {"extent": _words(bounds) if "crs_wkt" in fields else extent(bounds)}
    if file.suffix.lower() in OF_SENSOR:
        known["frame"] = "of the sensor: right, forward and up for east, north and up"
    known.update((name, f"{_words(fields[name])} {cloud.field_units[name]}")
                 for name in ("geodetic_origin", "position", "crs_wkt") if name in fields)
    table(known.items())
    rows: list[tuple[Any, ...]] = [("array", "unit", "least", "greatest")]
    for name, values in cloud.items():
        finite = values[np.isfinite(values)] if np.isfinite(values).any() else np.array([np.nan])
        rows.append((name, cloud.units[name] or "-", figures(finite.min()), figures(finite.max())))
    table(rows)
    if not quiet:
        table(notes_of(fields))


def _say_recording(options) -> None:
    """Prints what a recording holds. All scans are read."""
    recording = load_clouds(str(options.file), options.rate, options.topic, options.sensor_address)
    gaps = np.diff(recording.times)
    counts: list[int] = []
    ranges: dict[str, tuple[Any, Any, str]] = {}
    for number, cloud in enumerate(recording):
        counts.append(cloud.number_of_points)
        for name, values in cloud.items():
            finite = values[np.isfinite(values)]
            if finite.size:
                low, high, _ = ranges.get(name, (np.inf, -np.inf, ""))
                ranges[name] = min(low, finite.min()), max(high, finite.max()), cloud.units[name]
        bar("scans read", number + 1, len(recording))
    close_bar()
    tell(f"{options.file}: a recording of {len(recording)} scans")
    rows = {"times from": recording.times_from, "frame": recording.frame,
            "points a scan": f"{min(counts)} to {max(counts)}, {np.mean(counts):.1f} on average"}
    if len(gaps):
        middle = np.median(gaps)
        rows["duration"] = f"{recording.times[-1] - recording.times[0]:.6g} s, from {recording.times[0]:.10g} s on"
        rows["rate"] = f"{1.0 / middle:.4g} Hz"
        rows["gaps"] = f"{(gaps > 1.5 * middle).sum()} longer than 1.5 scans, the longest {gaps.max():.4g} s"
    place = recording.pose(0)[:, 3]
    rows["pose"] = "none" if recording.poses is None else (
        f"the sensor {'moves' if recording.moves else 'stands still'}, at first at ({_words(place)}) m")
    table(rows.items())
    table([("array", "unit", "least", "greatest"),
           *((name, unit or "-", figures(low), figures(high)) for name, (low, high, unit) in ranges.items())])


def info(options) -> None:
    file, name = options.file, options.file.name.lower()
    if file.is_dir() or file.suffix.lower() in SUFFIXES or not file.exists() and glob.has_magic(str(file)):
        _say_recording(options)
        return
    for option in ("rate", "topic"):
        if getattr(options, option) is not None:
            raise ValueError(f"--{option} is for recordings, expected none for {file}")
    if not file.exists():
        raise FileNotFoundError(f"no such file: {file}")
    if file.suffix.lower() in MARKUP:
        raise ValueError(f"{file}: is a trajectory, expected it as --trajectory of scan, advise, sequence or coverage")
    chosen = _of_packets(options, file)
    hints: Iterable[str] = ()
    notes: Iterable[str] = ()
    if name.endswith(".lidarsensor.json"):
        what, rows = "a sensor", _display.sensor_rows(Sensor(file))
    elif name.endswith(".coverage.json"):
        plan, what = read_plan(file), "a plan of coverage"
        rows = {key: plan[key] for key in ("scene", "sensor", "compare_with", "coverage", "weather", "mix", "heights",
                                           "regions", "spread", "runways", "siting", "design") if plan.get(key)}
        if "year" in plan:
            rows["year"] = "; ".join(f"{', '.join(part['weather']) or 'as in coverage'} {100 * part['share']:.3g} %"
                                     for part in plan["year"])
    elif name.endswith(".json") and not name.endswith(".lidarscene.json"):
        scenario, what = read_scenario(file), "a scenario of sequences"
        rows = {key: scenario[key] for key in ("scene", "sensor", "weather", "number_of_scans") if key in scenario}
    elif _has_points_only(file):
        _say_cloud(file, _cloud(file, chosen), options.quiet)
        return
    else:
        scene, what = Scene(file), "a scene"
        rows, notes = _display.scene_rows(scene), _display.scene_notes(scene)
        hints = of_scene(scene.bounds) if scene.number_of_triangles else ()
    tell(f"{file}: {what}")
    table((key, _words(value)) for key, value in rows.items())
    tell(*notes)
    for text in hints:
        warn(text)


def view(options) -> None:
    if options.out.suffix.lower() != ".html":
        raise ValueError(f"{options.out}: expected a name that ends in .html")
    check_target(options.out, [pathlib.Path(options.scene), *options.echoes])
    from .apps.view import _view
    scene = Scene(options.scene, progress=_percent_of("scene"))
    clouds = [(file.name, _cloud(file, {})) for file in options.echoes]
    content = _view.page(scene, pathlib.Path(options.scene).name.partition(".")[0], clouds, options.sequence,
                         _view.maps_in(options.coverage) if options.coverage else (), options.tracks)
    _view.write(options.out, content)
    tell(f"{options.out}: {scene.number_of_triangles} triangles, {sum(cloud.number_of_points for _, cloud in clouds)} "
         f"echoes, {len(content) / 1e6:.1f} MB; any browser opens the page")


def _compared(*clouds) -> Any:
    """The comparison of two point sets of VTK."""
    measure = _wrapped.vtkAvianLidarCloudComparison()
    for port, cloud in enumerate(clouds):
        measure.SetInputDataObject(port, cloud)
    update(measure, _percent_of("compare"))
    return measure


def _say_apart(files, clouds) -> None:
    """Warns about clouds whose boxes overlap by less than a hundredth. Flat boxes may be a hundredth of the size
    apart."""
    boxes = np.array([cloud.data.GetBounds() for cloud in clouds]).reshape(2, 3, 2)
    sizes = boxes[:, :, 1] - boxes[:, :, 0]
    size, least = np.linalg.norm(sizes, axis=1).max(), sizes.min(axis=0)
    gaps = boxes[:, :, 0].max(axis=0) - boxes[:, :, 1].min(axis=0)
    if (gaps > np.where(least < 0.01 * size, 0.01 * size, -0.01 * least)).any():
        where = ", but ".join(f"{file.name} extends {extent(box.ravel())}" for file, box in zip(files, boxes))
        warn(f"the clouds do not overlap: {where}: if one is in coordinates of a map, such as UTM, or in the frame of "
             "its sensor, move it into the frame of the other first")


_OF_SCENES = ("sensor", "position", "heading", "align", "scans", "rate", "topic")


def _compare_scene(options) -> None:
    """Compares a recording with the simulation of a scene."""
    from .apps.pages import _drawing
    from .apps.sequences._compared import Comparison
    if not options.out or options.out.suffix:
        raise ValueError(f"-o is {options.out}, expected a folder for the page that compares {options.b} with {options.a}")
    if not options.sensor:
        raise ValueError(f"compare: {options.a} is a scene, expected --sensor, the lidar that recorded {options.b}")
    _drawing.require()
    recording = load_clouds(str(options.b), options.rate, options.topic)
    if recording.moves:
        warn(f"{options.b}: the sensor moves, but all scans are compared with one simulated scan, at the first pose")
    scene = Scene(options.a, progress=_percent_of("scene"))
    compared = Comparison(scene, recording, Sensor(options.sensor), options.position, options.heading, options.align,
                          options.scans, bar)
    found = compared.write(options.out)
    close_bar()
    if found["outside"] > OUTSIDE:
        warn(f"{100 * found['outside']:.0f} % of the points lie in no beam of {options.sensor}: probably another lidar has "
             "recorded them, or it is turned")
    tell(f"the sensor stands at {compared.pose.words()}", *filter(None, [compared.change]), compared.sentence(found),
         f"{options.out / 'compare.html'}: the page; its tables are beside it")


def compare(options) -> None:
    files = options.a, options.b
    if options.a.is_file() and options.a.suffix.lower() not in SUFFIXES and not _has_points_only(options.a):
        _compare_scene(options)
        return
    for name in _OF_SCENES:
        if getattr(options, name):
            raise ValueError(f"--{name} is for a scene and a recording, but {options.a} is no scene")
    if options.out:
        check_suffix(options.out)
        check_target(options.out, files)
    chosen = _of_packets(options, *files)
    clouds = [_cloud(file, chosen) for file in files]
    of_sensor = [file.suffix for file in files if file.suffix.lower() in OF_SENSOR]
    if len(of_sensor) == 1:
        warn(f"a {of_sensor[0]} file is in the frame of its sensor, but the other file is not")
    ways = "SimulatedToReference", "ReferenceToSimulated"
    measure = _compared(*(cloud.data for cloud in clouds))
    _say_apart(files, clouds)
    a, b = (file.name for file in files)
    shares = 25, 50, 75, 95, 99
    limits = np.array([np.percentile(Cloud(measure.GetOutputDataObject(port))["nearest_distance"], shares)
                       for port in range(2)])
    table([("distance of nearest points (m)", f"{a} to {b}", f"{b} to {a}"),
            *(("median" if share == 50 else f"{share} % are within", *map(figures, pair))
              for share, pair in zip(shares, limits.T)),
            *((words, *(figures(getattr(measure, f'Get{name}{way}')()) for way in ways)) for words, name in (
                ("root mean square", "RMSE"), ("largest", "Hausdorff"),
                ("density-aware Chamfer distance (1)", "DensityAwareChamfer"))),
            ("number of points", *(cloud.number_of_points for cloud in clouds))])
    tell(f"Hausdorff distance: {figures(measure.GetHausdorffDistance())} m")
    alarms = [f"{file.name} has {cloud.number_of_points} echoes{_alarms(cloud)}"
              for file, cloud in zip(files, clouds) if _alarms(cloud)]
    if alarms:
        text = f"All numbers above count echoes that no surface has returned: {'; '.join(alarms)}."
        left = [cloud.points[~np.any([*_unreturned(cloud).values(), np.zeros(cloud.number_of_points, bool)], axis=0)]
                for cloud in clouds]
        if all(map(len, left)):
            distance = _compared(*map(vertices, left)).GetHausdorffDistance()
            text += f" Without these echoes the Hausdorff distance is {figures(distance)} m."
        tell(text)
    tell(f"density-aware Chamfer distance: {figures(measure.GetDensityAwareChamferDistance())} "
          f"(alpha = {measure.GetChamferAlpha():g} 1/m)")
    if options.out:
        save(Cloud(measure.GetOutputDataObject(0)), options.out)
        tell(f"{options.out}: {a} with nearest_distance (m)")


def _convert_recording(options) -> None:
    """Writes the scans of a recording as numbered files and times.txt."""
    if options.out.is_dir() and any(options.out.iterdir()):
        raise ValueError(f"{options.out}: is not empty, expected a new folder for the scans")
    recording = load_clouds(str(options.file), options.rate, options.topic, options.sensor_address)
    with only_run(options.out, goes_on=False):
        for number, cloud in enumerate(recording):
            save(cloud, options.out / f"{number:06d}.pcd")
            bar("scans written", number + 1, len(recording))
        write_whole(options.out / "times.txt", "".join(f"{time:.9f}\n" for time in recording.times).encode())
    close_bar()
    tell(f"{options.out}: {len(recording)} scans of {options.file}, and times.txt; times from: {recording.times_from}")
    if recording.poses is not None:
        warn(f"{options.file}: its poses are not in {options.out}, whose scans are in the frame {recording.frame}")


def convert(options) -> None:
    chosen = _of_packets(options, options.file)
    if options.out.suffix.lower() in (".mcap", ".db3"):
        if options.position:
            raise ValueError("--position is for one cloud, expected none for a sequence: its poses are in poses.txt")
        check_target(options.out)
        from .apps.sequences import _rosbag
        tell(f"{options.out}: {_rosbag.write(options.file, options.out)} scans of {options.file}")
        return
    if not options.out.suffix:
        _convert_recording(options)
        return
    if options.file.is_dir() or options.file.suffix.lower() in SUFFIXES:
        raise ValueError(f"{options.out}: expected a folder for the scans of the recording {options.file}, or .mcap or .db3 "
                         "for a sequence")
    check_suffix(options.out)
    check_target(options.out)
    cloud = _cloud(options.file, chosen)
    if options.position:
        add_array(cloud.data.GetFieldData(), "position", np.array(options.position), "m")
    save(cloud, options.out)
    tell(f"{options.out}: {cloud.number_of_points} points of {options.file}")


def sensors(options) -> None:
    if options.fit:
        if options.name:
            raise ValueError(f"sensors: {options.name} and --fit {options.fit}, expected only one of them")
        _fit(options)
        return
    if options.out:
        raise ValueError(f"sensors: -o {options.out} is the file of a fitted sensor, expected --fit FILE as well")
    if options.name:
        rows = _display.sensor_rows(Sensor(options.name))
        width = max(map(len, rows)) + 2
        for key, value in rows.items():
            tell(*textwrap.wrap(f"{key:<{width}}{value}", WIDTH, subsequent_indent=" " * width, break_long_words=False,
                                break_on_hyphens=False))
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about sensors that the user has not chosen
        all_rows = {name: _display.sensor_rows(Sensor(name)) for name in Sensor.presets()}
    keys = [key for key in next(iter(all_rows.values())) if key not in ("position", "what")]
    table([("name", *keys), *((name, *(rows.get(key, "") for key in keys)) for name, rows in all_rows.items())])


def _fit(options) -> None:
    if options.out:
        check_target(options.out)
    sensor = Sensor(options.fit)
    description = sensor.description
    found = sensor.fit()
    rows = [("reflectance", "light (klx)", "probability", "range of the data sheet (m)", "fitted range (m)", "error",
             "error if left out", "source")]
    for point, *fitted in zip(description["sheet"]["points"], found.predicted, found.residuals, found.left_out):
        predicted, off, left = fitted
        probability = f"{point['probability']:g}" if "probability" in point else f"{_sheet.HALF:g}, assumed"
        rows.append((f"{point['reflectance']:g}", f"{point.get('light', 0):g}", probability, f"{point['range']:g}",
                     f"{predicted:.1f}", f"{100 * off:+.1f} %", "-" if np.isnan(left) else f"{100 * left:+.1f} %",
                     point["source"]))
    table(rows)
    numbers = [f"{name} {value:.4g}" for name, value in found.numbers.items()]
    if not np.isnan(found.board):
        numbers.append(f"board of the maker {found.board:.3g} m")
    tell(", ".join(numbers))
    if found.limit:
        tell(found.limit)
    tell("the error of ranges by this receiver is unknown: no point can be left out of the fit" if np.isnan(found.bar)
         else f"ranges by this receiver have an error of about {100 * found.bar:.0f} %")
    if options.out:
        _sheet.write(description, found, options.out)
        tell(options.out)


def materials(_) -> None:
    known = _wrapped.vtkAvianLidarMaterial
    sources = {known.GetMaterialName(i): known.GetMaterialSource(i) for i in range(100)}
    table([("name", *_scene.COEFFICIENTS, "source"),
           *((name, *map("{:g}".format, values), sources[name]) for name, values in _scene.materials().items())])
