# SPDX-License-Identifier: BSD-3-Clause
"""Writes the files of an airport from an extract of a map: the command `avianlidar airport`."""
from __future__ import annotations

import hashlib
import json
import pathlib
from typing import Any, Callable, Dict, List, Sequence, Tuple

import numpy as np

from ..._disk import write_whole
from ..._files import read_regular
from ..._pipeline import Error
from ..._scene import load_scene
from ..._writers import vtp
from ..inputs._json import load_json
from ..pages import _drawing as drawing
from ..places._gdal import quiet
from ..places._geojson import features_of, read_runways
from . import _pages as pages
from ._map import AirportMap
from ._plans import AirportScene, scene_file

WHAT = ("airport.geojson", "terrain.vtp", "airport.lidarscene.json", "exclusions.geojson", "airport.coverage.json",
        "siting.coverage.json", "airport.scenario.json", "assumed.csv", "airport.png", "README.txt")
RECORD = "made.json"  # checksums of the files when they were made


class Kept:
    """Files of a folder that are made again unless a user has edited them."""

    def __init__(self, folder: pathlib.Path):
        self.folder, self.record = folder, folder / RECORD
        self.edited: List[str] = []
        try:
            self.made = load_json(self.record) if self.record.exists() else {}
        except Error:
            self.made = None
        if not isinstance(self.made, dict) or not all(isinstance(sums, (str, list)) for sums in self.made.values()):
            raise Error(f"{self.record}: expected checksums by the names of files; choose another folder, or empty "
                        "this one to have all files made again")
        strange = [name for name in WHAT if (folder / name).exists() and name not in self.made]
        if strange:
            raise Error(f"{folder}: {strange[0]} exists and was not made by this command, as {RECORD} has no checksum "
                        "of it; choose another folder, or empty this one to have all files made again")

    def put(self, name: str, make: Callable[[], bytes]) -> pathlib.Path:
        """Makes a file unless a user has edited the file, and returns its path."""
        path = self.folder / name
        found = hashlib.sha256(read_regular(path)).hexdigest() if path.exists() else ""
        if found and found not in self.made[name]:
            if name not in self.edited:
                self.edited.append(name)
            return path
        content = make()
        # After a stop between record and file, the old file is kept; the record holds both checksums.
        self.made[name] = sorted({hashlib.sha256(content).hexdigest(), found} - {""})
        write_whole(self.record, (json.dumps(self.made, indent=2) + "\n").encode())
        write_whole(path, content)
        return path


def _json(value: Any) -> bytes:
    return (json.dumps(value, indent=2, ensure_ascii=False) + "\n").encode()


def _geojson(features: Sequence[Tuple[Dict[str, Any], Any]]) -> bytes:
    """GeoJSON with one feature in each line. @param features properties and geometries (ogr, degrees)"""
    rows = [json.dumps({"type": "Feature", "properties": properties,
                        "geometry": json.loads(shape.ExportToJson(["COORDINATE_PRECISION=9"]))}, ensure_ascii=False)
            for properties, shape in features]
    return ('{"type": "FeatureCollection", "features": [\n' + ",\n".join(rows) + "\n]}\n").encode()


def _checked_features(file: pathlib.Path, kinds: Sequence[str]) -> List[Dict[str, Any]]:
    """The features of airport.geojson; `Error` names a kind or a length that a scene cannot have."""
    features = features_of(file)
    for number, feature in enumerate(features):
        row = feature["properties"]
        if row.get("kind") not in kinds:
            raise Error(f"{file}: kind is {str(row.get('kind'))!r}, expected one of {', '.join(kinds)}")
        called = f"{row['kind']} {row.get('name') or row.get('id') or ''}".strip()
        what = f"{file}: features[{number}] ({called})"
        for name in ("height", "top", "width", "min_height"):
            value = row.get(name, 1.0)
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not (
                    (name == "min_height" and value == 0.0) or 0.0 < value <= 1e4):
                raise Error(f"{what}: {name} is {repr(value)[:40]}, expected metres above 0")
        height = row.get("height", row.get("top"))
        if height is not None and row.get("min_height", 0.0) >= height:
            raise Error(f"{what}: min_height is {row['min_height']:g} m, expected less than the height, {height:g} m")
    return features


def write(airport: AirportMap, folder) -> Tuple[Kept, AirportScene]:
    """Writes all files to an existing folder; files that a user has edited are kept. Later files follow from the
    earlier files as they are, edited or not."""
    kept = Kept(pathlib.Path(folder))
    put, progress = kept.put, airport.progress
    progress("files", 0, len(WHAT))
    heights = airport.heights()
    with quiet():
        chosen = airport.chosen(heights)
        mapped = put("airport.geojson", lambda: _geojson(airport.mapped(chosen)))
    put("terrain.vtp", lambda: vtp(heights.surface))
    ground = "heights: from the edited terrain.vtp" if "terrain.vtp" in kept.edited else heights.words
    features = _checked_features(mapped, list(airport.known["kinds"]))
    rows = [feature["properties"] for feature in features]
    scene = load_scene(put("airport.lidarscene.json", lambda: _json(scene_file(airport, rows, ground))))
    progress("files", 3, len(WHAT))
    sides = read_runways(mapped, scene.geodetic_origin)
    found = AirportScene(airport, chosen, features, ground, scene, sides)
    place = found.place_lidar(mapped, put("exclusions.geojson", lambda: _geojson(found.exclusions())))
    put("airport.lidarscene.json", lambda: _json(scene_file(airport, rows, ground, place.position)))
    put("airport.coverage.json", lambda: _json(found.plan(place)))
    put("siting.coverage.json", lambda: _json(found.plan(place, siting_too=True)))
    put("airport.scenario.json", lambda: _json(found.scenario(place)))
    put("assumed.csv", lambda: pages.assumed(found))
    progress("files", 8, len(WHAT))
    lengths = np.diff(np.reshape(airport.rectangle, (2, 2)))[:, 0]
    wide, high = np.maximum(9.0 * lengths / lengths.max(), 3.0) + (2.0, 0.5)  # inches
    put("airport.png", lambda: drawing.drawn((wide, high), lambda axes: pages.draw(axes, found, place)))
    put("README.txt", lambda: pages.readme(found, place))
    progress("files", len(WHAT), len(WHAT))
    return kept, found
