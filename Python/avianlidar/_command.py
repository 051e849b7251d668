# SPDX-License-Identifier: BSD-3-Clause
"""The command `avianlidar`, also `python3 -m avianlidar`: its arguments and how it ends. `_verbs` does the work."""
from __future__ import annotations

import argparse
import math
import os
import pathlib
import re
import sys
import traceback
import warnings
from typing import Any, List, Optional

from ._suffixes import READERS, WRITERS, listed
from ._weather import WEATHER

WRITTEN, READ = listed(WRITERS), listed(READERS)
PRESETS = {"Preview": "100 rays alone, one reflection: 7.7 %%, 0.07 s; 9.2 %%, 0.08 s", "Draft": "0.41 %%, 0.13 s; 0.97 %%, 0.52 s",
           "Standard": "0.21 %%, 0.24 s; 0.40 %%, 0.94 s", "Reference": "0.12 %%, 0.85 s; 0.14 %%, 4.4 s",
           "Paper": "the paper's method, its noise of 100 rays: 16 %%, 0.11 s; 16 %%, 0.16 s"}
SCENE = "a mesh (STL, OBJ, PLY, glTF, VTP, ...; metres, z up) or a .lidarscene.json file"

# By verb: what it does in a few words, in a sentence, and examples.
VERBS = {
    "scan": ("one scan of a scene", "One scan of a scene, written as one file or several.", """\
  avianlidar scan airport.lidarscene.json --sensor Search905 --position 0 0 3 -o echoes.las
  avianlidar scan hangar.stl --scale 0.001 --material Metal --position 0 -60 2 -o echoes.pcd -o range.png
  avianlidar scan airport.glb --sensor mine.lidarsensor.json --sensor-set range_gate=800 --scan-set rays_per_beam=400 -o echoes.csv
"""),
    "advise": ("the fastest settings for an error", "What a scene requires, measured on some beams of a scan: the fastest settings whose errors are surely below "
               "those asked, as options, in Python and for ParaView, and the share and the cost of second reflections, connections, density "
               "of rays, weather and processes.", """\
  avianlidar advise airport.lidarscene.json --sensor Search905 --position 0 0 3 --energy 0.02
  avianlidar advise hangar.stl --position 0 -60 2 --missed 0.005 --beams 4000 -o advice.json -o advice.png
"""),
    "info": ("what is in a file", "What is in a file: a scene or a mesh, a cloud, a sensor, a plan, a scenario.", """\
  avianlidar info hangar.stl
  avianlidar info echoes.las
"""),
    "compare": ("how far two clouds are apart", "Distances between the nearest points of two clouds: Hausdorff and root mean "
                "square (paper, Eq. 19 and 20), density-aware Chamfer distance.", """\
  avianlidar compare simulated.las measured.pcd
  avianlidar compare simulated.las measured.pcd -o distances.vtp
"""),
    "convert": ("a cloud in another format", "A cloud in another format; names and units of arrays go with it as far as both "
                "formats have them. A labelled sequence as one file of ROS 2 messages (MCAP).", """\
  avianlidar convert echoes.las echoes.pcd
  avianlidar convert drive.pcap revolution.ply --sensor-address 192.168.1.201 --time 12.5
  avianlidar convert sequences/sequences/00 sequence.mcap
"""),
    "airport": ("a scene and plans of an airport from a map", "A scene file, plans of coverage and siting, a scenario and a picture of an "
                "airport, from an extract of OpenStreetMap or another map. A further run keeps files that were edited.", """\
  avianlidar airport extract.osm.pbf --heights terrain.tif -o my-airport
  avianlidar airport county.geojson --icao EDBN -o edbn
"""),
    "sequence": ("labelled scans of birds, to train on", "Labelled scans of a scenario in the layout of SemanticKITTI. Started "
                 "again it goes on where it was; `mpiexec -n 2 pvbatch --sym -m avianlidar` shares the work.", """\
  avianlidar sequence hongqiao.scenario.json -o sequences --scans 100
  avianlidar sequence hongqiao.scenario.json -o still --sensor-set sway_amplitude=0 --sensor-set encoder_jitter=0
"""),
    "track": ("tracks of birds in labelled scans, and how good they are", "A report card (HTML, CSV) of tracks in sequences: share of birds tracked, delay, identity "
              "switches, false tracks an hour, warning time. A scenario is made first. Several are compared. Started again it goes on where it was; "
              "`mpiexec -n 2 pvbatch --sym -m avianlidar` shares the work.", """\
  avianlidar track sequences -o tracks --runways hongqiao.geojson
  avianlidar track hongqiao.scenario.json -o tracks --sensor Search905 --sensor Search1550 --scans 500
"""),
    "bench": ("clutter filters held against labels", "Predictions for labelled sequences, in SemanticKITTI's format, held against their labels: a page (HTML) and "
              "tables (CSV) with recall at one false point a scan, IoU, curves, tracks lost, by subset, range and species.", """\
  avianlidar bench sequences --predictions mine -o scores
  avianlidar bench airport airport-rain --predictions trees network --first 8 -o scores
"""),
    "coverage": ("maps of where a bird would be detected", "Maps of where a bird would be detected, and why not elsewhere "
                 "(GeoTIFF, GeoJSON), shares (CSV) and clutter (VTP), by a plan: a folder for each sensor if the plan compares "
                 "some.", """\
  avianlidar coverage hongqiao.coverage.json -o maps --coverage-set species=crow
"""),
    "siting": ("where lidars should stand", "Candidates by rank (CSV, GeoJSON, VTP), the best networks and what changes them, by a "
               "plan. Started again it goes on where it was; `mpiexec -n 2 pvbatch --sym -m avianlidar` shares the work.", """\
  avianlidar siting hongqiao.coverage.json -o sites --siting-set spacing=100
"""),
    "design": ("what the lidar must be for an asked share", "Designs within the bounds of a plan: which is the cheapest that detects or tracks the share of birds "
               "that is asked for (HTML, CSV). Started again it goes on where it was; `mpiexec -n 2 pvbatch --sym -m avianlidar` shares the work.", """\
  avianlidar design hongqiao-design.coverage.json -o design --design-set share=0.4
"""),
    "report": ("maps, sections, shares and sites as one page of HTML", "One page of HTML that needs no network, by a plan; tables "
               "and pictures are in a folder beside it.", """\
  avianlidar report hongqiao.coverage.json -o report.html
"""),
    "reach": ("how far birds are seen", "How far one scan of a sensor detects birds within its beams, in free air, with the ranges that the fit of its receiver "
              "leaves open.", """\
  avianlidar reach --sensor OS1_64 --species "herring gull"
  avianlidar reach --sensor Search905 --sensor VLP16 --species crow --weather fog:1000
"""),
    "sensors": ("sensors that are known by name", "Sensors that are known by name; with a name, that one; with --fit, a receiver fitted to the points of a sheet.", """\
  avianlidar sensors
  avianlidar sensors VLP-16
  avianlidar sensors --fit my.lidarsensor.json -o fitted.lidarsensor.json
"""),
    "materials": ("materials that are known by name", "Materials that are known by name, with their coefficients and sources.", """\
  avianlidar materials
"""),
}


class Parser(argparse.ArgumentParser):
    """A bad argument ends with one line and the exit code 2."""

    def __init__(self, *args: Any, **options: Any):
        super().__init__(*args, **options)
        self._negative_number_matcher = re.compile(r"^-\d*\.?\d+([eE][-+]?\d+)?$")  # also -5e0, which argparse takes for an option

    def error(self, message: str):
        self.exit(2, f"{self.prog}: {message} (--help says more)\n")


def _value(text: str) -> Any:
    """`name=value` as it is meant: finite numbers, tables of them by commas, switches, words."""
    def one(word):
        try:
            value = float(word)
        except ValueError:
            return {"on": True, "true": True, "yes": True, "off": False, "false": False, "no": False}.get(word.lower(), word)
        if not math.isfinite(value):
            raise argparse.ArgumentTypeError(f"{text} is not a finite number")
        return int(value) if value.is_integer() and abs(value) < 2**53 else value
    name, equals, value = text.partition("=")
    if not equals or not name:
        raise argparse.ArgumentTypeError(f"expected name=value, not '{text}'")
    parts = [one(word) for word in value.split(",")]
    return name, parts[0] if len(parts) == 1 else tuple(parts)


def _settings(verb, **examples: str) -> None:
    """Options that set parts of what a verb does. @param examples by part: one, or all words of the help"""
    for part, words in examples.items():
        help = words if " " in words else f"a property of the {part}, for example {words}; may be given many times"
        verb.add_argument(f"--{part}-set", action="append", default=[], type=_value, metavar="NAME=VALUE", help=help)


def _weather(verb, threads: bool = False) -> None:
    verb.add_argument("--weather", nargs="+", metavar="KIND:NUMBER", help=WEATHER)
    if threads:
        _threads(verb)


def _threads(verb) -> None:
    verb.add_argument("--threads", type=int, default=0, help="default 0: as many as there are cores")


def _out(verb, what: str, **options: Any) -> None:
    verb.add_argument("-o", "--out", type=pathlib.Path, help=what, **{"required": True, **options})


SENSOR = "a name that `avianlidar sensors` lists, or a .lidarsensor.json file"
MANY = "may be given many times"


def parser() -> Parser:
    """The command's arguments."""
    from ._version import __version__
    raw = argparse.RawDescriptionHelpFormatter
    whole = Parser(prog="avianlidar", description="Simulates what a bird-watching lidar receives.", formatter_class=raw,
                   epilog="examples:\n" + "".join(examples.splitlines(True)[0] for _, _, examples in VERBS.values()))
    whole.add_argument("--version", action="version", version=f"avianlidar {__version__}")
    verbs = whole.add_subparsers(dest="verb", required=True, metavar="verb", parser_class=Parser)
    verb = {name: verbs.add_parser(name, help=words, description=sentence, epilog="examples:\n" + examples, formatter_class=raw)
            for name, (words, sentence, examples) in VERBS.items()}

    for name in ("scan", "advise"):
        add = verb[name].add_argument
        add("scene", help=SCENE)
        add("--sensor", default="Airport16", help=f"{SENSOR}; default Airport16")
        add("--position", nargs=3, type=float, metavar=("X", "Y", "Z"),
            help="of the sensor, m; default: where the scene says, else 0 0 0")
        add("--material",
            help="of the whole scene, a name that `avianlidar materials` lists; default: what the file says, else Wall")
        add("--scale", type=float, help="metres of a mesh's unit, 0.001 for millimetres; default 1")
        add("--up-axis", choices=("y", "z"), help="of a mesh: the axis that points up; default: as its format has it")
        if name == "scan":
            _out(verb[name], f"file: {WRITTEN}; .png is a picture of the range image; {MANY}", action="append")
            add("--quiet", action="store_true", help="no lines on what was modelled and what was left out")
            add("--preset", choices=tuple(PRESETS), help="fidelity by name, with its error of energy and seconds of one core for 15,360 beams at the "
                f"airport, and with masts and fences there: {', '.join(f'{name} ({words})' for name, words in PRESETS.items())}; "
                "Paper also builds the tree of the paper; default: 100 rays, 2 connections (0.23 %%, 0.15 s; 0.57 %%, 1.0 s)")
        else:
            add("--energy", type=float, default=0.02, metavar="SHARE", help="error of energies that is allowed, rms, relative; default 0.02")
            add("--range", type=float, default=0.05, metavar="METRES", help="error of ranges that is allowed, rms, m; default 0.05")
            add("--missed", type=float, default=0.01, metavar="SHARE",
                help="echoes that may be missed or invented, of the true ones; default 0.01")
            add("--beams", type=int, default=1000, help="to measure on; default 1000")
            _out(verb[name], f"file: .json (all), .csv (the table) or .png (a picture); {MANY}", action="append", required=False, default=[])
        _settings(verb[name], sensor="range_gate=800", scan="rays_per_beam=400")
        _weather(verb[name], threads=True)

    verb["info"].add_argument("file", type=pathlib.Path, help="a scene, mesh, cloud, sensor, plan or scenario")
    verb["info"].add_argument("--quiet", action="store_true", help="of a cloud no lines on what was modelled and what was left out")
    verb["compare"].add_argument("a", type=pathlib.Path, help=f"a cloud: {READ}")
    verb["compare"].add_argument("b", type=pathlib.Path, help="another one, in the same coordinates")
    _out(verb["compare"], "file: the first cloud, with nearest_distance (m) of every point", required=False)
    verb["convert"].add_argument("file", type=pathlib.Path, help=f"a cloud: {READ}; or the folder of a sequence")
    verb["convert"].add_argument("out", type=pathlib.Path, help=f"file: {WRITTEN}; of a sequence .mcap")
    for name in ("info", "compare", "convert"):
        add = verb[name].add_argument
        add("--sensor-address", metavar="ADDRESS",
            help="of packets (.pcap): the sensor, as 192.168.1.201 or 192.168.1.201:2368; default: the only one")
        add("--time", type=float, metavar="S", help="of packets: the revolution at that time, seconds since the full hour; default: the first")
    verb["sensors"].add_argument("name", nargs="?", help="one of them, or a .lidarsensor.json file")
    verb["sensors"].add_argument("--fit", metavar="FILE", help="a sensor file with a sheet, or a name: its receiver fitted to all "
                                 "points of the sheet; needs SciPy")
    _out(verb["sensors"], "file: the sensor with the fitted receiver (.lidarsensor.json)", required=False)

    add = verb["airport"].add_argument
    add("extract", type=pathlib.Path, help="of a map: .osm, .osm.pbf, .geojson, .gpkg")
    add("--heights", type=pathlib.Path, metavar="DEM", help="of the ground: a GeoTIFF, ASCII grid, SRTM .hgt or GDAL .vrt; default: level")
    add("--obstacles", type=pathlib.Path, metavar="FILE", action="append", default=[],
        help="surveyed obstacles: AIXM 5.1 (.xml), or .csv with columns longitude, latitude, height, unit, kind; may be repeated")
    which = verb["airport"].add_mutually_exclusive_group()
    which.add_argument("--icao", metavar="CODE", help="of the airport, where the extract holds several")
    which.add_argument("--bounds", nargs=4, type=float, metavar=("W", "S", "E", "N"),
                       help="degrees: the scene holds what lies inside; default: 2 km around the runways")
    _out(verb["airport"], "folder")

    add = verb["reach"].add_argument
    add("--sensor", action="append", required=True, help=f"{SENSOR}; {MANY}")
    add("--species", action="append", help=f"of the bird, default herring gull; {MANY}")
    _settings(verb["reach"], sensor="range_gate=800")
    _weather(verb["reach"])
    _out(verb["reach"], "file: .csv, shares by range", required=False)

    add = verb["sequence"].add_argument
    add("scenario", help="a scenario file, or the manifest.json of another sequence")
    add("--scans", type=int, help="number of scans, instead of the scenario's")
    _out(verb["sequence"], "folder")
    _settings(verb["sequence"], sensor="range_gate=800", scan="rays_per_beam=400")
    _weather(verb["sequence"], threads=True)

    add = verb["track"].add_argument
    add("inputs", nargs="+", help="folders that `avianlidar sequence` has made, or scenario files")
    add("--runways", type=pathlib.Path, help="a GeoJSON file with lines of kind runway: how long before strip and glide path a bird is tracked")
    add("--sensor", action="append", default=[],
        help=f"of scenarios, in place of their own: a name or a .lidarsensor.json file; {MANY}")
    add("--scans", type=int, help="number of scans of scenarios, instead of their own")
    add("--learn", type=int, default=20,
        help="scans at the beginning of a sequence of which only clutter is learned; default 20")
    add("--cutoff", type=float, default=20.0,
        help="m: a track this far from a bird does not count as its track; also the cutoff of OSPA; default %(default)g")
    add("--order", type=float, default=2.0, help="of OSPA, default %(default)g")
    _out(verb["track"], "folder")
    _settings(verb["track"], clutter="clutter_threshold=0.1", tracker="confirm_hits=2")
    _weather(verb["track"], threads=True)

    add = verb["bench"].add_argument
    add("folders", nargs="+", type=pathlib.Path, help="folders that `avianlidar sequence` has made")
    add("--predictions", nargs="+", type=pathlib.Path, required=True, help="folders with sequences/NN/predictions/NNNNNN.label, and .score "
        "(float32) if scores are known; of several sets in a folder with the set's name each")
    add("--sequences", nargs="+", default=[], metavar="NN", help="numbers of the sequences that are scored, as 02; default: all")
    add("--first", type=int, default=0, help="scan of each sequence from which on it is scored, default 0")
    _out(verb["bench"], "folder")

    for name in ("coverage", "siting", "design", "report"):
        add = verb[name].add_argument
        add("plan", help="a .coverage.json file")
        _out(verb[name], "file: .html" if name == "report" else "folder")
        _settings(verb[name], sensor="range_gate=3000", coverage="species=crow")
        _weather(verb[name])
        if name != "coverage":
            add("--metar", type=pathlib.Path, help="file of METAR reports: the year's weather by the hour, of which shares are")
        if name in ("siting", "report"):
            _settings(
                verb[name], siting="a part of the plan's siting, for example spacing=100; files are named from the plan's folder")
        if name == "design":
            _settings(verb[name], design="a part of the plan's design, for example share=0.4 or designs=500")
        if name != "siting":  # one thread a site; ranks share them
            _threads(verb[name])
    return whole


def main(argv: Optional[List[str]] = None) -> int:
    """Run the command. @return 0; 2 after an error, which is said in one line"""
    from . import _terminal, _verbs
    from ._pipeline import words_of
    from ._ranks import Ranks
    sys.stdout = sys.stdout or open(os.devnull, "w", encoding="utf-8")  # of daemons
    sys.stderr = sys.stderr or open(os.devnull, "w", encoding="utf-8")
    options = parser().parse_args(argv)
    code = 2
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_, **__: _terminal.warn(str(message))
            getattr(_verbs, options.verb)(options)
            sys.stdout.flush()
        code = 0
    except KeyboardInterrupt as stop:
        code = 130
        _terminal.say(": ".join(("stopped", *map(str, stop.args))))
    except BrokenPipeError:  # as `| head` leaves it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 141
    except ImportError as error:
        _terminal.say(f"{error}; this verb needs the Python module")
    except (RuntimeError, OSError, ValueError, TypeError, LookupError, ArithmeticError, Warning) as error:
        _terminal.say(words_of(error))
    finally:  # also after what is not expected, which is raised with its traceback
        if code != 141:
            sys.stdout.flush()
        if code and Ranks().size > 1:
            if sys.exc_info()[0]:
                traceback.print_exc()
            sys.stderr.flush()
            os._exit(code)  # the other ranks must not wait for this one
    return code
