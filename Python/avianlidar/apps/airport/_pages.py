# SPDX-License-Identifier: BSD-3-Clause
"""The picture, the table of assumed numbers and the README of a made airport."""
from __future__ import annotations

import collections
import re
from typing import Any, Counter, Dict, Iterable, Iterator, Tuple

import numpy as np

from ..._cloud import field_values, leaves_of, triangles_of
from ..._look import GROUND, class_colour
from ..._scene import Scene
from ..._writers import as_csv
from ..pages._placing import Label, place_labels
from ..places._candidates import ground_of
from ..places._features import Feature
from ..places._regions import end_names, ends_of
from ._extract import CROSSING, CUT, OUTSIDE, UNKNOWN
from ._plans import AirportScene, Place

SMALL = {"mast", "pole"}  # drawn with a wider line


def draw(axes, found: AirportScene, place: Place) -> None:
    """The scene from above, with one colour for each class."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.patches import Patch
    shown: Dict[str, str] = {}
    for _, word, triangles in parts_of(found.scene):
        if word == "terrain":
            x, y, z = triangles.reshape(-1, 3).T
            shades = axes.tripcolor(x, y, np.arange(len(x)).reshape(-1, 3), z, shading="gouraud", zorder=0,
                                    cmap=LinearSegmentedColormap.from_list("ground", ("#c3d3b4", "#f6f1df")))
            axes.figure.colorbar(shades, ax=axes, shrink=0.5, label="ground, m above the origin")
            continue
        colour = shown[word] = class_colour(word)
        order = 1 + (GROUND.index(word) if word in GROUND else len(GROUND) + (word != "vegetation"))
        line = 2.5 if word in SMALL else 0.2 if word in (*GROUND, "vegetation") else 1.0
        axes.add_collection(PolyCollection(list(triangles[:, :, :2]), facecolors=colour, edgecolors=colour,
                                           linewidths=line, zorder=order))
    axes.plot(*place.position[:2], "r^", markersize=11, markeredgecolor="white", zorder=20)
    axes.legend(handles=[Patch(color=colour, label=word) for word, colour in shown.items()],
                loc="upper left").set_zorder(30)
    west_east, south_north = found.map.rectangle[:2], found.map.rectangle[2:]
    axes.set(xlim=west_east, ylim=south_north, aspect="equal", xlabel="m east", ylabel="m north",
             title=f"{found.map.name}: the scene from above; red triangle: the lidar")
    place_labels(axes, [Label(name, end, way)
                        for runway, names in zip(found.sides, end_names(found.sides))
                        for name, (end, way) in zip(names, runway.ends())], [place.position[:2]])


def parts_of(scene: Scene) -> Iterator[Tuple[str, str, np.ndarray]]:
    """Name, class and triangles (n x 3 x 3, m) of each object of a scene file."""
    for block in leaves_of(scene.surfaces):
        fields = field_values(block)
        points, cells = triangles_of(block)
        yield fields["object_names"][0], fields["object_classes"][0], points[cells]


def _assumed_rows(found: AirportScene) -> Iterator[Tuple[Any, ...]]:
    """Kind, id, name, property, value and source of each assumed number."""
    for row in found.rows:
        name = row.get("name") or row.get("ref") or ""
        for what in ("kind", "height", "top", "min_height", "width", "surface"):
            if "assumed" in str(row.get(f"{what}_from", "")):
                yield row["kind"], row.get("id", ""), name, what, row.get(what, 0.0), row[f"{what}_from"]


def assumed(found: AirportScene) -> bytes:
    there, left = found.fates
    return as_csv([
        ("kind", "id", "name", "what", "value (m, or a material)", "from"), *_assumed_rows(found),
        *((one.kind, one.id, one.name, "left out", one.count, one.reason) for one in left),
        *(("unknown kind", "", name, "left out", n, "no rule knows it") for name, n in found.map.unknown.most_common()),
        *((kind, "", "", "in the scene", count, "") for kind, count in there.items())])


def _reasons(left: Iterable[Feature]) -> Dict[str, Counter[str]]:
    """For each kind, the number of left out features by reason."""
    reasons: Dict[str, Counter[str]] = collections.defaultdict(collections.Counter)
    for one in left:
        reasons[one.kind][one.reason] += one.count
    return reasons


def counts(found: AirportScene) -> str:
    """The numbers of features that were read, that are in the scene, and that were left out by reason, in one line."""
    unknown = collections.Counter({UNKNOWN: sum(found.map.unknown.values())})
    reasons = sum(_reasons(found.fates[1]).values(), unknown)
    there, left = sum(found.fates[0].values()), sum(reasons.values())

    def verb(count: int, one: str, more: str) -> str:
        return f"{count:,} {one if count == 1 else more}"
    words = (f"{verb(there + left, 'feature was', 'features were')} read, {verb(there, 'is', 'are')} in the scene, "
             f"{verb(left, 'was', 'were')} left out")
    if left:
        words += ": " + ", ".join(f"{count:,} {reason}" for reason, count in reasons.most_common())
    for what, names in (("height", ("height_from", "top_from", "min_height_from")), ("width", ("width_from",))):
        sources = "\n".join(str(row.get(name, "")) for row in found.rows for name in names)
        strange = re.findall("^assumed: [^ ]+ is ('.*?'|\".*?\")(?:, above.*)?$", sources, re.MULTILINE)
        if strange:
            words += (f"; {verb(len(strange), f'{what} was', f'{what}s were')} not understood: "
                      f"{', '.join(list(dict.fromkeys(strange))[:4])}")
    return words


def _counts_by_kind(found: AirportScene) -> str:
    """The numbers of features by kind."""
    there, left = found.fates
    lines, away, reasons = [f"  {counts(found)}"], [], _reasons(left)
    for kind in dict.fromkeys([*there, *(one.kind for one in left)]):
        out = +reasons[kind]
        if not there[kind] and set(out) == {OUTSIDE}:
            away.append(f"{kind} ({out[OUTSIDE]:,})")
        elif out:
            reasons_of_kind = ", ".join(f"{count:,} {reason}" for reason, count in out.items())
            lines.append(f"  {kind or 'others'}: {there[kind] + sum(out.values()):,} read, {there[kind]:,} in the "
                         f"scene; left out: {reasons_of_kind}")
    named = [f"{name} ({count:,})" for name, count in found.map.unknown.most_common(7) if name != "others"]
    crossing = [f"{one.kind} {one.name or one.id}".strip() for one in found.chosen if CROSSING in one.tags]
    some = ", ".join(crossing[:5]) + (", ..." if len(crossing) > 5 else "")
    cut = collections.Counter(one.kind for one in found.chosen if one.tags.get(CUT) == CUT)
    lists = {f"all {OUTSIDE}": away, "among those of unknown kind": named[:6],
             f"{CUT}, and shorter than they are": [f"{count:,} {kind}" for kind, count in cut.items()],
             f"{len(crossing):,} {CROSSING}": [some] * bool(crossing)}
    lines += [f"  {words}: {', '.join(some)}" for words, some in lists.items() if some]
    if cut or any(one.reason == CUT for one in left):
        lines.append("  `osmium extract --strategy smart` makes an extract whose features are whole at the border")
    return "\n".join(lines)


def readme(found: AirportScene, place: Place) -> bytes:
    kinds = collections.Counter(row["kind"] for row in found.rows)
    assumed = collections.Counter((row[0], row[3]) for row in _assumed_rows(found))
    lengths = "\n".join(f"  {runway.words()}" for runway in found.sides)
    of_kind = {kind: [f"; {what} assumed of {number}" for (one, what), number in assumed.items() if one == kind]
               for kind in kinds}
    table = "\n".join(f"  {kind}: {count}{''.join(of_kind[kind])}" for kind, count in kinds.items())
    sources = {str(row.get(name, "")) for row in found.rows for name in ("height_from", "top_from")}
    quoted = "".join(f"  heights are from {words}\n" for words in sorted(sources)
                     if ": " in words and not words.startswith("assumed"))
    heights = ground_of(found.scene, ends_of(found.sides))
    x, y, z = place.position
    without = "; without clutter, because clutter behind leaves takes long to compute" if found.leaves else ""
    surfaces = ("pierces an obstacle limitation surface of ICAO Annex 14, as every free place does" if place.pierces
                else "is below the strip, approach and transitional surfaces of ICAO Annex 14")
    return f"""{found.map.name}

Made by `avianlidar airport` from {found.map.extract.name}. You may edit all files.
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
{_counts_by_kind(found)}

{found.ground}
  heights are above the sea, or above the ellipsoid if those of the file are
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
