#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the examples and brings their pictures and tables into Documentation/: airport.md and corridor.md say what a run
of what is committed gives.

    PYTHONPATH=$(cat build/paraview/python-path) xvfb-run -a /usr/bin/python3 Examples/make_doc_images.py
"""
import pathlib
import re
import shutil
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
DOCUMENTATION = HERE.parent / "Documentation"
sys.path[:0] = [str(HERE / folder) for folder in ("common", "airport", "corridor")]
import airport  # noqa: E402
import corridor  # noqa: E402

# Name of the run, what runs, its arguments, {picture: name in Documentation/images}.
RUNS = (
    ("airport", airport, [], {"Airport16-top": "airport-top-16", "Airport32-top": "airport-top-32",
                              "Airport16-close": "airport-terminal-1-16", "Airport32-close": "airport-terminal-1-32",
                              "Airport16-range": "airport-range-16"}),
    ("airport-all-wall", airport, ["--all-wall"], {"Airport32-close": "airport-terminal-1-32-all-wall"}),
    ("corridor", corridor, [], {"door": "corridor-door", "stairwell": "corridor-stairwell",
                                "corridor": "corridor-corridor", "range": "corridor-range", "top": "corridor-top"}),
)


def put_table(name, table):
    """Between the lines <!-- table: name --> and <!-- end --> of every page."""
    for page in DOCUMENTATION.glob("*.md"):
        text = page.read_text(encoding="utf-8")
        block = rf"(<!-- table: {name} -->\n).*?(<!-- end -->)"
        page.write_text(re.sub(block, lambda m: m[1] + table + m[2], text, flags=re.S), encoding="utf-8")


def main():
    images = DOCUMENTATION / "images"
    images.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        for name, example, arguments, pictures in RUNS:
            out = pathlib.Path(folder) / name
            example.main([*arguments, "--out", str(out)])
            for picture, target in pictures.items():
                shutil.copyfile(out / f"{picture}.png", images / f"{target}.png")
            put_table(name, (out / "table.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
