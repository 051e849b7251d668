#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Many scans of one scene: all combinations of sensors, positions, seeds and attenuation coefficients.

    mpiexec -n 8 pvbatch --sym Examples/sequence/sweep.py --preset Airport16 Airport32 --seed 0 1 2 --position 0 0 3
    sweep.py --attenuation 3.5e-5 8.8e-5 --position 0 0 3 --position 200 0 3 --out build/sweep

Each rank makes whole scans (without pvbatch there is one rank), so ranks do not wait for each other. Each scan writes
<name>.vtp and <name>.json. The .json file has every parameter, the version and checksums. A file appears only when it
is whole, and the .json file only after its .vtp file. A sweep that was stopped therefore continues if it is started
again with the same arguments. A second sweep in the same folder at the same time is an error. At the end manifest.json
lists all scans. A scan that fails does not write a file: the sweep makes the other scans, and ends with the exit code 1
and without a manifest.

PYTHONPATH must contain the folder of the Python package (`cat build/paraview/python-path`).
"""
import hashlib
import itertools
import json
import os
import pathlib
import sys
import traceback

import numpy as np
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

import avianlidar as al
from avianlidar._disk import only_run, write_whole
from avianlidar._ranks import Ranks, as_json, digest_of
from avianlidar._version import __version__

AIRPORT = pathlib.Path(__file__).resolve().parents[1] / "airport"
sys.path.append(str(AIRPORT))
import tools  # noqa: E402


def arguments(argv=None):
    parser = tools.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=tools.file, help="a .lidarscene.json file; default: Shanghai Hongqiao",
                        default=AIRPORT / "scene" / "hongqiao.lidarscene.json")
    parser.add_argument("--preset", nargs="+", choices=["Airport16", "Airport32", "CorridorC16"],
                        default=["Airport16"], help="sensors")
    parser.add_argument("--position", nargs=3, type=tools.finite, action="append", metavar=("X", "Y", "Z"),
                        help="position of the sensor, m; may be given many times; default: 0 0 3")
    parser.add_argument("--seed", nargs="+", type=tools.number(int, -2**31, 2**31 - 1), default=[0],
                        help="seeds, default 0")
    parser.add_argument("--attenuation", nargs="+", type=tools.above_zero, default=[3.5e-5], metavar="A",
                        help="attenuation coefficients, 1/m; default 3.5e-5")
    parser.add_argument("--rays", type=tools.number(int, 1, 1000000), default=100, help="rays per beam, default 100")
    parser.add_argument("--threads", type=tools.number(int, 0, 4096), default=1,
                        help="threads of each rank, default 1: start one rank for each core")
    parser.add_argument("--verify", action="store_true", help="compare checksums of existing files, not only sizes")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/sweep"), help="folder for results")
    options = parser.parse_args(argv)
    options.position = options.position or [[0.0, 0.0, 3.0]]
    return options


def values_of(fields):
    """Field data with one value each: the properties of sensor and filter."""
    single = {name: value for name, value in fields.items() if np.size(value) == 1}
    return {name: value[0] if isinstance(value, list) else value for name, value in single.items()}


def plan(options, scene_digest):
    """All scans as {name: parameters}. Scans that differ only in the air are neighbours."""
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
    """True if the files of a scan exist, and the .vtp file is as described in the .json file."""
    try:
        entry = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        echoes = folder / f"{name}.vtp"
        return echoes.stat().st_size == entry["bytes"] and (
            not verify or hashlib.sha256(echoes.read_bytes()).hexdigest() == entry["sha256"])
    except (OSError, ValueError, KeyError):
        return False


def save(folder, name, parameters, echoes):
    """Writes the echoes, then the .json file."""
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(echoes.data)
    writer.SetDataModeToBinary()  # VTK with Debian's libexpat does not read Appended data back
    writer.WriteToOutputStringOn()
    if not writer.Write():
        sys.exit(f"{name}: the echoes cannot be written as .vtp")
    content = writer.GetOutputString().encode("latin-1")
    entry = dict(parameters, file=f"{name}.vtp", bytes=len(content), sha256=hashlib.sha256(content).hexdigest(),
                 echoes=echoes.number_of_points, field_data=values_of(echoes.fields))
    write_whole(folder / f"{name}.vtp", content)
    write_whole(folder / f"{name}.json", as_json(entry))


def shares(scans, todo, ranks):
    """The groups of scans of each rank. Scans that differ only in the air form a group, which is traced only once."""
    groups = {}
    for name in todo:
        groups.setdefault((scans[name]["preset"], tuple(scans[name]["position"]), scans[name]["seed"]), []).append(name)
    return [list(groups.items())[rank::ranks] for rank in range(ranks)]


def sweep(options, ranks):
    wanted = sorted((name, value) for name, value in vars(options).items() if name != "threads")
    with only_run(options.out, ranks, known=lambda: wanted):
        make(options, ranks)


def make(options, ranks):
    """Makes the missing scans."""
    scene = tools.run(lambda: al.Scene(options.scene))
    tools.run(lambda: tools.update(scene.tree))
    scans = plan(options, digest_of(scene.tree.GetOutput()))
    todo = [name for name in scans if not is_done(options.out, name, options.verify)]
    ranks.wait()  # before a rank adds a file, all ranks have made the list
    if ranks.rank == 0:
        print(f"{len(scans)} scans, {len(scans) - len(todo)} of them done already, {ranks.size} ranks", flush=True)
    for (preset, position, seed), names in shares(scans, todo, ranks.size)[ranks.rank]:
        scan = al.Scan(scene, al.Sensor(preset, position=position), seed=seed, rays_per_beam=options.rays,
                       number_of_threads=options.threads)
        for name in names:
            scan.attenuation_coefficient = scans[name]["attenuation_coefficient"]
            try:
                echoes = scan.echoes
            except al.Error as failure:
                print(f"rank {ranks.rank}: {name} failed: {failure}", file=sys.stderr, flush=True)
                continue
            save(options.out, name, scans[name], echoes)
            print(f"rank {ranks.rank}: {name}", flush=True)
    ranks.wait()
    finish(options, ranks, scans)


def finish(options, ranks, scans):
    """Writes the manifest, or prints the names of the missing scans."""
    missing = [name for name in scans if not is_done(options.out, name, verify=False)]
    if ranks.rank == 0 and missing:
        print(f"{len(missing)} of {len(scans)} scans failed, there is no manifest: {', '.join(missing)}",
              file=sys.stderr, flush=True)
    ranks.wait()  # the first rank has printed before a rank ends the job
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
        # End the job, because other ranks must not wait for this rank. Finished files are kept.
        if not isinstance(error, SystemExit):
            traceback.print_exc()
        elif isinstance(error.code, str):
            print(error.code, file=sys.stderr)
        sys.stderr.flush()
        os._exit(1)


if __name__ == "__main__":
    main()
