# SPDX-License-Identifier: BSD-3-Clause
"""What coverage costs, beside gdal_viewshed on as many cells, and what share of strips and approaches is covered.

    Testing/Studies/run.py coverage_costs --scenes build/paraview/Testing/Scenes

Scenes: the airport that is shipped, and up to five of a folder.
"""
import json
import pathlib
import subprocess
import tempfile
import time

import numpy as np

import avianlidar as al
import tools
from avianlidar import siting
from running import AIRPORT, FOOTPRINTS, argument, seconds_of, study

SPECIES = ("starling", "kestrel", "pigeon", "crow", "herring gull", "Canada goose")
TURNS = 3


def middle_of(scene):
    """The sensor's place in a scene that names none: 10 m above the middle of its bounds."""
    box = scene.tree.GetOutput().GetBounds()
    return (0.5 * (box[0] + box[1]), 0.5 * (box[2] + box[3]), box[4] + 10.0)


def costs(path):
    """Seconds of the first map, and of another species."""
    scene = al.load_scene(path)
    scene.tree.Update()
    place = scene.lidar_position or middle_of(scene)
    sensor = al.Sensor("Search905", position=place)
    cover = al.Coverage(scene, sensor, bounds=(place[0] - 2000, place[0] + 2000, place[1] - 2000, place[1] + 2000, place[2] - 3,
                                               place[2] + 147), spacing=(10.0, 10.0, 2.4), species="pigeon")
    first = seconds_of(cover.update)
    row = {"scene": path.name.split(".")[0], "places": cover.data.GetNumberOfPoints(), "first": first}
    again = []
    for species in ("crow", "starling", "herring gull"):
        cover.species = species
        cover.update()  # its poses are known from here on
    for _ in range(TURNS):
        for species in ("crow", "starling"):
            cover.species = species
            again.append(seconds_of(cover.update))
    row["species"] = float(np.median(again))
    return row


def beside_viewshed(folder):
    """Seconds of one map of 1e7 cells at 30 m by coverage (tree and beams made before), and by gdal_viewshed on the same cells."""
    scene = al.load_scene(AIRPORT)
    scene.tree.Update()
    n, cell = 3163, 1.5
    half = 0.5 * (n - 1) * cell
    features = json.loads(FOOTPRINTS.read_text(encoding="utf-8"))["features"]
    plan = []
    for feature in features:
        if "height" in feature["properties"] and feature["geometry"]["type"] == "Polygon":
            rings = [siting.to_enu([point[:2] for point in ring], scene.geodetic_origin).tolist()
                     for ring in feature["geometry"]["coordinates"]]
            plan.append({"type": "Feature", "properties": {"height": feature["properties"]["height"]},
                         "geometry": {"type": "Polygon", "coordinates": rings}})
    (folder / "plan.json").write_text(json.dumps({"type": "FeatureCollection", "features": plan}), encoding="utf-8")
    subprocess.run(["gdal_rasterize", "-q", "-a", "height", "-init", "0", "-ot", "Float32", "-tr", str(cell), str(cell), "-te",
                    *(str(edge) for edge in (-half - cell / 2, -half - cell / 2, half + cell / 2, half + cell / 2)),
                    str(folder / "plan.json"), str(folder / "dem.tif")], check=True, stderr=subprocess.DEVNULL)
    ours, theirs = [], []
    for _ in range(TURNS):
        cover = al.Coverage(scene, al.Sensor("Search905", position=scene.lidar_position), bounds=(-half, half, -half, half, 30, 30),
                            spacing=(cell, cell, 1.0), species="herring gull")
        cover.sensor.beams
        ours.append(seconds_of(cover.update))
        theirs.append(seconds_of(lambda: subprocess.run(
            ["gdal_viewshed", "-q", "-ox", "0", "-oy", "0", "-oz", "3", "-tz", "30", "-cc", "0", "-md", "0", str(folder / "dem.tif"),
             str(folder / "seen.tif")], check=True)))
    stats = subprocess.run(["gdalinfo", "-json", "-stats", str(folder / "seen.tif")], check=True, capture_output=True, text=True).stdout
    in_sight = json.loads(stats)["bands"][0]["mean"] / 255.0
    return {"hidden": cover.table[-1]["share_shadowed"], "hidden_there": 1.0 - in_sight, "cells": cover.data.GetNumberOfPoints(), "coverage": float(np.median(ours)), "gdal_viewshed": float(np.median(theirs)),
            "ratio": float(np.median(np.array(ours) / theirs))}


def shares():
    """Share of 12,000 places in strips and approaches at Hongqiao, by sensor and species."""
    scene = al.load_scene(AIRPORT)
    runways = siting.read_runways(FOOTPRINTS, scene.geodetic_origin)
    middle = 0.5 * (np.array(runways[0].start) + runways[0].end)
    points, regions = siting.strips_and_approaches(runways, 12000, 1)
    found = {}
    for sensor in ("Search905", "Search1550", "Automotive16", "Airport16"):
        cover = al.Coverage(scene, al.Sensor(sensor, position=(*middle, 3.0)), places=al.places_of(points, regions), all_species=True)
        found[sensor] = {row["species"]: row for row in cover.table if row["region"] == "all" and row["height_to"] == np.inf
                         and row["height_from"] == -np.inf}
    return found


def search():
    """Seconds that 370 sites with 12,000 places and three species take, on one thread, and of the search for three."""
    scene = al.load_scene(AIRPORT)
    runways = siting.read_runways(FOOTPRINTS, scene.geodetic_origin)
    outlines = siting.read_outlines(FOOTPRINTS, scene.geodetic_origin, "height") + [siting.runway_outline(r) for r in runways]
    sites = siting.candidates(siting.lattice((-2000, 1600, -2200, 2200), 200), (5.0,), [(outline, 0.0) for outline in outlines])
    points, regions = siting.strips_and_approaches(runways, 12000)
    mix = {"starling": 1.0, "herring gull": 1.0, "Canada goose": 1.0}
    begin = time.perf_counter()
    found = siting.look(scene, al.Sensor("Search905"), sites, points, list(mix))
    looked = time.perf_counter()
    siting.search(found, siting.weights_of(len(points), regions, {"strips": 1.0, "approaches": 1.0}, mix), 3)
    return {"sites": len(sites), "look": looked - begin, "search": time.perf_counter() - looked}


@study(argument("--scenes", type=pathlib.Path, required=True, help="folder with .lidarscene.json files"))
def main(options):
    scenes = [AIRPORT]
    for path in sorted(options.scenes.glob("*.lidarscene.json")):
        if len(scenes) < 6 and "osm" not in path.name and "all" not in path.name:
            scenes.append(path)
    tools.leave(options.out, "coverage-costs", ("scene", "places", "first map, s", "another species, s"), [
        (row["scene"], f"{row['places']:,}", f"{row['first']:.2f}", f"{row['species']:.2f}") for row in map(costs, scenes)])
    with tempfile.TemporaryDirectory() as folder:
        one = beside_viewshed(pathlib.Path(folder))
    found = search()
    notes = [("cells of 1.5 m of one map at 30 m", f"{one['cells']:,}"), ("with clutter and probabilities, s", f"{one['coverage']:.2f}"),
             ("gdal_viewshed, s", f"{one['gdal_viewshed']:.2f}"), ("ratio", f"{one['ratio']:.0f}"),
             ("hidden where beams are near, %", f"{100 * one['hidden']:.2f}"), ("hidden there by the viewshed, %", f"{100 * one['hidden_there']:.2f}"),
             ("siting: sites", f"{found['sites']}"), ("siting: look, s", f"{found['look']:.1f}"), ("siting: search of one to three sites, s", f"{found['search']:.1f}")]
    tools.leave(options.out, "coverage-species", ("sensor", *SPECIES), [
        (sensor, *(f"{rows[s]['detection_probability']:.3f} ± {rows[s]['detection_std_error']:.3f}" for s in SPECIES))
        for sensor, rows in shares().items()])
    tools.leave(options.out, "coverage-notes", ("what", "value"), notes)
