# SPDX-License-Identifier: BSD-3-Clause
"""Arguments and exit codes of the command `avianlidar` (also `python3 -m avianlidar`). `_verbs` does the work."""
import argparse
import contextlib
import math
import os
import pathlib
import re
import signal
import sys
import threading
import traceback
import warnings
from typing import Any

from ._suffixes import READERS, WRITERS, listed
from ._weather import WEATHER

WRITTEN, READ = listed(WRITERS), listed(READERS)
PRESETS = {"Preview": "100 rays alone, one reflection: 7.7 %%, 0.032 s; 9.2 %%, 0.038 s",
           "Draft": "0.41 %%, 0.11 s; 0.97 %%, 0.29 s", "Standard": "0.2 %%, 0.12 s; 0.4 %%, 0.47 s",
           "Reference": "0.12 %%, 0.51 s; 0.14 %%, 2.3 s",
           "Paper": "the paper's method, its noise of 100 rays: 16 %%, 0.2 s; 16 %%, 0.4 s"}
SENSOR = "a name that `avianlidar sensors` lists, or a .lidarsensor.json file"
MANY = "may be given many times"
RECORDING = ("a folder or a quoted pattern of numbered files, a bag of ROS (.mcap, .db3, .bag), packets, or a folder "
             "of SemanticKITTI or nuScenes")
RESUMES = "The same command continues a stopped run. `mpiexec -n 2 pvbatch --sym -m avianlidar` shares the work."

# For each verb: a few words, a description and examples.
VERBS = {
    "scan": ("one scan of a scene",
        "Scans a scene once and writes the echoes to one file or several.", """\
  avianlidar scan airport.lidarscene.json --sensor Search905 --position 0 0 3 -o echoes.las
  avianlidar scan airport.lidarscene.json --sensor Search905 --trajectory car.gpx --trajectory-set \
height_reference=clamp --position 0 0 2 -o echoes.las
  avianlidar scan hangar.stl --scale 0.001 --material Metal --position 0 -60 2 -o echoes.pcd -o range.png
  avianlidar scan airport.glb --sensor mine.lidarsensor.json --sensor-set range_gate=800 \
--scan-set rays_per_beam=400 -o echoes.csv
"""),
    "advise": ("the fastest settings for an error",
        "Measures on some beams of a scan which settings a scene requires. The advice is the fastest settings whose "
        "error bounds stay below the limits that you set, as options of the command, in Python and for ParaView. The "
        "advice also gives the share and the cost of second reflections, connections, density of rays, weather and "
        "processes.", """\
  avianlidar advise airport.lidarscene.json --sensor Search905 --position 0 0 3 --energy 0.02
  avianlidar advise hangar.stl --position 0 -60 2 --missed 0.005 --beams 4000 -o advice.json -o advice.png
"""),
    "info": ("what is in a file",
        "Shows what a file holds: a scene, a mesh, a cloud, a sensor, a plan, a scenario or recorded scans.", """\
  avianlidar info hangar.stl
  avianlidar info echoes.las
  avianlidar info drive.mcap
"""),
    "compare": ("how far two clouds, or a recording and the simulation of its scene, are apart",
        "Computes distances between the nearest points of two clouds: the median and other percentiles, the Hausdorff "
        "distance, the root mean square (paper, Eq. 19 and 20) and the density-aware Chamfer distance. For a scene and "
        "a recording, simulates the scene with the sensor at the recording's pose and writes a page (HTML, CSV) that "
        "compares echoes, ranges, intensities and drop-outs.", """\
  avianlidar compare simulated.las measured.pcd
  avianlidar compare simulated.las measured.pcd -o distances.vtp
  avianlidar compare airport.lidarscene.json drive.mcap --sensor OS1_64 --align -o compared
"""),
    "convert": ("a cloud in another format",
        "Writes a cloud in another format. Names and units of arrays are kept as far as both formats have them. A "
        "labelled sequence becomes one file of ROS 2 messages (.mcap, .db3). A recording becomes a folder of numbered "
        "files (.pcd).", """\
  avianlidar convert echoes.las echoes.pcd
  avianlidar convert drive.pcap revolution.ply --sensor-address 192.168.1.201 --time 12.5
  avianlidar convert sequences/sequences/00 sequence.mcap
  avianlidar convert drive.mcap scans
"""),
    "view": ("a scene with echoes, birds and coverage as one page that any browser opens",
        "Writes one page of HTML with a scene in three dimensions, which works without the internet: surfaces, echoes "
        "by energy, distance or class, the birds of a sequence, maps of coverage and tracks. One can turn, zoom, "
        "click, measure and save a picture.", """\
  avianlidar view airport.lidarscene.json echoes.vtp -o view.html
  avianlidar view airport.lidarscene.json --sequence sequences --coverage maps -o view.html
"""),
    "airport": ("a scene and plans of an airport from a map",
        "Writes a scene file, plans of coverage and siting, a scenario and a picture of an airport, from an extract "
        "of OpenStreetMap or another map. A second run keeps files that you have edited.", """\
  avianlidar airport extract.osm.pbf --heights terrain.tif -o my-airport
  avianlidar airport county.geojson --icao EDBN -o edbn
"""),
    "sequence": ("labelled scans of birds, to train on",
        f"Writes labelled scans of a scenario in the layout of SemanticKITTI. {RESUMES}", """\
  avianlidar sequence hongqiao.scenario.json -o sequences --scans 100
  avianlidar sequence hongqiao.scenario.json -o drive --trajectory car.gpx --scans 50
  avianlidar sequence hongqiao.scenario.json -o still --sensor-set sway_amplitude=0 --sensor-set encoder_jitter=0
"""),
    "track": ("tracks of birds in simulated or recorded scans",
        "Writes a report card (HTML, CSV) of tracks in sequences: share of birds tracked, delay, identity switches, "
        "false tracks an hour, warning time. Sequences of a scenario are made first. Several inputs are compared. "
        f"{RESUMES} For recorded scans, writes the tracks of all that moves, without scores (HTML, CSV, GeoJSON, a "
        "state for ParaView).", """\
  avianlidar track sequences -o tracks --runways hongqiao.geojson
  avianlidar track hongqiao.scenario.json -o tracks --sensor Search905 --sensor Search1550 --scans 500
  avianlidar track "scans/*.pcd" -o tracks --rate 10
  avianlidar track drive.mcap -o tracks --origin 31.1979 121.3363 3 --heading 12
"""),
    "bench": ("clutter filters compared with labels",
        "Compares predictions for labelled sequences (in SemanticKITTI's format) with the labels: a page (HTML) and "
        "tables (CSV) with recall at one false point a scan, IoU, curves and tracks lost, by subset, range and "
        "species.", """\
  avianlidar bench sequences --predictions mine -o scores
  avianlidar bench airport airport-rain --predictions trees network --first 8 -o scores
"""),
    "coverage": ("maps of where a bird would be detected",
        "Writes maps of where a bird would be detected and why it is missed elsewhere (GeoTIFF, GeoJSON), shares "
        "(CSV) and clutter (VTP) for a plan. A plan that compares sensors makes a folder for each sensor.", """\
  avianlidar coverage hongqiao.coverage.json -o maps --coverage-set species=crow
  avianlidar coverage hongqiao.coverage.json -o maps --tracks radar.csv
  avianlidar coverage hongqiao.coverage.json -o maps --trajectory drone.csv
"""),
    "siting": ("where lidars should stand",
        "Writes candidates by rank (CSV, GeoJSON, VTP), the best networks and what changes these networks, for a "
        f"plan. {RESUMES}", """\
  avianlidar siting hongqiao.coverage.json -o sites --siting-set spacing=100
"""),
    "design": ("the cheapest lidar design for a share of birds",
        "Finds, within the bounds of a plan, the cheapest design that detects or tracks the required share of birds "
        f"(HTML, CSV). {RESUMES}", """\
  avianlidar design hongqiao-design.coverage.json -o design --design-set share=0.4
"""),
    "report": ("maps, sections, shares and sites as one page of HTML",
        "Writes one page of HTML for a plan. The page needs no internet. Tables and pictures are in a folder beside "
        "it.", """\
  avianlidar report hongqiao.coverage.json -o report.html
"""),
    "reach": ("how far birds and other targets are seen",
        "Computes how far one scan of a sensor detects birds, boards, spheres, drones, people, walls or the ground "
        "within its beams, in free air, and the number of points at half of this range. In brackets stand the ranges "
        "of real units. What is assumed is marked.", """\
  avianlidar reach --sensor OS1_64 --species "herring gull"
  avianlidar reach --sensor Search905 --target board:0.5 --target wall --reflectance 0.1
  avianlidar reach --sensor OS1_64 --target ground --height 5
  avianlidar reach --sensor Search905 --species starling --flock 20
  avianlidar reach --sensor Search905 --birds my.csv
  avianlidar reach --sensor Search905 --sensor VLP16 --species crow --weather fog:1000
"""),
    "sensors": ("sensors that are known by name",
        "Lists the sensors that are known by name. With a name, shows the sensor. With --fit, fits a receiver to the "
        "points of a data sheet.", """\
  avianlidar sensors
  avianlidar sensors VLP-16
  avianlidar sensors --fit my.lidarsensor.json -o fitted.lidarsensor.json
"""),
    "materials": ("materials that are known by name",
        "Lists the materials that are known by name, with coefficients and sources.", "  avianlidar materials\n"),
}


class Parser(argparse.ArgumentParser):
    """A parser that answers a wrong argument with one line and the exit code 2."""

    def __init__(self, *args: Any, **options: Any):
        super().__init__(*args, **options)
        # With -5e0, which argparse would read as an option.
        self._negative_number_matcher = re.compile(r"^-\d*\.?\d+([eE][-+]?\d+)?$")

    def _print_message(self, message: str, file: Any = None) -> None:
        from ._terminal import shown
        super()._print_message(shown(message), file)

    def error(self, message: str):
        self.exit(2, f"{self.prog}: {message} (see --help)\n")


def _value(text: str) -> Any:
    """Name and value of `name=value`. The value is finite numbers, switches or words, separated by commas."""
    def one(word):
        try:
            value = float(word)
        except ValueError:
            switches = {**dict.fromkeys(("on", "true", "yes"), True), **dict.fromkeys(("off", "false", "no"), False)}
            return switches.get(word.lower(), word)
        if not math.isfinite(value):
            raise argparse.ArgumentTypeError(f"{text} is not a finite number")
        return int(value) if value.is_integer() and abs(value) < 2**53 else value
    name, equals, value = text.partition("=")
    if not equals or not name:
        raise argparse.ArgumentTypeError(f"expected name=value, not '{text}'")
    parts = [one(word) for word in value.split(",")]
    return name, parts[0] if len(parts) == 1 else tuple(parts)


def _settings(verb, **examples: str) -> None:
    """Adds an option --PART-set for each part. @param examples one example by part, or the whole help text"""
    for part, words in examples.items():
        help = words if " " in words else f"a property of the {part}, for example {words}; {MANY}"
        verb.add_argument(f"--{part}-set", action="append", default=[], type=_value, metavar="NAME=VALUE", help=help)


def _out(verb, what: str, required: bool = True, **options: Any) -> None:
    verb.add_argument("-o", "--out", type=pathlib.Path, help=what, required=required, **options)


def _trajectory(verb) -> None:
    """Adds the options of a sensor that moves."""
    verb.add_argument("--trajectory", metavar="FILE", help="trajectory of the car, drone or other platform that carries "
                      "the sensor: CSV, GPX, KML, VTP or a bag of ROS 2; times since 1970 count from its start")
    own = ", or position=0,0,2, the sensor's place on the platform" if verb.prog.endswith("coverage") else ""
    _settings(verb, trajectory="how the file is read, for example height_reference=clamp, which puts the platform on "
              f"the ground, or track=NAME{own}; {MANY}")


def _of_recording(add) -> None:
    """Adds the options that choose scans of a recording."""
    add("--rate", type=float, metavar="HZ", help="scans a second of a recording in numbered files; default: times in "
        "times.txt or timestamps.txt beside the files, or in their names, else 10 (assumed)")
    add("--topic", help="topic of the clouds in a bag, or scene of nuScenes; default: the only one")


def parser() -> Parser:
    """The parser of all arguments."""
    from ._version import __version__
    raw = argparse.RawDescriptionHelpFormatter
    whole = Parser(prog="avianlidar", description="Simulates what a bird-watching lidar receives.", formatter_class=raw,
                   epilog="examples:\n" + "".join(examples.splitlines(True)[0] for _, _, examples in VERBS.values()))
    whole.add_argument("--version", action="version", version=f"avianlidar {__version__}")
    verbs = whole.add_subparsers(dest="verb", required=True, metavar="verb", parser_class=Parser)
    verb = {name: verbs.add_parser(name, help=words, description=sentence, epilog="examples:\n" + examples,
                                   formatter_class=raw) for name, (words, sentence, examples) in VERBS.items()}

    for name in ("scan", "advise"):
        add = verb[name].add_argument
        add("scene", help="a mesh (STL, OBJ, PLY, glTF, VTP, ...; metres, z up) or a .lidarscene.json file")
        add("--sensor", default="Airport16", help=f"{SENSOR}; default Airport16")
        add("--position", nargs=3, type=float, metavar=("X", "Y", "Z"),
            help="position of the sensor, m; default: the lidar's position in the scene file, else 0 0 0; with "
                 "--trajectory in the frame of the platform (right, forward, up), default 0 0 0")
        _trajectory(verb[name])
        add("--material", help="material of the whole scene, a name that `avianlidar materials` lists; default: the "
            "materials of the file, else Wall")
        add("--scale", type=float,
            help="length of the mesh's unit in metres, for example 0.001 for millimetres; default 1")
        add("--up-axis", choices=("y", "z"), help="axis of a mesh that points up; default: that of the file's format")
        if name == "scan":
            _out(verb[name], f"file: {WRITTEN}; .png gives a picture of the range image; {MANY}", action="append")
            add("--waveforms", type=pathlib.Path, metavar="FILE", action="append", default=[], help="file: the light of the beams before the receiver "
                "decides: .csv (a row for each sample), .vtp (lines), .las (echoes with waveform packets) or .png (a "
                f"picture of one beam); see digitiser_rate and waveform_floor; {MANY}")
            add("--beam", type=int, metavar="ID", help="beam of the picture of --waveforms; default: the beam with the "
                "strongest signal")
            add("--quiet", action="store_true",
                help="omits the lines on the lidar's place and on the range at which its energy is used up")
            add("--preset", choices=tuple(PRESETS), help=(
                "fidelity by name, with the error of energy and the seconds of one core for 15,360 beams, at the "
                "airport without and then with masts and fences: "
                f"{', '.join(f'{name} ({words})' for name, words in PRESETS.items())}; Paper also builds the collision "
                "tree of the paper; default: 100 rays, 2 connections (0.23 %%, 0.15 s; 0.57 %%, 1.0 s)"))
        else:
            add("--energy", type=float, default=0.02, metavar="SHARE",
                help="largest allowed error of energies, rms, relative; default 0.02")
            add("--range", type=float, default=0.05, metavar="METRES",
                help="largest allowed error of ranges, rms, m; default 0.05")
            add("--missed", type=float, default=0.01, metavar="SHARE", help="largest allowed share of echoes that are "
                "missed or invented, relative to the true echoes; default 0.01")
            add("--beams", type=int, default=1000, help="number of beams that are measured; default 1000")
            _out(verb[name], f"file: .json (everything), .csv (the table) or .png (a picture); {MANY}", required=False,
                 action="append", default=[])

    add = verb["info"].add_argument
    add("file", type=pathlib.Path, help="a scene, mesh, cloud, sensor, plan or scenario, or a recording: "
        f"{RECORDING}")
    add("--quiet", action="store_true", help="omits, for a cloud, the lines on what was modelled and what was left out")
    add = verb["compare"].add_argument
    add("a", type=pathlib.Path, help=f"a cloud: {READ}; or a scene")
    add("b", type=pathlib.Path, help=f"a second cloud, in the same coordinates; or a recording: {RECORDING}")
    _out(verb["compare"], "file: the first cloud, with nearest_distance (m) of every point; of a scene and a recording a "
         "folder", required=False)
    add("--sensor", help=f"the lidar that recorded, {SENSOR}")
    add("--position", nargs=3, type=float, metavar=("X", "Y", "Z"),
        help="position of the sensor in the scene, m; default: of the recording, else the lidar's place in the scene")
    add("--heading", type=float,
        help="direction of the sensor's forward axis, deg from north, clockwise; default: of the recording, else 0")
    add("--align", action="store_true", help="improve the pose until the recorded points lie on the surfaces")
    add("--scans", type=int, help="number of scans that are read; default: all")
    verb["convert"].add_argument("file", type=pathlib.Path, help=f"a cloud: {READ}; or the folder of a sequence; or a "
                                 "recording")
    verb["convert"].add_argument("out", type=pathlib.Path, help=f"file: {WRITTEN}; for a sequence .mcap or .db3; for a "
                                 "recording a folder")
    verb["convert"].add_argument("--position", nargs=3, type=float, metavar=("X", "Y", "Z"),
        help="position of the sensor in the coordinates of the cloud, m, to which a KITTI scan (.bin) is relative; "
        "default: the position in the file")
    for name in ("info", "compare", "convert"):
        _of_recording(verb[name].add_argument)
    for name in ("info", "compare", "convert", "track"):
        add = verb[name].add_argument
        add("--sensor-address", metavar="ADDRESS", help="address of the sensor in packets (.pcap), as 192.168.1.201 or "
            "192.168.1.201:2368; default: the only sensor")
        if name == "track":
            continue
        add("--time", type=float, metavar="S",
            help="time of the revolution in packets, seconds since the full hour; default: the first revolution")
    add = verb["sensors"].add_argument
    add("name", nargs="?", help="name of a sensor, or a .lidarsensor.json file")
    add("--fit", metavar="FILE", help="a sensor file with a data sheet, or a name of a sensor, whose receiver is "
        "fitted to all points of the data sheet; needs SciPy")
    _out(verb["sensors"], "file: the sensor with the fitted receiver (.lidarsensor.json)", required=False)

    add = verb["view"].add_argument
    add("scene", help="a mesh or a .lidarscene.json file")
    add("echoes", nargs="*", type=pathlib.Path, help=f"clouds of echoes: {READ}")
    add("--sequence", type=pathlib.Path, metavar="FOLDER",
        help="folder that `avianlidar sequence` has made, or one sequence in the folder; default sequence: the first")
    add("--coverage", type=pathlib.Path, metavar="FOLDER", help="maps that `avianlidar coverage` has made")
    add("--tracks", type=pathlib.Path, metavar="FILE", help="tracks.csv of `avianlidar track`")
    _out(verb["view"], "file: .html")

    add = verb["airport"].add_argument
    add("extract", type=pathlib.Path, help="extract of a map: .osm, .osm.pbf, .geojson, .gpkg")
    add("--heights", type=pathlib.Path, metavar="DEM",
        help="heights of the ground: a GeoTIFF, ASCII grid, SRTM .hgt or mosaic (.vrt); or the height of level ground "
        "above the sea, m; default: level ground at the aerodrome's elevation in the map")
    add("--obstacles", type=pathlib.Path, metavar="FILE", action="append", default=[], help="surveyed obstacles: AIXM "
        "5.1 (.xml), or .csv with columns longitude, latitude, height, unit, kind; may be repeated")
    which = verb["airport"].add_mutually_exclusive_group()
    which.add_argument("--icao", metavar="CODE", help="ICAO code of the airport, if the extract holds several airports")
    which.add_argument("--bounds", nargs=4, type=float, metavar=("W", "S", "E", "N"),
                       help="bounds of the scene, degrees; default: 2 km around the runways")

    add = verb["reach"].add_argument
    add("--sensor", action="append", required=True, help=f"{SENSOR}; {MANY}")
    add("--species", action="append", help=f"species of the bird; default herring gull; {MANY}")
    add("--birds", type=pathlib.Path, metavar="FILE",
        help="a table of birds with the columns of Filters/Birds/species.csv; without --species, all of its birds")
    add("--flock", type=int, metavar="NUMBER", help="number of birds of a flock, of which one must be detected")
    add("--target", action="append", default=[], metavar="KIND",
        help=f"instead of birds: board:SIDE or sphere:DIAMETER (m), drone, person, wall or ground; {MANY}")
    add("--reflectance", type=float,
        help="reflectance of all targets, above 0 to 1; default: assumed by kind, 0.3 for birds")
    add("--height", type=float, metavar="METRES", help="height of the sensor above the ground, for --target ground; "
        "default 5 (assumed)")
    _settings(verb["reach"], sensor="range_gate=800")
    _out(verb["reach"], "file: .csv with shares by range", required=False)

    add = verb["sequence"].add_argument
    add("scenario", help="a scenario file, or the manifest.json of another sequence")
    add("--scans", type=int, help="number of scans that replaces the number in the scenario")
    _trajectory(verb["sequence"])

    add = verb["track"].add_argument
    add("inputs", nargs="+", help="folders that `avianlidar sequence` has made, or scenario files; or recordings: "
        f"{RECORDING}")
    _of_recording(add)
    add("--origin", nargs=3, type=float, metavar=("LAT", "LON", "HEIGHT"),
        help="place on the Earth of --position, else of a recording's origin, deg and m above the ellipsoid WGS84, "
             "for GeoJSON")
    add("--position", nargs=3, type=float, metavar=("X", "Y", "Z"), help="position of the sensor in the coordinates of a "
        "recording's files, m; default: as the files say")
    add("--heading", type=float, help="direction of a recording's y axis, deg clockwise from north; default 0")
    add("--truth", type=pathlib.Path, metavar="FILE", help="true birds of a recording, a table as truth.csv of a "
        "sequence; default: the labels of the scans, if they have labels")
    add("--runways", type=pathlib.Path,
        help="a GeoJSON file with lines of kind runway, for warning times before birds enter a strip or a glide path")
    add("--sensor", action="append", default=[],
        help=f"sensor that replaces the sensor of scenarios, a name or a .lidarsensor.json file; {MANY}; of a recording "
        "the sensor whose steps between beams are used")
    add("--scans", type=int, help="number of scans that replaces the number in scenarios, or that are read")
    add("--learn", type=int, default=20,
        help="number of scans at the beginning of a sequence from which only clutter is learned; default 20")
    add("--cutoff", type=float, default=20.0, help="distance in m from which on a track is not assigned to a bird; "
        "also the cutoff of the OSPA distance; default %(default)g")
    add("--order", type=float, default=2.0, help="order of the OSPA distance, 1 to 20; default %(default)g")
    _settings(verb["track"], clutter=f"a property of the clutter filter, for example clutter_threshold=0.1; {MANY}",
              tracker="confirm_hits=2")

    add = verb["bench"].add_argument
    add("folders", nargs="+", type=pathlib.Path, help="folders that `avianlidar sequence` has made, or of recorded scans "
        "with labels in sequences/NN/velodyne and sequences/NN/labels, as SemanticKITTI has them")
    add("--predictions", nargs="+", type=pathlib.Path, required=True, help="folders with "
        "sequences/NN/predictions/NNNNNN.label, and .score files (float32) if scores are known; for several sets, each "
        "set's predictions in a folder with the name of the set")
    add("--sequences", nargs="+", default=[], metavar="NN",
        help="numbers of the scored sequences, as 02; default: all sequences")
    add("--first", type=int, default=0, help="number of the first scored scan of each sequence; default 0")

    for name in ("coverage", "siting", "design", "report"):
        add = verb[name].add_argument
        add("plan", help="a .coverage.json file")
        _settings(verb[name], sensor="range_gate=3000", coverage="species=crow")
        if name != "coverage":
            add("--metar", type=pathlib.Path,
                help="file of METAR reports, from which the year's weather is counted by the hour")
        if name == "coverage":
            add("--tracks", type=pathlib.Path, metavar="FILE", help="birds that a radar or a GPS logger has recorded "
                "(CSV): the share of scans that detects each bird, in birds.csv")
            _trajectory(verb[name])
        if name in ("siting", "report"):
            _settings(verb[name], siting="a part of the plan's siting, for example spacing=100; file names are "
                                         "relative to the plan's folder")
        if name == "design":
            _settings(verb[name], design="a part of the plan's design, for example share=0.4 or designs=500")

    _out(verb["report"], "file: .html")
    for name in ("airport", "sequence", "track", "bench", "coverage", "siting", "design"):
        _out(verb[name], "folder")
    for name in ("scan", "advise", "sequence"):
        _settings(verb[name], sensor="range_gate=800", scan="rays_per_beam=400")
    simulating = ("scan", "advise", "sequence", "track", "coverage", "design", "report")
    for name in (*simulating, "siting", "reach"):
        verb[name].add_argument("--weather", nargs="+", metavar="KIND:NUMBER", help=WEATHER)
    for name in simulating:  # siting uses one thread for each site, and ranks share the sites
        verb[name].add_argument("--threads", type=int, default=0,
                                help="number of threads; default 0: one for each core")
    return whole


def main(argv: list[str] | None = None) -> int:
    """Runs the command. SIGTERM stops a run as Ctrl-C does. @return 0; 2 after an error, which is printed in one line;
    130 after Ctrl-C; 143 after SIGTERM"""
    from . import _terminal, _verbs
    from ._pipeline import words_of
    from ._ranks import Ranks
    sys.stdout = sys.stdout or open(os.devnull, "w", encoding="utf-8")  # daemons have no streams
    sys.stderr = sys.stderr or open(os.devnull, "w", encoding="utf-8")
    _terminal.names_given(sys.argv[1:] if argv is None else map(str, argv))
    options = parser().parse_args(argv)
    if getattr(options, "trajectory_set", None) and not options.trajectory and options.verb != "sequence":
        parser().error(f"--trajectory-set {options.trajectory_set[0][0]} is for a trajectory, expected --trajectory FILE")
    code, terminated = 2, []

    def terminate(number, _):
        terminated.append(number)
        raise KeyboardInterrupt

    takes_over = (threading.current_thread() is threading.main_thread()
                  and signal.getsignal(signal.SIGTERM) is signal.SIG_DFL)
    if takes_over:
        signal.signal(signal.SIGTERM, terminate)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_, **__: _terminal.warn(str(message))
            with _terminal.alive(options.verb) if takes_over and not Ranks().rank else contextlib.nullcontext():
                getattr(_verbs, options.verb)(options)
            sys.stdout.flush()
        code = 0
    except KeyboardInterrupt as stop:
        code = 143 if terminated else 130
        _terminal.say(": ".join(("stopped", *map(str, stop.args))))
    except BrokenPipeError:  # the reader of the pipe has ended, as in `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 141
    except ImportError as error:
        _terminal.say(f"{error}; this verb needs the Python module")
    except (RuntimeError, OSError, ValueError, TypeError, LookupError, ArithmeticError, Warning) as error:
        _terminal.say(words_of(error))
    finally:  # also after an unexpected exception, which is raised with its traceback
        if takes_over:
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
        if code != 141:
            sys.stdout.flush()
        if code and Ranks().size > 1:
            if sys.exc_info()[0]:
                traceback.print_exc()
            sys.stderr.flush()
            os._exit(code)  # the other ranks must not wait for this one
    return code
