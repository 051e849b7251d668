#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Make hongqiao.geojson, the plan of the shipped airport, from an OpenStreetMap extract.

    make_scene.py <extract.geojson> [<output.geojson>]

The extract is GeoJSON (WGS84) whose features have the properties `layer` (building, apron, runway; others are left
out), `kind` (terminal, hangar, building), `name`, `height_m`, `ref`, `width_m` and `surface`. Written are the facts
that a lidar needs: coordinates rounded to six decimals (about 0.1 m), a height or a width, the kind, an English name.
The data are OpenStreetMap's and stay under the ODbL: see LICENSE-ODbL.md.
"""
import json
import sys

ENGLISH = {
    "\u4e2d\u56fd\u4e1c\u65b9\u822a\u7a7a\u516c\u53f8\u673a\u5e93": "China Eastern Airlines hangar",
    "\u8679\u6865\u516c\u52a1\u673a\u697c": "Hongqiao business aviation terminal",
    "\u8679\u6865\u4e1c\u533a VVIP": "Hongqiao East VVIP terminal",
}
LABELS = {"terminal": "Terminal", "hangar": "Hangar", "building": "Building", "apron": "Apron"}
DECIMALS = 6


def rounded(coordinates):
    """Round all coordinates, and drop vertices that rounding made equal to the one before."""
    if isinstance(coordinates[0], (int, float)):
        return [round(c, DECIMALS) for c in coordinates[:2]]
    points = [rounded(c) for c in coordinates]
    return [p for i, p in enumerate(points) if i == 0 or p != points[i - 1]]


def facts(properties, numbers):
    """The properties to write; None for a feature that is left out."""
    layer = properties["layer"]
    if layer == "runway":
        return {"kind": "runway", "name": "Runway " + properties["ref"], "width": properties["width_m"],
                "surface": properties["surface"]}
    if layer not in ("building", "apron"):
        return None
    kind = properties["kind"] if layer == "building" else "apron"
    original = properties.get("name", "")
    if original:
        name = ENGLISH.get(original, original)
    else:
        numbers[kind] = numbers.get(kind, 0) + 1
        name = f"{LABELS[kind]} {numbers[kind]}"
    written = {"kind": kind, "name": name}
    if original and original != name:
        written["name:zh"] = original
    if layer == "building":
        written["height"] = properties["height_m"]
    return written


def main(source, target):
    with open(source, encoding="utf-8") as file:
        extract = json.load(file)
    numbers = {}
    lines = []
    for feature in extract["features"]:
        properties = facts(feature["properties"], numbers)
        if properties is not None:
            geometry = feature["geometry"]
            lines.append(json.dumps({
                "type": "Feature", "properties": properties,
                "geometry": {"type": geometry["type"], "coordinates": rounded(geometry["coordinates"])}}))
    head = {
        "type": "FeatureCollection",
        "name": "hongqiao",
        "attribution": "(c) OpenStreetMap contributors, ODbL 1.0, https://www.openstreetmap.org/copyright",
        "comment": "Shanghai Hongqiao (ZSSS). Heights are not surveyed: 25 m for terminals and hangars, 12 m for other "
                   "buildings are the defaults of the extract.",
    }
    with open(target, "w", encoding="ascii") as file:
        file.write(json.dumps(head, indent=1)[:-2] + ',\n "features": [\n  ' + ",\n  ".join(lines) + "\n ]\n}\n")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2] if len(sys.argv) == 3 else "hongqiao.geojson")
