#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Many scans of one scene: all combinations of sensors, positions, seeds and attenuation coefficients.

    mpiexec -n 8 pvbatch --sym Examples/sweep/sweep.py --preset Airport16 Airport32 --seed 0 1 2 --position 0 0 3
    sweep.py --attenuation 3.5e-5 8.8e-5 --position 0 0 3 --position 200 0 3 --out build/sweep

Each rank takes whole scans (without pvbatch there is one rank), so ranks share nothing and wait for nobody. Each scan
leaves <name>.vtp and <name>.json, which says what made it: every parameter, version, checksums. A file has its name only
when it is whole, the .json only when its .vtp has: killed at any moment and started again with the same arguments, the
sweep goes on where it was. A second sweep in the folder meanwhile is an error. At the end manifest.json lists all scans that were asked for. A scan that fails leaves no
file: the others are made, then the sweep ends with the exit code 1 and without a manifest.

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`).
"""
import hashlib
import itertools
import json
import os
import pathlib
import sys
import traceback

from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from avianlidar._disk import only_run, write_whole
from avianlidar._ranks import Ranks, as_json, digest_of
from avianlidar._version import __version__
from avianlidar.vtkAvianLidar import vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
import running  # noqa: E402


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=running.file, help="a .lidarscene.json file; default: Shanghai Hongqiao",
                        default=HERE.parent / "airport" / "scene" / "hongqiao.lidarscene.json")
    parser.add_argument("--preset", nargs="+", choices=["Airport16", "Airport32", "CorridorC16"],
                        default=["Airport16"], help="sensors")
    parser.add_argument("--position", nargs=3, type=running.finite, action="append", metavar=("X", "Y", "Z"),
                        help="of the sensor, m; may be given many times; default: 0 0 3")
    parser.add_argument("--seed", nargs="+", type=running.whole(-2**31, 2**31 - 1), default=[0], help="default 0")
    parser.add_argument("--attenuation", nargs="+", type=running.above_zero, default=[3.5e-5], metavar="A",
                        help="attenuation coefficients, 1/m; default 3.5e-5")
    parser.add_argument("--rays", type=running.whole(1, 1000000), default=100, help="rays per beam, default 100")
    parser.add_argument("--threads", type=running.whole(0, 4096), default=1,
                        help="of each rank, default 1: start as many ranks as there are cores")
    parser.add_argument("--verify", action="store_true", help="compare checksums of what is there already, not only sizes")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/sweep"), help="folder for results")
    options = parser.parse_args(argv)
    options.position = options.position or [[0.0, 0.0, 3.0]]
    return options


def values_of(fields):
    """Field data of one value each: all properties of sensor and filter, as they were used."""
    arrays = (fields.GetAbstractArray(i) for i in range(fields.GetNumberOfArrays()))
    return {array.GetName(): array.GetValue(0) for array in arrays if array.GetNumberOfValues() == 1}


def plan(options, scene_digest):
    """All scans as {name: parameters}; those that differ in the air alone stand together."""
    scans = {}
    for preset, position, seed, attenuation in itertools.product(
            options.preset, options.position, options.seed, options.attenuation):
        parameters = {"scene": options.scene.name, "scene_digest": scene_digest, "preset": preset,
                      "position": position, "seed": seed, "attenuation_coefficient": attenuation,
                      "rays_per_beam": options.rays, "avian_lidar_version": __version__}
        short = hashlib.sha256(as_json(parameters)).hexdigest()[:10]
        place = "_".join(f"{coordinate:g}" for coordinate in position)
        scans[f"{preset}_at_{place}_seed_{seed}_air_{attenuation:g}_{short}"] = parameters
    return scans


def is_done(folder, name, verify):
    """True if the files of a scan are there and are those that its .json speaks of."""
    try:
        entry = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        echoes = folder / f"{name}.vtp"
        return echoes.stat().st_size == entry["bytes"] and (
            not verify or hashlib.sha256(echoes.read_bytes()).hexdigest() == entry["sha256"])
    except (OSError, ValueError, KeyError):
        return False


class Scanner:
    """One pipeline for all scans of a rank: what two of them share is not made twice."""

    def __init__(self, tree, options):
        self.sensor = vtkAvianLidarBeamSource()
        self.lidar = vtkAvianLidarEchoFilter()
        self.lidar.SetInputConnection(0, self.sensor.GetOutputPort())
        self.lidar.SetSurfacesConnection(tree.GetOutputPort())
        self.lidar.SetNumberOfThreads(options.threads)
        self.lidar.SetRaysPerBeam(options.rays)
        self.sensor_is = None

    def scan(self, parameters):
        sensor = (parameters["preset"], parameters["position"])
        if sensor != self.sensor_is:
            getattr(self.sensor, "SetPresetTo" + parameters["preset"])()
            self.sensor.SetPosition(parameters["position"])
            self.sensor_is = sensor
        self.lidar.SetSeed(parameters["seed"])
        self.lidar.SetAttenuationCoefficient(parameters["attenuation_coefficient"])
        running.update(self.lidar)
        return self.lidar.GetOutput()


def save(folder, name, parameters, echoes):
    """The echoes, then what says that they are there."""
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(echoes)
    writer.SetDataModeToBinary()  # VTK with Debian's libexpat does not read Appended data back
    writer.WriteToOutputStringOn()
    if not writer.Write():
        sys.exit(f"{name}: the echoes cannot be written as .vtp")
    content = writer.GetOutputString().encode("latin-1")
    entry = dict(parameters, file=f"{name}.vtp", bytes=len(content), sha256=hashlib.sha256(content).hexdigest(),
                 echoes=echoes.GetNumberOfPoints(), field_data=values_of(echoes.GetFieldData()))
    write_whole(folder / f"{name}.vtp", content)
    write_whole(folder / f"{name}.json", as_json(entry))


def shares(scans, todo, ranks):
    """What each rank has to do: scans that differ in the air alone go to one, which traces once and lights often."""
    groups = {}
    for name in todo:
        key = (scans[name]["preset"], tuple(scans[name]["position"]), scans[name]["seed"])
        groups.setdefault(key, []).append(name)
    groups = list(groups.values())
    return [list(itertools.chain.from_iterable(groups[rank::ranks])) for rank in range(ranks)]


def sweep(options, ranks):
    with only_run(options.out, ranks, known=lambda: sorted((name, value) for name, value in vars(options).items() if name != "threads")):
        make(options, ranks)


def make(options, ranks):
    """What is missing of the sweep."""
    tree = vtkAvianLidarCollisionTree()
    reader = running.read_scene(options.scene)
    tree.SetInputConnection(reader.GetOutputPort())
    running.update(tree)
    scans = plan(options, digest_of(tree.GetOutput()))
    todo = [name for name in scans if not is_done(options.out, name, options.verify)]
    ranks.wait()  # all have looked before anybody adds a file
    if ranks.rank == 0:
        print(f"{len(scans)} scans, {len(scans) - len(todo)} of them done already, {ranks.size} ranks", flush=True)
    scanner = Scanner(tree, options)
    for name in shares(scans, todo, ranks.size)[ranks.rank]:
        try:
            echoes = scanner.scan(scans[name])
        except SystemExit as failure:
            print(f"rank {ranks.rank}: {name} failed: {failure}", file=sys.stderr, flush=True)
            continue
        save(options.out, name, scans[name], echoes)
        print(f"rank {ranks.rank}: {name}", flush=True)
    ranks.wait()
    finish(options, ranks, scans)


def finish(options, ranks, scans):
    """The manifest, or which scans are missing."""
    missing = [name for name in scans if not is_done(options.out, name, verify=False)]
    if ranks.rank == 0 and missing:
        print(f"{len(missing)} of {len(scans)} scans failed, there is no manifest: {', '.join(missing)}",
              file=sys.stderr, flush=True)
    ranks.wait()  # the first rank has said it before any ends the job
    if missing:
        sys.exit(1)
    if ranks.rank == 0:
        entries = [json.loads((options.out / f"{name}.json").read_text(encoding="utf-8")) for name in scans]
        write_whole(options.out / "manifest.json", as_json({"scans": entries}))


def main(argv=None):
    ranks = Ranks()
    try:
        sweep(arguments(argv), ranks)
    except BaseException as error:
        if ranks.size == 1 or (isinstance(error, SystemExit) and not error.code):
            raise
        # The others must not wait for this rank: end the job. What is done is kept.
        if not isinstance(error, SystemExit):
            traceback.print_exc()
        elif isinstance(error.code, str):
            print(error.code, file=sys.stderr)
        sys.stderr.flush()
        os._exit(1)


if __name__ == "__main__":
    main()
