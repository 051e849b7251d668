#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The labelled sequences of the bench: to train and to test at Hongqiao, to tune at Honolulu, to test at Neubrandenburg.

    PYTHONPATH=$(cat build/paraview/python-path) AVIANLIDAR_DATA_DIR=... /usr/bin/python3 Examples/filter_bench/sets.py --out build/bench

Each place has a set in fair weather and one in rain, of five sequences with birds and noise of their own. Honolulu and Neubrandenburg are
made of files that are no part of the project: AVIANLIDAR_DATA_DIR is their folder, and without it only Hongqiao is made. --scans makes
longer sequences. Started again it goes on where it was.
"""
import json
import os
import pathlib
import sys

from avianlidar._command import main as avianlidar

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
import running  # noqa: E402

TEMPLATES = HERE.parents[1] / "Testing" / "Data" / "Scenes"  # scenes of files in the data folder
SEQUENCES = 5
RAIN = "rain:2"  # mm/h
# Scenario and seed by name. What is learned comes from the first alone.
PLACES = {"hongqiao-train": (HERE.parent / "sequence" / "hongqiao.scenario.json", 1), "hongqiao": (HERE.parent / "sequence" / "hongqiao.scenario.json", 11),
          "honolulu": (HERE / "honolulu.scenario.json", 2), "neubrandenburg": (HERE / "neubrandenburg.scenario.json", 3)}


def scenario_of(name, out, rainy, scans):
    """Write the scenario of a set, and its scene if that is made of the data folder. @return the file, None without the folder"""
    file, seed = PLACES[name]
    scenario = json.loads(file.read_text(encoding="utf-8"))
    template = TEMPLATES / f"{scenario['scene']}.in"
    scene = (file.parent / scenario["scene"]).resolve()
    if template.exists():
        data = os.environ.get("AVIANLIDAR_DATA_DIR")
        if not data:
            return None
        scene = out / scenario["scene"]
        scene.write_text(template.read_text(encoding="utf-8").replace("@AVIANLIDAR_DATA_DIR@", data), encoding="utf-8")
    scenario.update(scene=str(scene), seed=seed, number_of_scans=SEQUENCES * scans, scans_per_sequence=scans,
                    **({"weather": [RAIN], "scan": {key: value for key, value in scenario["scan"].items() if key != "attenuation_coefficient"}}
                       if rainy else {}))
    made = out / f"{name}{'-rain' if rainy else ''}.scenario.json"
    made.write_text(json.dumps(scenario, indent=1), encoding="utf-8")
    return made


def main(arguments=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/bench"), help="folder, default build/bench")
    parser.add_argument("--scans", type=running.whole(2, 10000), default=28, help="of a sequence in fair weather, default 28")
    parser.add_argument("--rain-scans", type=running.whole(2, 10000), default=12, help="of a sequence in rain, default 12")
    parser.add_argument("--only", nargs="*", choices=PLACES, default=list(PLACES), help="these places; default: all")
    parser.add_argument("--threads", type=running.whole(0, 1024), default=0, help="default 0: all cores")
    options = parser.parse_args(arguments)
    scenes = options.out / "scenarios"
    scenes.mkdir(parents=True, exist_ok=True)
    for rainy, scans in ((False, options.scans), (True, options.rain_scans)):
        for name in options.only:
            scenario = scenario_of(name, scenes.resolve(), rainy, scans)
            if scenario is None:
                print(f"{name}: not made, AVIANLIDAR_DATA_DIR is not set")
                continue
            if avianlidar(["sequence", str(scenario), "-o", str(options.out / "sets" / scenario.name.split(".")[0]),
                           "--threads", str(options.threads)]):
                return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
