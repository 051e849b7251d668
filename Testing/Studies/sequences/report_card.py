# SPDX-License-Identifier: BSD-3-Clause
"""The report card of the shipped airport for two receivers, by `avianlidar track`: a table, one by species, one by settings, a picture;
and an hour of the same airport without birds.

    Testing/Studies/run.py report_card --out build/card
"""
import json
import shutil
import sys

import tools
from avianlidar._command import main as avianlidar
from running import AIRPORT, FOOTPRINTS, argument, study

SCENARIO = AIRPORT.parents[2] / "sequence" / "hongqiao.scenario.json"
SENSORS = ("Search905", "Search1550")
SETTINGS = ("", "--tracker-set minimum_speed=5", "--tracker-set confirm_hits=4 --tracker-set confirm_scans=5", "--clutter-set clutter_threshold=0.02")
HOUR = 1800  # scans
SHOWN = ("birds tracked", "share of time", "identity switches", "false tracks an hour")


def track(*words):
    """Run `avianlidar track`."""
    if avianlidar(["track", *map(str, words)]):
        sys.exit(1)


def card_of(folder):
    return json.loads((folder / "card.json").read_text(encoding="utf-8"))


def by_settings(tracks, out):
    """Rows of scores of the same sequences with other settings. @param tracks folder of a card @param out another one"""
    rows = []
    for words in SETTINGS:
        track(*(tracks / "sequences" / f"hongqiao-{name}" for name in SENSORS), "-o", out, *words.split())
        overall = {row["words"]: row["cells"] for row in card_of(out)["overall"]}
        rows += [[f"`{words}`" if words else "defaults", name, *(overall[score][k] for score in SHOWN)] for k, name in enumerate(SENSORS)]
    return rows


def without_birds(out):
    """Rows of what is tracked in an hour of scans by Search905 where nothing flies: walls that few scans perceive, false alarms, vehicles."""
    scenario = json.loads(SCENARIO.read_text(encoding="utf-8"))
    del scenario["birds"]
    scenario.update(scene=str(AIRPORT), number_of_scans=HOUR, scans_per_sequence=HOUR)
    out.mkdir(parents=True, exist_ok=True)
    file = out / "empty.scenario.json"
    file.write_text(json.dumps(scenario), encoding="utf-8")
    rows, what = [], file
    for words in SETTINGS:
        folder = out / ("settings" if words else "tracks")
        track(what, "-o", folder, *words.split())
        what = out / "tracks" / "sequences" / "empty"
        cells = {row["words"]: row["cells"][0] for row in card_of(folder)["overall"]}
        rows.append([f"`{words}`" if words else "defaults", cells[SHOWN[-1]], cells["tracks of vehicles an hour"]])
    return rows


@study(argument("--scans", type=int, default=500, help="default 500"))
def main(options):
    tracks = options.out / "tracks"
    track(SCENARIO, "-o", tracks, "--scans", options.scans, "--runways", FOOTPRINTS, *(word for name in SENSORS for word in ("--sensor", name)))
    card = card_of(tracks)
    strip = next(of for of in card["warnings"] if of["volume"] == "strip")
    tools.leave(options.out, "tracks-card", ("score", *SENSORS), [
        (row["words"], *row["cells"]) for row in [*card["overall"], *({**row, "words": f"strip: {row['words']}"} for row in strip["rows"])]])
    species = next(group for group in card["groups"] if group["by"] == "species")
    tools.leave(options.out, "tracks-species", (
        "species", "birds", *(f"{words}, {name}" for words in ("tracked", "share of time") for name in SENSORS)), [
        (row["name"], row["counts"][0], *row["cells"][0], *row["cells"][2]) for row in species["rows"]])
    tools.leave(options.out, "tracks-settings", ("settings", "sensor", *SHOWN), by_settings(tracks, options.out / "settings"))
    tools.leave(options.out, "tracks-empty", ("settings", SHOWN[-1], "tracks of vehicles an hour"), without_birds(options.out / "empty"))
    shutil.copyfile(tracks / "hongqiao-Search1550-scan.png", options.out / "scan.png")
