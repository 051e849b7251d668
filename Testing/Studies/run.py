#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a study, or brings tables and pictures of studies into Documentation/.

    Testing/Studies/run.py room --only-main                          one study; --help says what it takes
    Testing/Studies/run.py pages room birds                          runs these and brings them into the pages
    Testing/Studies/run.py pages                                     all that take minutes at most; wants the data folder
    Testing/Studies/run.py pages --from build/paper corridor airport     runs nothing: results are in folders of these names

The Python package is that of build/paraview, unless PYTHONPATH names another. Some pictures need a display (`xvfb-run -a`), some
studies the folder that AVIANLIDAR_DATA_DIR names; where AVIANLIDAR_SCENES_DIR names the scenes that the build makes of it, some
measure those, too.
"""
import importlib
import pathlib
import re
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
DOCUMENTATION = HERE.parents[1] / "Documentation"
FOLDERS = [folder for home in (HERE, HERE.parents[1] / "Examples") for folder in home.iterdir() if folder.is_dir()]
sys.path[:0] = map(str, [*FOLDERS, HERE.parent / "Python"])
BUILT = HERE.parents[1] / "build" / "paraview" / "python-path"
sys.path += BUILT.read_text(encoding="utf-8").strip().split(":") if BUILT.exists() else []
import tools  # noqa: E402

# Runs for pages, by name: {picture: name in Documentation/images}, arguments and module if it is called otherwise.
RUNS = {
    "accuracy_page": {f"{name}-{kind}": f"accuracy-{name}-{kind}" for name, kind in (
        ("airport16", "energy"), ("airport16", "range"), ("airport16", "detection"), ("corridor", "energy"))},
    "advice": {},
    "airport": {"Airport16-top": "airport-top-16", "Airport32-top": "airport-top-32", "Airport16-close": "airport-terminal-1-16",
                "Airport32-close": "airport-terminal-1-32", "Airport16-range": "airport-range-16"},
    "airport-all-wall": ({"Airport32-close": "airport-terminal-1-32-all-wall"}, "airport", "--all-wall"),
    "airport_search": {"tree": "search-tree", "status": "search-status", "cost": "search-cost"},
    "airport_time": {"sweep": "time-sweep", "revolutions": "time-revolutions"},
    "attenuation": {},
    "beam_shapes": {"shapes": "beams-shapes"},
    "birds": {"species": "birds-species", "detection": "birds-detection"},
    "birds_over_airport": {"from-above": "birds-over-airport", "range-image": "birds-range-image", "points": "birds-points"},
    "check_fit": {"silver-metallic-paint": "materials-silver-metallic-paint"},
    "corridor": {"door": "corridor-door", "stairwell": "corridor-stairwell", "corridor": "corridor-corridor", "range": "corridor-range",
                 "top": "corridor-top"},
    "design": {"head": "design-head"},
    "detail": {},
    "falloff": {"signal": "falloff-signal", "beams": "falloff-beams"},
    "labels": {"labels": "sequences-labels"},
    "media_time": {},
    "more_reflections": {},
    "multiple_scattering": {},
    "others": {},
    "paper": {"facade": "paper-facade", "terminal-1": "paper-terminal-1"},
    "paper_times": {},
    "patterns": {"prisms": "sensors-prisms", "rotors": "sensors-rotors"},
    "presets": {},
    "predicted_measured": {"ground": "measured-ground", "least": "measured-least"},
    "protocol": {},
    "quadcopter": {"points": "measured-quadcopter"},
    "ranges": {"ranges": "coverage-ranges"},
    "render_notebook": {"energy-image": "python-range-image", "map": "python-map"},
    "report_card": {"scan": "tracks-scan"},
    "room": {"errors": "room-errors", "xt32-clouds": "room-xt32-clouds", "xt32-ranges": "room-xt32-ranges",
             "pandar40p-clouds": "room-pandar40p-clouds", "xt32-intensity": "room-xt32-intensity"},
    "screenshots": {"head": "coverage-report", "maps": "coverage-maps", "reasons": "coverage-reasons", "section": "coverage-section",
                    "weather": "coverage-weather", "sites": "coverage-sites"},
    "second_reflection": {},
    "sequence_costs": {},
    "tracked_gulls": {},
    "vegetation": {},
    "weather": {"weather": "weather"},
    "your_airport": {"airport": "your-airport"},
}
LONG = ("accuracy_page", "sequence_costs")  # only when they are named


def put_table(name, text):
    """Between the lines <!-- table: name --> and <!-- end --> of every page."""
    for page in DOCUMENTATION.rglob("*.md"):
        old = page.read_text(encoding="utf-8")
        new = re.sub(rf"(<!-- table: {name} -->\n).*?(<!-- end -->)", lambda found: found[1] + text + found[2], old, flags=re.S)
        if new != old:
            page.write_text(new, encoding="utf-8")


def pages(words):
    """Run what is named, or take results that are there, and bring them into the pages."""
    folder, run = pathlib.Path("build"), True
    if words[:1] == ["--from"]:
        folder, run, words = pathlib.Path(words[1]), False, words[2:]
    for name in words or [name for name in RUNS if name not in LONG]:
        pictures, module, *arguments = RUNS[name] if isinstance(RUNS.get(name), tuple) else (RUNS.get(name, {}), name)
        out = folder / name
        if run:
            importlib.import_module(module).main([*arguments, "--out", str(out)])
        for picture, target in pictures.items():
            shutil.copyfile(out / f"{picture}.png", DOCUMENTATION / "images" / f"{target}.png")
        for table in out.glob("*.md"):
            put_table(name if table.stem == "table" else table.stem, table.read_text(encoding="utf-8"))


def main(words):
    known = {file.stem for folder in FOLDERS for file in folder.glob("*.py") if "\ndef main(" in file.read_text(encoding="utf-8")}
    if not words or words[0] not in {"pages", *known}:
        sys.exit(f"{__doc__}\nStudies: {', '.join(sorted(known))}")
    code = tools.run(lambda: pages(words[1:]) if words[0] == "pages" else importlib.import_module(words[0]).main(words[1:]))
    sys.exit(code if isinstance(code, int) else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
