#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a study, or brings tables and pictures of studies into Documentation/.

    Testing/Studies/run.py room --only-main                  one study; --help says what it takes
    Testing/Studies/run.py pages room birds                  runs these and brings them into the pages
    Testing/Studies/run.py pages                             all that take minutes at most; wants the data folder
    Testing/Studies/run.py pages --from build/paper airport  runs nothing: results are in folders of these names

The Python package is that of build/paraview, unless PYTHONPATH names another. Some pictures need a display
(`xvfb-run -a`), some studies the folder that AVIANLIDAR_DATA_DIR names; where AVIANLIDAR_SCENES_DIR names the scenes
that the build makes of it, some measure those, too.
"""
import importlib
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
FOLDERS = [folder for home in (HERE, HERE.parents[1] / "Examples") for folder in home.iterdir() if folder.is_dir()]
sys.path[:0] = map(str, [*FOLDERS, HERE.parent / "Python", HERE.parents[1] / "Documentation"])
BUILT = HERE.parents[1] / "build" / "paraview" / "python-path"
sys.path += BUILT.read_text(encoding="utf-8").strip().split(":") if BUILT.exists() else []
import page_tables  # noqa: E402
import tools  # noqa: E402

# Pictures of pages, by study: {picture: name in Documentation/images}; and studies of which pages have tables alone.
PICTURES = {
    "accuracy_page": {"airport16-energy": "accuracy-airport16-energy"},
    "airport": {"Airport16-top": "airport-top-16"},
    "airport_search": {"tree": "search-tree"},
    "airport_time": {"revolutions": "time-revolutions"},
    "beam_shapes": {"shapes": "beams-shapes"},
    "birds": {"species": "birds-species", "detection": "birds-detection"},
    "birds_over_airport": {"from-above": "birds-over-airport", "range": "birds-range-image"},
    "check_fit": {"silver-metallic-paint": "materials-silver-metallic-paint"},
    "corridor": {"corridor": "corridor-corridor"},
    "design": {"head": "design-head"},
    "first_picture": {"airport": "airport-birds", "moving": "airport-birds-moving"},
    "origins": {"platforms": "moving-platforms", "moving": "moving-platforms-moving"},
    "paper": {"facade": "paper-facade", "terminal-1": "paper-terminal-1"},
    "patterns": {"prisms": "sensors-prisms", "rotors": "sensors-rotors"},
    "predicted_measured": {"least": "measured-least"},
    "ranges": {"ranges": "coverage-ranges"},
    "recordings": {"ranges": "recordings-ranges"},
    "render_notebook": {"energy-image": "python-range-image"},
    "report_card": {"scan": "tracks-scan"},
    "room": {"xt32-ranges": "room-xt32-ranges"},
    "scores": {"curves-neubrandenburg": "bench-neubrandenburg"},
    "screenshots": {"head": "coverage-report"},
    "waveforms": {"waveforms": "waveforms-gull"},
    "weather": {"weather": "weather"},
    "your_airport": {"airport": "your-airport"},
}
DATA = {"ranges": ("ranges.json", "Python/avianlidar/apps/inputs")}  # numbers that the package holds, by study
TABLES = ("advice", "attenuation", "coverage_costs", "detail", "falloff", "intervals", "media_time", "mirror_lobes",
          "more_reflections", "moved_scenes", "multiple_scattering", "others", "paper_times", "presets", "protocol",
          "quadcopter", "second_reflection", "sequence_costs", "tracked_gulls", "vegetation")
LONG = ("accuracy_page", "sequence_costs")  # only when they are named


def pages(words):
    """Run what is named, or take results that are there, and bring them into the pages."""
    folder, run = pathlib.Path("build"), True
    if words[:1] == ["--from"]:
        folder, run, words = pathlib.Path(words[1]), False, words[2:]
    for name in words or [name for name in (*PICTURES, *TABLES) if name not in LONG]:
        out = folder / name
        if run:
            importlib.import_module(name).main(["--out", str(out)])
        for picture, target in PICTURES.get(name, {}).items():
            (file,) = (file for file in out.glob(f"{picture}.*") if file.suffix in (".png", ".webp"))
            shutil.copyfile(file, page_tables.DOCUMENTATION / "images" / f"{target}{file.suffix}")
        for name_of_file, target in [DATA[name]] if name in DATA else ():
            shutil.copyfile(out / name_of_file, HERE.parents[1] / target / name_of_file)
        for table in out.glob("*.md"):
            shown = name if table.stem == "table" else table.stem
            if not page_tables.put(shown, table.read_text(encoding="utf-8")):
                print(f"{shown}: no page has this table")


def main(words):
    files = (file for folder in FOLDERS for file in folder.glob("*.py"))
    known = {file.stem for file in files if "\ndef main(" in file.read_text(encoding="utf-8")}
    if not words or words[0] not in {"pages", *known}:
        sys.exit(f"{__doc__}\nStudies: {', '.join(sorted(known))}")
    work = pages if words[0] == "pages" else importlib.import_module(words[0]).main
    code = tools.run(lambda: work(words[1:]))
    sys.exit(code if isinstance(code, int) else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
