# SPDX-License-Identifier: BSD-3-Clause
"""A small good plan of coverage and a small good scenario with all files that they name, and documents made wrong."""

import copy
import gzip
import json
import math
import random

LONGITUDE, LATITUDE = 121.3363, 31.1979
ODD = [None, True, False, 0, -1, 1, 0.5, 20.0, 100.0001, 1e-300, 1e9, -1e9, 1e18, 1e30, 1e308, -1e308, 2**31, 2**63, 10**30, "", "x", "NaN",
       "12", "a\0b", "../..", "\ud800", "/", "none.json", "town.geojson", "herring gull", "Search905", "runway", [], {}, [None], [1], [[]],
       ["x"], [0, 0, 0], [1, 2, 3, 4], [4, 3, 2, 1], [[0, 0], [1, 1]], {"a": 1}, {"preset": "VLP-16"}, {"preset": 5}]
# Properties that the schema leaves to the classes.
NAMES = ["species", "effective_area", "visibility", "height_limits", "clutter", "all_species", "range_gate", "azimuth_range", "azimuth_step",
         "orientation", "position", "pulse_energy", "rays_per_beam", "number_of_threads", "species_file_name", "Spacing", "progress", "name",
         "directions", "times", "radius", "heights", "center", "file_name", "number_of_birds", "every", "first", "class", "material",
         "number_of_scans", "required_detections", "attenuation_coefficient", "weather", "share", "air_backscatter", "rain_rate", "preset", "properties", "geometry", "coordinates", "comment"]
SENSOR = {"preset": "Airport16", "azimuth_step": 30.0, "position": [0, 0, 3]}


def feature(shape, coordinates, **properties):
    return {"type": "Feature", "properties": properties, "geometry": {"type": shape, "coordinates": coordinates}}


def ring(x, y, size):
    """A square with a corner x, y metres east and north of the origin."""
    corners = ((0, 0), (size, 0), (size, size), (0, size), (0, 0))
    east = 111320 * math.cos(math.radians(LATITUDE))
    return [[round(LONGITUDE + (x + u) / east, 7), round(LATITUDE + (y + v) / 111320, 7)] for u, v in corners]


def collection(*features):
    return {"type": "FeatureCollection", "features": list(features)}


def documents():
    """{name: document}; the first of each pair of opened files is a plan, the second a scenario."""
    scene = {"version": 1, "comment": ["of no place"], "origin": {"latitude": LATITUDE, "longitude": LONGITUDE, "height": 3},
             "lidar": {"position": [0, 0, 3]},
             "objects": [{"ground": {"size": 4000, "height": 0}, "name": "ground", "material": "Wall"},
                         {"footprints": "town.geojson", "filter": {"height": "*"}, "height_attribute": "height", "height": 8}]}
    first, last = ring(-300, -500, 1)[0], ring(-300, 500, 1)[0]
    town = collection(feature("Polygon", [ring(200, 0, 60)], height=12, name="hangar"), feature("MultiPolygon", [[ring(0, 300, 40)]], height="9"),
                      feature("LineString", [first, last], kind="runway", name="18/36", width=45),
                      {"type": "Feature", "properties": None, "geometry": None})
    plan = {"description": "?", "scene": "town.lidarscene.json", "sensor": SENSOR, "compare_with": [{**SENSOR, "name": "near", "range_gate": 500}, {**SENSOR, "name": "other"}],
            "coverage": {"visibility": 20000, "height_limits": [0, 30]}, "weather": ["rain:1"],
            "year": [{"weather": ["fog:700"], "share": 0.25}, {"weather": [], "share": 0.75}], "mix": {"crow": 1, "starling": 2}, "heights": [15, 30.5],
            "extent": [-300, 300, -300, 300], "spacing": 150, "runways": "town.geojson", "places": 20, "seed": 1, "regions": {"strips": 1, "approaches": 2},
            "siting": {"bounds": [-500, 500, -500, 500], "spacing": 500, "masts": [5, 8], "margin": 3, "exclusions": ["taken.geojson"],
                       "sensors": 2, "draws": 1}}
    points = copy.deepcopy(plan)
    points["siting"] = {"points": "points.csv", "draws": 0}
    points["metar"] = "year.txt"
    del points["year"]
    scenario = {"description": "?", "scene": "town.lidarscene.json", "sensor": {**SENSOR, "sway_amplitude": 0.02, "sway_frequency": 0.5},
                "scan": {"rays_per_beam": 50}, "number_of_scans": 2, "scans_per_sequence": 2, "seed": 1, "near_clutter_distance": 10,
                "birds": [{"pattern": "Crossings", "species": "crow", "number_of_birds": 2, "radius": 100, "heights": [2, 30]},
                          {"pattern": "Circles", "species": "starling", "number_of_birds": 2, "center": [50, 0, 0], "radius": 50}],
                "objects": [{"name": "car", "class": "car", "speed": 8, "first": 0, "every": 20, "boxes": [[-1, 1, -2, 2, 0, 1.5]],
                             "route": [[0, -80, 0], [0, 80, 0], [60, 80, 0]]}]}
    return {"lattice.coverage.json": plan, "points.coverage.json": points, "town.scenario.json": scenario, "town.lidarscene.json": scene,
            "town.geojson": town, "taken.geojson": collection(feature("Polygon", [ring(400, 400, 200)]))}


def files():
    """{name: content} of all."""
    table = "x,y\n-100,0\n100,0\n0,-400\n"
    found = {name: json.dumps(document).encode() for name, document in documents().items()}
    found["year.txt"] = b"ZSSS 010000Z 34004MPS 9999 FEW030 12/08 Q1013\nZSSS 010100Z 34004MPS 0800 -RA FG 12/08 Q1013\n"
    return {**found, "taken.geojson": gzip.compress(found["taken.geojson"], mtime=0), "points.csv": table.encode()}


def _nodes(value):
    """(what holds it, its key) of all values below."""
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in list(inside):
        yield value, key
        yield from _nodes(part)


def _change(document, r):
    nodes = list(_nodes(document))
    if not nodes:
        return r.choice(ODD)
    holder, key = r.choice(nodes)
    kind = r.randrange(8)
    if kind < 4:
        holder[key] = copy.deepcopy(r.choice(ODD))
    elif kind == 4:
        del holder[key]
    elif kind == 5:
        other, place = r.choice(nodes)
        holder[key] = copy.deepcopy(other[place])
    elif kind == 6 and isinstance(holder, dict):
        holder[r.choice(NAMES)] = copy.deepcopy(r.choice(ODD))
    elif kind == 6:
        holder += [copy.deepcopy(r.choice(holder))] * r.choice((1, 2, 100))
    elif isinstance(holder[key], (int, float)):
        holder[key] *= r.choice((-1, 0, 1e-3, 1e3, 1e9, 1.0000001))
    return document


def changed(document, seed):
    """A copy in which some values are others, there twice or missing."""
    r = random.Random(seed)
    document = copy.deepcopy(document)
    for _ in range(r.choice((1, 1, 1, 2, 3))):
        document = _change(document, r)
    return document
