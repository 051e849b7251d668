#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The report card of the shipped airport for two receivers, by `avianlidar track`: a table, one by species, one by settings, a picture;
and an hour of the same airport without birds.

    report_card.py --out build/card
"""
import argparse
import csv
import json
import pathlib
import shutil
import sys

from avianlidar._command import main as avianlidar

HERE = pathlib.Path(__file__).resolve().parent
SENSORS = ("Search905", "Search1550")
SETTINGS = ("", "--tracker-set minimum_speed=5", "--tracker-set confirm_hits=4 --tracker-set confirm_scans=5", "--clutter-set clutter_threshold=0.02")
HOUR = 1800  # scans
SHOWN = ("birds tracked", "share of time", "identity switches", "false tracks an hour")


def table(names, rows):
    """Markdown."""
    lines = [f"| {' | '.join(names)} |", "|---|" + "---:|" * (len(names) - 1)]
    return "\n".join([*lines, *(f"| {' | '.join(row)} |" for row in rows)]) + "\n"


def by_settings(tracks, out):
    """Rows of scores of the same sequences with other settings. @param tracks folder of a card @param out another one"""
    rows = []
    for words in SETTINGS:
        folders = [str(tracks / "sequences" / f"hongqiao-{name}") for name in SENSORS]
        if avianlidar(["track", *folders, "-o", str(out), *words.split()]):
            sys.exit(1)
        overall = {row["words"]: row["cells"] for row in json.loads((out / "card.json").read_text(encoding="utf-8"))["overall"]}
        rows += [[f"`{words}`" if words else "defaults", name, *(overall[score][k] for score in SHOWN)] for k, name in enumerate(SENSORS)]
    return rows


def without_birds(out):
    """Rows of what is tracked in an hour of scans by Search905 where nothing flies: walls that few scans perceive, false alarms, vehicles."""
    scenario = json.loads((HERE / "hongqiao.scenario.json").read_text(encoding="utf-8"))
    del scenario["birds"]
    scenario.update(scene=str((HERE / scenario["scene"]).resolve()), number_of_scans=HOUR, scans_per_sequence=HOUR)
    out.mkdir(parents=True, exist_ok=True)
    file = out / "empty.scenario.json"
    file.write_text(json.dumps(scenario), encoding="utf-8")
    rows, what = [], str(file)
    for words in SETTINGS:
        if avianlidar(["track", what, "-o", str(out / ("settings" if words else "tracks")), *words.split()]):
            sys.exit(1)
        what = str(out / "tracks" / "sequences" / "empty")
        overall = json.loads((out / ("settings" if words else "tracks") / "card.json").read_text(encoding="utf-8"))["overall"]
        cells = {row["words"]: row["cells"][0] for row in overall}
        rows.append([f"`{words}`" if words else "defaults", cells[SHOWN[-1]], cells["tracks of vehicles an hour"]])
    return rows


def main(arguments=None):
    """Make card, tables and picture. @return rows of card.csv"""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scans", type=int, default=500, help="default 500")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder")
    options = parser.parse_args(arguments)
    tracks = options.out / "tracks"
    if avianlidar(["track", str(HERE / "hongqiao.scenario.json"), "-o", str(tracks), "--scans", str(options.scans), "--runways",
                   str(HERE.parent / "airport" / "scene" / "hongqiao.geojson"), *(word for name in SENSORS for word in ("--sensor", name))]):
        sys.exit(1)
    card = json.loads((tracks / "card.json").read_text(encoding="utf-8"))
    strip = next(of for of in card["warnings"] if of["volume"] == "strip")
    rows = [[row["words"], *row["cells"]] for row in [*card["overall"], *({**row, "words": f"strip: {row['words']}"} for row in strip["rows"])]]
    (options.out / "tracks-card.md").write_text(table(["score", *SENSORS], rows), encoding="utf-8")
    species = next(group for group in card["groups"] if group["by"] == "species")
    rows = [[row["name"], str(row["counts"][0]), *(cell for cells in (row["cells"][0], row["cells"][2]) for cell in cells)] for row in species["rows"]]
    (options.out / "tracks-species.md").write_text(
        table(["species", "birds", *(f"{words}, {name}" for words in ("tracked", "share of time") for name in SENSORS)], rows), encoding="utf-8")
    (options.out / "tracks-settings.md").write_text(table(["settings", "sensor", *SHOWN], by_settings(tracks, options.out / "settings")), encoding="utf-8")
    (options.out / "tracks-empty.md").write_text(
        table(["settings", SHOWN[-1], "tracks of vehicles an hour"], without_birds(options.out / "empty")), encoding="utf-8")
    shutil.copyfile(tracks / "hongqiao-Search1550-scan.png", options.out / "scan.png")
    with open(tracks / "card.csv", newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


if __name__ == "__main__":
    print(len(main()), "scores")
