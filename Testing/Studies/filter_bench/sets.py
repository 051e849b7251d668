# SPDX-License-Identifier: BSD-3-Clause
"""The labelled sequences of the bench: to train and to test at Hongqiao, to tune at Honolulu, to test at Neubrandenburg.

    AVIANLIDAR_DATA_DIR=... Testing/Studies/run.py sets

Each place has a set in fair weather and one in rain, of five sequences with birds and noise of their own. Honolulu and Neubrandenburg are
made of files that are no part of the project: AVIANLIDAR_DATA_DIR is their folder, and without it only Hongqiao is made. --scans makes
longer sequences. Started again it goes on where it was.
"""
import json
import os
import pathlib

from avianlidar._command import main as avianlidar
from running import argument, study, whole

HERE = pathlib.Path(__file__).resolve().parents[3]
SCENARIOS = HERE / "Examples" / "sequence"
TEMPLATES = HERE / "Testing" / "Data" / "Scenes"  # scenes of files in the data folder
SEQUENCES = 5
RAIN = "rain:2"  # mm/h
# Scenario and seed by name. What is learned comes from the first alone.
PLACES = {"hongqiao-train": ("hongqiao", 1), "hongqiao": ("hongqiao", 11), "honolulu": ("honolulu", 2),
          "neubrandenburg": ("neubrandenburg", 3)}


def scenario_of(name, out, rainy, scans):
    """Write the scenario of a set, and its scene if that is made of the data folder. @return the file, None without the folder"""
    place, seed = PLACES[name]
    file = SCENARIOS / f"{place}.scenario.json"
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


@study(argument("--scans", type=whole(2, 10000), default=28, help="of a sequence in fair weather, default 28"),
       argument("--rain-scans", type=whole(2, 10000), default=12, help="of a sequence in rain, default 12"),
       argument("--only", nargs="*", choices=PLACES, default=list(PLACES), help="these places; default: all"),
       argument("--threads", type=whole(0, 1024), default=0, help="default 0: all cores"), out="bench")
def main(options):
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
