#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plants changes that pictures must show, draws all pictures again, and says which baselines show each.

    Testing/Faults/pictures.py build/paraview -o pictures.csv     # three builds and four turns of the image tests

Each change patches source files, which are restored at the end. The exit code is 1 if a baseline does not show a change
that can occur in it. Testing/Python/TestPictures.py plants hues and shifts. A row of the table: change, baseline, image
error, whether the change can occur in the picture."""
import argparse
import csv
import os
import pathlib
import re
import subprocess
import sys

from faults import SOURCE, planted

MOST = float(re.search(r"^MOST = ([\d.]+)", (SOURCE / "Testing/Python/pictures.py").read_text("utf-8"), re.M)[1])
TESTS = "TestExamplePictures|TestImage|Plugin-Test(Pipeline|Macros-more)$"
ENERGIES = "^(Example(Airport|Corridor|Paper)|TestImageEcho|TestPipeline|TestFirstView)"
OUTPUT, SCAN = "Filters/Private/Echoes/vtkAvianLidarEchoOutput.cxx", "Filters/Kernel/Scan/Scan.cxx"
BAR, NOTHING = "axes.figure.colorbar(", "(lambda *_, **__: None)("
# Name, baselines in which it can occur, and for each file what is replaced by what.
CHANGES = (
    ("nothing", "^$", ()),
    ("energies times 0.9", ENERGIES, (
        (OUTPUT, "{ return all[i].energy; }", "{ return 0.9 * all[i].energy; }"),
        (OUTPUT, "{ return all[i].energyReceived; }", "{ return 0.9 * all[i].energyReceived; }"))),
    ("a missing tenth of the echoes", ENERGIES + "|^ExampleBirds|^TestImageRange", (
        (SCAN, "      block.beamOfEcho.resize(block.echoes.size(), b);\n",
         "      block.echoes.resize(b % 10 == 0 ? block.beamOfEcho.size() : block.echoes.size());\n"
         "      block.beamOfEcho.resize(block.echoes.size(), b);\n"),)),
    ("a missing legend", ".", (
        ("Testing/Cxx/TestImages.h", "    this->renderer->AddActor2D(bar);\n", ""),
        ("Testing/Cxx/TestImages.h", "  window.renderer->AddActor2D(legend);\n", ""),
        ("Testing/Plugin/TestPipeline.py", "points.SetScalarBarVisibility(view, True)", "pass"),
        *((f"Plugin/Macros/avian_lidar_{name}.py", "BarVisibility(view, True)", "BarVisibility(view, False)")
          for name in ("coverage", "energy_colours", "species_colours")),
        ("Python/avianlidar/_plot.py", "axes.figure.colorbar(mesh,", NOTHING + "mesh,"),
        ("Examples/airport/tools.py", BAR, NOTHING), ("Examples/corridor/corridor_pictures.py", BAR, NOTHING),
        ("Examples/birds/birds_over_airport.py", "axes.legend(", NOTHING))),
    ("no names, rings and beams", "^TestFirstView|^ExampleAirport-top", (
        ("Filters/vtkAvianLidarLandmarks.cxx", "drawings[port]->Fill(", "Drawing().Fill("),)),
    ("hues of classes", "^TestFirstView|^ExampleAirport(32)?-(top|close)|^ExamplePaper-airport|^TestCoverageImage.png", (
        ("Python/avianlidar/look.json", '"terminal": "#db9c95"', '"terminal": "#b39ad0"'),)),
    ("hues of species", "^TestFirstView-birds|^ExampleBirds", (
        ("Python/avianlidar/look.json", '"species": ["#0072b2"', '"species": ["#009e73"'),)))


def drawn(build):
    """{baseline: image error} of all pictures, drawn by the tests."""
    file = pathlib.Path(build) / "pictures.txt"
    file.unlink(missing_ok=True)
    subprocess.run([SOURCE / "Testing/run_ctest.sh", build, "-R", TESTS],
                   env={**os.environ, "AVIANLIDAR_PICTURES": str(file.resolve())}, stdout=subprocess.DEVNULL,
                   check=False)
    rows = [line.rsplit(" ", 1) for line in file.read_text("utf-8").splitlines()]
    return {name: float(error) for name, error in rows}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="a build folder of this source, with image tests")
    parser.add_argument("-o", "--out", default="pictures.csv", help="table")
    options = parser.parse_args()
    baselines = {file.name for file in (SOURCE / "Testing/Data/Baseline").glob("*.png")}
    rows, missed = [], 0
    for name, where, patches in CHANGES:
        with planted(patches):
            subprocess.run(["cmake", "--build", options.build], stdout=subprocess.DEVNULL, check=True)
            errors = drawn(options.build)
        if set(errors) != baselines:
            sys.exit(f"{name}: no picture of {sorted(baselines - set(errors))}, no baseline of "
                     f"{sorted(set(errors) - baselines)}")
        for baseline, error in sorted(errors.items()):
            occurs = bool(re.search(where, baseline))
            wrong = error <= MOST if occurs else name == "nothing" and error > MOST
            missed += wrong
            rows.append((name, baseline, f"{error:.4g}", int(occurs)))
            print(f"{name:32} {baseline:32} {error:10.4g}{'  WRONG' if wrong else ''}", flush=True)
    with open(options.out, "w", newline="", encoding="utf-8") as stream:
        csv.writer(stream).writerows([("change", "baseline", "image error", "can occur"), *rows])
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
