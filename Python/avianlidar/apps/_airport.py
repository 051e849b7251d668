# SPDX-License-Identifier: BSD-3-Clause
"""Makes a scene, plans and a scenario of an airport from an extract of a map: the command `avianlidar airport`."""
from __future__ import annotations

import collections
import hashlib
import json
import pathlib
import re
from typing import Any, Callable, Counter, Dict, Iterator, List, Sequence, Tuple

import numpy as np

from .._cloud import field_values, leaves_of, triangles_of
from .._disk import write_whole
from .._files import read_regular
from .._pipeline import Error
from .._scene import Scene, load_scene
from .._writers import as_csv, vtp
from . import _pictures
from ._airport_map import AirportMap
from ._candidates import ground_of
from ._extract import CUT, UNKNOWN
from ._gdal import quiet
from ._geojson import features_of, read_runways
from ._ground import terrain
from ._json import load_json
from ._regions import ends_of

WHAT = ("airport.geojson", "terrain.vtp", "airport.lidarscene.json", "exclusions.geojson", "airport.coverage.json",
        "siting.coverage.json", "airport.scenario.json", "assumed.csv", "airport.png", "README.txt")
RECORD = "made.json"  # checksums of the files when they were made
PARTS = {"grass": ("#cfe3b8", 1), "water": ("#7fb2d6", 2), "parking": ("#a5a5a5", 2), "road": ("#8c8c8c", 3),
         "apron": ("#b0aca4", 4), "taxiway": ("#666666", 5), "runway": ("#333333", 6), "vegetation": ("#4c8c4a", 7),
         "tree": ("#4c8c4a", 8), "terminal": ("#c0392b", 8), "hangar": ("#8e44ad", 8), "tower": ("#e67e22", 8),
         "mast": ("#e67e22", 8), "pole": ("#e67e22", 8), "fence": ("#000000", 8),
         "structure": ("#8e6d4f", 8)}  # classes in the picture: colour, and drawing order from below
BUILDING = ("#a0522d", 8)


class Kept:
    """Files of a folder that are made again unless a user has edited them."""

    def __init__(self, folder: pathlib.Path):
        self.folder, self.record = folder, folder / RECORD
        self.edited: List[str] = []
        self.made = load_json(self.record) if self.record.exists() else {}
        if not isinstance(self.made, dict) or not all(isinstance(sums, (str, list)) for sums in self.made.values()):
            raise Error(f"{self.record}: expected checksums by the names of files; "
                        "remove this file to have all files made again")
        strange = [name for name in WHAT if (folder / name).exists() and name not in self.made]
        if strange:
            raise Error(f"{folder}: {strange[0]} exists and was not made by this command; choose another folder")

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


class Airport(AirportMap):
    """The files that are made from an extract."""

    def write(self, folder) -> Kept:
        """Writes all files to an existing folder; files that a user has edited are kept."""
        kept = Kept(pathlib.Path(folder))
        put = kept.put
        self.progress("files", 0, len(WHAT))
        posts = self.posts()
        with quiet():
            chosen = self.chosen(*posts)
            mapped = put("airport.geojson", lambda: _geojson(self.mapped(chosen)))
        put("terrain.vtp", lambda: vtp(terrain(*posts, self.origin, self.error)))
        if "terrain.vtp" in kept.edited:
            self.terrain_words = "heights: from the edited terrain.vtp"
        self.rows = [feature["properties"] for feature in features_of(mapped)]
        for number, row in enumerate(self.rows):
            if row.get("kind") not in self.known["kinds"]:
                raise Error(f"{mapped}: kind is {str(row.get('kind'))!r}, "
                            f"expected one of {', '.join(self.known['kinds'])}")
            for name in ("height", "top", "width"):
                if name in row and (not isinstance(row[name], (int, float)) or not 0.0 < row[name] <= 1e4):
                    raise Error(f"{mapped}: features[{number}] ({row['kind']} {row.get('id', '')}): {name} is "
                                f"{row[name]!r}, expected metres above 0")
        self.scene = load_scene(put("airport.lidarscene.json", lambda: _json(self.scene_of())))
        self.progress("files", 3, len(WHAT))
        self.count(chosen)
        self.sides = read_runways(mapped, self.scene.geodetic_origin)
        self.place_lidar(mapped, put("exclusions.geojson", lambda: _geojson(self.exclusions(mapped))))
        put("airport.lidarscene.json", lambda: _json(self.scene_of(self.position)))
        put("airport.coverage.json", lambda: _json(self.plan()))
        put("siting.coverage.json", lambda: _json(self.plan(siting_too=True)))
        put("airport.scenario.json", lambda: _json(self.scenario()))
        put("assumed.csv", lambda: assumed(self))
        self.progress("files", 8, len(WHAT))
        sides = np.diff(np.reshape(self.rectangle, (2, 2)))[:, 0]
        wide, high = np.maximum(9.0 * sides / sides.max(), 3.0) + (2.0, 0.5)  # inches
        put("airport.png", lambda: _pictures.drawn((wide, high), self._draw))
        put("README.txt", lambda: readme(self))
        self.progress("files", len(WHAT), len(WHAT))
        return kept

    def _draw(self, axes) -> None:
        """The scene from above, with one colour for each class."""
        from matplotlib.collections import PolyCollection
        from matplotlib.colors import LinearSegmentedColormap
        from matplotlib.patches import Patch
        shown: Dict[str, str] = {}
        for _, word, triangles in parts_of(self.scene):
            if word == "terrain":
                x, y, z = triangles.reshape(-1, 3).T
                shades = axes.tripcolor(x, y, np.arange(len(x)).reshape(-1, 3), z, shading="gouraud", zorder=0,
                                        cmap=LinearSegmentedColormap.from_list("ground", ("#c3d3b4", "#f6f1df")))
                axes.figure.colorbar(shades, ax=axes, shrink=0.5, label="ground, m above the origin")
                continue
            colour, order = PARTS.get(word, BUILDING)
            shown[word] = colour
            axes.add_collection(PolyCollection(list(triangles[:, :, :2]), facecolors=colour, edgecolors=colour,
                                               linewidths=0.2, zorder=order))
        axes.plot(*self.position[:2], "r^", markersize=8, zorder=20)
        for runway in self.sides:
            axes.annotate(runway.name, runway.start, color="white", fontsize=8, ha="center", zorder=21,
                          bbox={"facecolor": "black", "pad": 1, "linewidth": 0})
        axes.legend(handles=[Patch(color=colour, label=word) for word, colour in shown.items()],
                    loc="upper left").set_zorder(30)
        axes.set(xlim=self.rectangle[:2], ylim=self.rectangle[2:], aspect="equal", xlabel="m east", ylabel="m north",
                 title=f"{self.name}: the scene from above; red: the lidar")


def parts_of(scene: Scene) -> Iterator[Tuple[str, str, np.ndarray]]:
    """Name, class and triangles (n x 3 x 3, m) of each object of a scene file."""
    for block in leaves_of(scene.surfaces):
        fields = field_values(block)
        points, cells = triangles_of(block)
        yield fields["object_names"][0], fields["object_classes"][0], points[cells]


def _assumed_rows(airport: AirportMap) -> Iterator[Tuple[Any, ...]]:
    """Kind, id, name, property, value and source of each assumed number."""
    for row in airport.rows:
        name = row.get("name") or row.get("ref") or ""
        for what in ("kind", "height", "top", "min_height", "width", "surface"):
            if "assumed" in str(row.get(f"{what}_from", "")):
                yield row["kind"], row.get("id", ""), name, what, row.get(what, 0.0), row[f"{what}_from"]


def assumed(airport: AirportMap) -> bytes:
    return as_csv([
        ("kind", "id", "name", "what", "value (m, or a material)", "from"), *_assumed_rows(airport),
        *((one.kind, one.id, one.name, "left out", one.count, one.reason) for one in airport.left),
        *(("unknown kind", "", name, "left out", n, "no rule knows it") for name, n in airport.unknown.most_common()),
        *((kind, "", "", "in the scene", count, "") for kind, count in airport.there.items())])


def _reasons(airport: AirportMap) -> Dict[str, Counter[str]]:
    """For each kind, the number of left out features by reason."""
    found: Dict[str, Counter[str]] = collections.defaultdict(collections.Counter)
    for one in airport.left:
        found[one.kind][one.reason] += one.count
    return found


def counts(airport: AirportMap) -> str:
    """The numbers of features that were read, that are in the scene, and that were left out by reason, in one line."""
    reasons = sum(_reasons(airport).values(), collections.Counter({UNKNOWN: sum(airport.unknown.values())}))
    there, left = sum(airport.there.values()), sum(reasons.values())

    def verb(count: int, one: str, more: str) -> str:
        return f"{count:,} {one if count == 1 else more}"
    sources = "\n".join(str(row.get(name, "")) for row in airport.rows
                        for name in ("height_from", "top_from", "min_height_from"))
    strange = re.findall("^assumed: [^ ]+ is ('.*?'|\".*?\")(?:, above.*)?$", sources, re.MULTILINE)
    words = (f"{verb(there + left, 'feature was', 'features were')} read, {verb(there, 'is', 'are')} in the scene, "
             f"{verb(left, 'was', 'were')} left out")
    if left:
        words += ": " + ", ".join(f"{count:,} {reason}" for reason, count in reasons.most_common())
    if strange:
        words += (f"; {verb(len(strange), 'height was', 'heights were')} not understood: "
                  f"{', '.join(list(dict.fromkeys(strange))[:4])}")
    return words


def _counts_by_kind(airport: AirportMap) -> str:
    """The numbers of features by kind."""
    lines, outside, away, found = [f"  {counts(airport)}"], "outside the scene", [], _reasons(airport)
    for kind in dict.fromkeys([*airport.there, *(one.kind for one in airport.left)]):
        out, there = +found[kind], airport.there[kind]
        if not there and set(out) == {outside}:
            away.append(f"{kind} ({out[outside]:,})")
        elif out:
            lines.append(f"  {kind or 'others'}: {there + sum(out.values()):,} read, {there:,} in the scene; left out: "
                         + ", ".join(f"{count:,} {reason}" for reason, count in out.items()))
    named = [f"{name} ({count:,})" for name, count in airport.unknown.most_common(7) if name != "others"]
    cut = [f"{count:,} {kind}" for kind, count in collections.Counter(one.kind for one in airport.cut).items()]
    lists = {f"all {outside}": away, "among those of unknown kind": named[:6], f"{CUT}, and shorter than they are": cut}
    lines += [f"  {words}: {', '.join(some)}" for words, some in lists.items() if some]
    if airport.cut or any(one.reason == CUT for one in airport.left):
        lines.append("  `osmium extract --strategy smart` makes an extract whose features are whole at the border")
    return "\n".join(lines)


def readme(airport: AirportMap) -> bytes:
    kinds = collections.Counter(row["kind"] for row in airport.rows)
    assumed = collections.Counter((row[0], row[3]) for row in _assumed_rows(airport))
    lengths = "\n".join(f"  {runway.words()}" for runway in airport.sides)
    of_kind = {kind: [f"; {what} assumed of {number}" for (one, what), number in assumed.items() if one == kind]
               for kind in kinds}
    table = "\n".join(f"  {kind}: {count}{''.join(of_kind[kind])}" for kind, count in kinds.items())
    sources = {str(row.get(name, "")) for row in airport.rows for name in ("height_from", "top_from")}
    quoted = "".join(f"  heights are from {words}\n" for words in sorted(sources) if ": " in words)
    heights = ground_of(airport.scene, ends_of(airport.sides))
    x, y, z = airport.position
    without = "; without clutter, because clutter behind leaves takes long to compute" if airport.leaves else ""
    surfaces = ("pierces an obstacle limitation surface of ICAO Annex 14, as every free place does" if airport.pierces
                else "is below the strip, approach and transitional surfaces of ICAO Annex 14")
    return f"""{airport.name}

Made by `avianlidar airport` from {airport.extract.name}. You may edit all files.
A further run makes only files again that nobody has edited. Remove a file to have the file made again.

  airport.geojson          features of the extract: kind, height (of plants, fences and masts: top), width, and sources
  terrain.vtp              the ground
  airport.lidarscene.json  the scene
  airport.coverage.json    a plan: avianlidar coverage airport.coverage.json -o maps
  siting.coverage.json     the same plan with sites: avianlidar report siting.coverage.json -o report.html{without}
  exclusions.geojson       where no lidar may stand, beside buildings
  airport.scenario.json    labelled scans: avianlidar sequence airport.scenario.json -o sequences
                           tracks of the birds: avianlidar track sequences --runways airport.geojson -o tracks
  assumed.csv              each number that is missing in the extract, and each feature that was left out
  airport.png              the scene from above

Runways
{lengths}

Features in the scene, and how many have an assumed number
{table}
{quoted}
Features that were read, and what became of them
{_counts_by_kind(airport)}

{airport.terrain_words}
  heights are above the sea or above the ellipsoid, as in the file
  the ends of the runways lie {np.nanmin(heights):.1f} to {np.nanmax(heights):.1f} m above the origin
  plans give heights above the origin

Also assumed: materials, leaf area density (m2/m3) of woods and trees, leaves down to the ground,
and grass where nothing is mapped. Roofs are level. Solids stand on the lowest ground below them.
Fences are walls in the scene, but real wire lets most light through.

Check on site
  the runways' widths and ends, against the aeronautical chart
  heights of terminals, hangars, towers and masts near the lidar, which shadow birds
  new, removed and unmapped objects: buildings, masts, fences, trees, cranes and parked aircraft
  woods and trees: height, and leaves by season
  the lidar's place ({x:.0f} m east, {y:.0f} m north, {z:.1f} m up): the free place nearest to the middle
  of the longest runway; this place {surfaces}; the airport decides whether a mast may stand there
  exclusions, which are simplified; the report of siting.coverage.json also keeps masts below these surfaces
""".encode()
