# SPDX-License-Identifier: BSD-3-Clause
"""Files of plans of coverage, of scenarios of labelled sequences, and of manifests of sequences."""
from __future__ import annotations

import pathlib
from typing import Any, Callable, Dict, Mapping, Optional, Sequence, Union

from ... import vtkAvianLidar as _wrapped
from ..._files import checked_name
from ..._pipeline import Error
from ..._properties import in_snake_case, property_names, unknown
from ..._weather import in_weather, weather, without_air
from . import _metar
from ._json import check_json, load_json, naming, packaged
from ._on_sale import PLACE

SUM = 1e-6  # allowed difference of a year's shares from the sum 1


def read_plan(file, words: Optional[Sequence[str]] = None, metar=None, **changes: Dict[str, Any]) -> Dict[str, Any]:
    """A plan of coverage (JSON, `coverage.schema.json`), with the plan's file name as `file` and the changes as
    `options`; `Error` names the wrong part. File names in the plan become absolute.

    words    words of weather that replace the plan's weather, its year and the air in its `coverage`
    metar    file of reports that replaces the plan's year
    changes  parts of the plan, such as `sensor`, each with values to add
    """
    path = pathlib.Path(file)
    plan = load_json(path)
    if isinstance(plan, dict):
        plan = {name: part for name, part in plan.items() if not (words or metar) or name not in ("year", "metar")}
        if words:
            plan["weather"] = list(words)
            if isinstance(plan.get("coverage"), dict):
                plan["coverage"] = without_air(plan["coverage"])
        if metar:
            plan["metar"] = str(pathlib.Path(metar).resolve())
        for part, values in changes.items():
            if values and isinstance(plan.get(part, {}), dict):
                plan[part] = {**plan.get(part, {}), **{name: _in_plan(name, value) for name, value in values.items()}}
    check_json(plan, "coverage.schema.json", str(file))

    def from_here(name: Any) -> Any:
        return str((path.parent / name).resolve()) if isinstance(name, str) else [*map(from_here, name)]

    def sensor(given: Union[str, Dict[str, Any]], what: str) -> Dict[str, Any]:
        with naming(f"{file}: {what}"):
            given = {"preset": given} if isinstance(given, str) else given
            known = in_snake_case(_wrapped.vtkAvianLidarBeamSource, given, "Sensor")
            if known["preset"].endswith(".json"):
                known["preset"] = from_here(known["preset"])
        sensor_name(known, f"{file}: {what}")
        return known

    with naming(f"{file}: coverage"):
        if "coverage" in plan:
            plan["coverage"] = in_snake_case(_wrapped.vtkAvianLidarCoverage, plan["coverage"], "Coverage")
    plan["sensor"] = sensor(plan["sensor"], "sensor")
    plan["compare_with"] = [sensor(other, f"compare_with[{i}]") for i, other in enumerate(plan.get("compare_with", ()))]
    if "siting" in plan:
        if "runways" not in plan:
            raise Error(f"{file}: siting: needs runways")
        plan["siting"].setdefault("exclusions", [])
    for member in ("scene", "runways", "metar", "tracks", "design.scenario", "siting.exclusions", "siting.points"):
        of, _, name = member.rpartition(".")
        holder = plan.get(of, {}) if of else plan
        if name in holder:
            with naming(f"{file}: {member}"):
                holder[name] = from_here(holder[name])
    _check_question(plan, str(file))
    if "metar" in plan:
        with naming(f"{file}: metar"):
            hours = _metar.read_metar(plan["metar"])
            plan.update(year=hours.year(), hours=hours.words())
    options = [["--weather", *words]] if words else []
    if metar:
        options.append(["--metar", str(metar)])
    options += [[f"--{part}-set", f"{name}={_as_option(value)}"]
                for part, values in changes.items() for name, value in (values or {}).items()]
    return {**plan, "file": str(file), "options": options}


def _in_plan(name: str, value: Any) -> Any:
    """A setting as a plan holds it: several values, or a member that may have several, as a list."""
    if isinstance(value, (tuple, list)):
        return list(value)
    return [value] if name in ("masts", "exclusions") else value


def _as_option(value: Any) -> str:
    """A value as an option of a command."""
    if isinstance(value, (list, tuple)):
        return ",".join(map(_as_option, value))
    if isinstance(value, bool):
        return "on" if value else "off"
    return str(value)


def _check_question(plan: Dict[str, Any], file: str) -> None:
    """`Error` if parts of a plan contradict each other about birds, places or weather."""
    if "regions" in plan and "runways" not in plan:
        raise Error(f"{file}: regions: needs runways")
    with naming(f"{file}: weather"):
        in_weather(plan.get("coverage", {}), plan.get("weather"))
    for number, part in enumerate(plan.get("year", ())):
        with naming(f"{file}: year[{number}].weather"):
            weather(part["weather"])
    if "year" in plan and "metar" in plan:
        raise Error(f"{file}: metar: is given beside 'year', expected only one of them")
    total = sum(part["share"] for part in plan.get("year", ()))
    if "year" in plan and not abs(total - 1.0) <= SUM:
        raise Error(f"{file}: year: shares sum to {total:g}, expected 1")
    if "species" in plan.get("coverage", {}) and "mix" in plan:
        raise Error(f"{file}: coverage.species: is given beside 'mix', expected only one of them")


def sensor_name(sensor: Mapping[str, Any], what: str = "sensor") -> str:
    """The name of a sensor in files and reports: `name`, else the name of the preset; with "changed" if more than place
    and orientation are set. @param what the sensor's member of a plan"""
    preset = pathlib.Path(sensor["preset"]).name.split(".lidarsensor")[0]
    changed = any(name not in ("preset", *PLACE) for name in sensor)
    return checked_name(sensor.get("name", f"{preset} changed" if changed and preset else preset), f"{what}.name")


# Classes whose properties the parts of a scenario name.
PROPERTIES = {"sensor": _wrapped.vtkAvianLidarBeamSource, "scan": _wrapped.vtkAvianLidarEchoFilter,
              "birds": _wrapped.vtkAvianLidarTracks}


def checked(scenario: Any, what: str) -> Dict[str, Any]:
    """A scenario with properties in snake case, as the schema requires. @param what its file, for errors"""
    def here(wrapped: type, value: Any, part: str) -> Any:
        if isinstance(value, list):
            return [here(wrapped, one, f"{part}[{place}]") for place, one in enumerate(value)]
        return in_snake_case(wrapped, value, part) if isinstance(value, dict) else value
    if isinstance(scenario, dict):
        with naming(what):
            scenario = {**scenario, **{part: here(wrapped, scenario[part], part)
                                       for part, wrapped in PROPERTIES.items() if part in scenario}}
        _check_groups(scenario.get("birds"), what)
    check_json(scenario, "scenario.schema.json", what)
    return scenario


def _check_groups(groups: Any, what: str) -> None:
    """`Error` for a key of a group of birds that is not known, or that only groups with a file have."""
    keys = packaged("inputs/scenario.schema.json")["properties"]["birds"]["items"]["properties"]
    names = property_names(_wrapped.vtkAvianLidarTracks)
    known = [name for name in dict.fromkeys((*names, *keys)) if keys.get(name) != {"not": {}}]
    for place, group in enumerate(groups if isinstance(groups, list) else ()):
        for name in group if isinstance(group, dict) else ():
            if name not in known and name not in keys:
                raise Error(unknown(f"{what}: birds[{place}]: key", name, known))
            if name in keys and name not in names and group.get("pattern", "File") != "File":
                raise Error(f"{what}: birds[{place}].{name}: is only for groups with the pattern File")


def with_files(scenario: Dict[str, Any], change: Callable[[str], str]) -> Dict[str, Any]:
    """The scenario with other names of the files that it needs."""
    preset = scenario["sensor"]["preset"]
    birds = [{**group, **{name: change(group[name]) for name in ("file_name", "species_file_name") if name in group}}
             for group in scenario.get("birds", ())]
    if "trajectory" in scenario:
        line = scenario["trajectory"]
        scenario = {**scenario, "trajectory": {**line, "file_name": change(line["file_name"])}}
    return {**scenario, "scene": change(scenario["scene"]), "birds": birds,
            "sensor": {**scenario["sensor"], "preset": change(preset) if preset.endswith(".json") else preset}}


def read_scenario(file) -> Dict[str, Any]:
    """A scenario file, or that of a manifest; `Error` names the wrong part. File names become absolute."""
    path = pathlib.Path(file)
    scenario = load_json(path)
    if isinstance(scenario, dict) and "sequences" in scenario:
        scenario = scenario.get("scenario")  # a manifest
    scenario = checked(scenario, str(file))
    with naming(str(file)):
        return with_files(scenario, lambda name: str((path.parent / name).resolve()))


def read_manifest(folder, others: str = "") -> Dict[str, Any]:
    """The manifest of a folder of sequences. @param others words for other allowed inputs"""
    file, made = pathlib.Path(folder) / "manifest.json", "a folder that `avianlidar sequence` has made"
    if not file.is_file():
        raise Error(f"{folder}: holds no manifest.json, expected {made}{others}")
    manifest = load_json(file)
    parts = manifest.get("sequences") if isinstance(manifest, dict) else None
    if not isinstance(parts, dict) or not parts or not all(isinstance(part, dict) for part in parts.values()):
        raise Error(f"{file}: names no sequences, expected the manifest of {made}")
    if not isinstance(manifest.get("scenario"), dict):
        raise Error(f"{file}: holds no scenario, expected the manifest of {made}")
    return manifest
