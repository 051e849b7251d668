#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the examples and brings their pictures and tables into Documentation/: advise.md, airport.md, birds.md,
collision-detection.md, corridor.md, coverage.md, design.md, echoes.md, paper.md, python.md, sensors.md, sequences.md, time.md, tracks.md and, where AVIANLIDAR_DATA_DIR
names the folder of their data, results/reality.md, results/falloff.md, results/materials.md, crowns in weather.md and your-airport.md say what a run of what is
committed gives. Where AVIANLIDAR_SCENES_DIR names the scenes that the build makes of them, more reflections are followed in
those, too.

    PYTHONPATH=$(cat build/paraview/python-path) xvfb-run -a /usr/bin/python3 Examples/make_doc_images.py [notebook room]
    make_doc_images.py --from build/paper corridor airport     runs nothing: results are in folders of these names
"""
import os
import pathlib
import re
import shutil
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
DOCUMENTATION = HERE.parent / "Documentation"
sys.path[:0] = [str(HERE / folder) for folder in ("common", "airport", "birds", "corridor", "coverage", "design", "materials", "measured",
                                                  "notebook", "outdoor", "paper", "reflections", "room", "sensors", "sequence",
                                                  "weather", "accuracy_speed")]
import advice  # noqa: E402
import airport  # noqa: E402
import airport_search  # noqa: E402
import airport_time  # noqa: E402
import attenuation  # noqa: E402
import beam_shapes  # noqa: E402
import birds  # noqa: E402
import birds_over_airport  # noqa: E402
import check_fit  # noqa: E402
import corridor  # noqa: E402
import design  # noqa: E402
import detail  # noqa: E402
import falloff  # noqa: E402
import labels  # noqa: E402
import media_time  # noqa: E402
import more_reflections  # noqa: E402
import multiple_scattering  # noqa: E402
import others  # noqa: E402
import paper  # noqa: E402
import patterns  # noqa: E402
import predicted_measured  # noqa: E402
import protocol  # noqa: E402
import quadcopter  # noqa: E402
import ranges  # noqa: E402
import render_notebook  # noqa: E402
import report_card  # noqa: E402
import room  # noqa: E402
import screenshots  # noqa: E402
import second_reflection  # noqa: E402
import tracked_gulls  # noqa: E402
import vegetation  # noqa: E402
import weather  # noqa: E402
import your_airport  # noqa: E402

# Name of the run, what runs, its arguments, {picture: name in Documentation/images}.
RUNS = (
    ("airport", airport, [], {"Airport16-top": "airport-top-16", "Airport32-top": "airport-top-32",
                              "Airport16-close": "airport-terminal-1-16", "Airport32-close": "airport-terminal-1-32",
                              "Airport16-range": "airport-range-16"}),
    ("airport-all-wall", airport, ["--all-wall"], {"Airport32-close": "airport-terminal-1-32-all-wall"}),
    ("time", airport_time, [], {"sweep": "time-sweep", "revolutions": "time-revolutions"}),
    ("search", airport_search, [], {"tree": "search-tree", "status": "search-status", "cost": "search-cost"}),
    ("corridor", corridor, [], {"door": "corridor-door", "stairwell": "corridor-stairwell",
                                "corridor": "corridor-corridor", "range": "corridor-range", "top": "corridor-top"}),
    ("paper", paper, [], {"facade": "paper-facade"}),
    ("protocol", protocol, [], {}),
    ("attenuation", attenuation, [], {}),
    ("more-reflections", more_reflections, [], {}),
    ("second-reflection", second_reflection, [], {}),
    ("birds", birds, [], {"species": "birds-species", "detection": "birds-detection"}),
    ("birds-over-airport", birds_over_airport, [], {"from-above": "birds-over-airport", "range-image": "birds-range-image",
                                                    "points": "birds-points"}),
    ("coverage", screenshots, [], {"head": "coverage-report", "maps": "coverage-maps", "reasons": "coverage-reasons",
                                   "section": "coverage-section", "weather": "coverage-weather", "sites": "coverage-sites"}),
    ("design", design, [], {"head": "design-head"}),
    ("ranges", ranges, [], {"ranges": "coverage-ranges"}),
    ("shapes", beam_shapes, [], {"shapes": "beams-shapes"}),
    ("patterns", patterns, [], {"prisms": "sensors-prisms", "rotors": "sensors-rotors"}),
    ("sequence", labels, [], {"labels": "sequences-labels"}),
    ("tracks", report_card, [], {"scan": "tracks-scan"}),
    ("tracked-gulls", tracked_gulls, [], {}),
    ("quadcopter", quadcopter, [], {"points": "measured-quadcopter"}),
    ("weather", weather, [], {"weather": "weather"}),
    ("weather-media", media_time, [], {}),
    ("weather-others", others, [], {}),
    ("weather-multiple", multiple_scattering, [], {}),
    ("notebook", render_notebook, [], {"energy-image": "python-range-image", "map": "python-map"}),
)

# Those that need the data folder.
DATA_RUNS = (
    ("advice", advice, [], {}),
    ("room", room, [], {"errors": "room-errors", "xt32-clouds": "room-xt32-clouds", "xt32-ranges": "room-xt32-ranges",
                        "pandar40p-clouds": "room-pandar40p-clouds", "xt32-intensity": "room-xt32-intensity"}),
    ("detail", detail, [], {}),
    ("your-airport", your_airport, [], {"airport": "your-airport"}),
    ("measured", predicted_measured, [], {"ground": "measured-ground", "least": "measured-least"}),
    ("falloff", falloff, [], {"signal": "falloff-signal", "beams": "falloff-beams"}),
    ("weather-vegetation", vegetation, [], {}),
    ("materials", check_fit, [], {"silver-metallic-paint": "materials-silver-metallic-paint"}),
)


def put_table(name, table):
    """Between the lines <!-- table: name --> and <!-- end --> of every page."""
    for page in DOCUMENTATION.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        block = rf"(<!-- table: {name} -->\n).*?(<!-- end -->)"
        page.write_text(re.sub(block, lambda m: m[1] + table + m[2], text, flags=re.S), encoding="utf-8")


def main(wanted=()):
    """All of them, or those named; after --from FOLDER those whose results are there."""
    done = pathlib.Path(wanted[1]) if wanted[:1] == ["--from"] else None
    wanted = wanted[2:] if done else wanted
    images = DOCUMENTATION / "images"
    images.mkdir(exist_ok=True)
    known = (*RUNS, *DATA_RUNS) if os.environ.get("AVIANLIDAR_DATA_DIR") else RUNS
    runs = [run for run in known if not wanted or run[0] in wanted]
    with tempfile.TemporaryDirectory() as folder:
        for name, example, arguments, pictures in runs:
            out = (done or pathlib.Path(folder)) / name
            if not done:
                example.main([*arguments, "--out", str(out)])
            for picture, target in pictures.items():
                shutil.copyfile(out / f"{picture}.png", images / f"{target}.png")
            for table in out.glob("*.md"):
                put_table(name if table.stem == "table" else table.stem, table.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main(sys.argv[1:])
