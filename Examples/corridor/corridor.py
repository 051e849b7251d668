#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What does a 16-channel lidar get back from a corridor (paper, Sec. 5.2)? Builds the corridor, or reads a scene, scans
it and leaves echoes.vtp, echoes.csv, pictures and a table.

    xvfb-run -a /usr/bin/python3 Examples/corridor/corridor.py --rays 1000
    xvfb-run -a /usr/bin/python3 Examples/corridor/corridor.py --scene office.lidarscene.json

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`).
"""
import pathlib
import sys

import avianlidar as al

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
sys.path.insert(0, str(HERE))
import corridor_scene  # noqa: E402
import running  # noqa: E402
import tables  # noqa: E402

HAZE = 8.8e-5  # 1/m: paper, Table 2: 0.088, without unit, read as per kilometre


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=running.file, help="a .lidarscene.json file instead of the built corridor")
    parser.add_argument("--position", type=float, nargs=3, metavar=("X", "Y", "Z"), help="where the lidar stands, m")
    running.add_arguments(parser, "build/corridor")
    return running.parse(parser, argv)


def surfaces(options):
    """The scene and where the lidar stands."""
    if not options.scene:
        return corridor_scene.build(), options.position or corridor_scene.LIDAR
    scene = running.read_scene(options.scene).GetOutput()
    place = scene.GetFieldData().GetArray("lidar_position")
    return scene, options.position or (place.GetTuple(0) if place else (0, 0, 0))


def scan(scene, position, options, clock):
    """The scan, and its coloured echoes."""
    seen = al.Scene(scene)
    with clock("build the tree"):
        running.update(seen.tree)
    result = al.Scan(seen, al.Sensor("CorridorC16", position=position), attenuation_coefficient=HAZE, rays_per_beam=options.rays,
                     seed=options.seed, number_of_threads=options.threads)
    with clock("trace and light"):
        running.run(result.update)
    with clock("colour"):
        return result, running.run(result.echoes.annotated)


def main(argv=None):
    options = arguments(argv)
    clock = tables.Clock()
    with clock("make the scene"):
        scene, position = surfaces(options)
    result, echoes = scan(scene, position, options, clock)
    options.out.mkdir(parents=True, exist_ok=True)
    with clock("write"):
        for kind in ("vtp", "csv"):
            running.run(lambda: echoes.save(options.out / f"echoes.{kind}"))  # noqa: B023
    if not options.no_pictures:
        import corridor_pictures  # only here: numbers need no display
        with clock("pictures"):
            corridor_pictures.draw(scene, echoes.data, result.range_image(), not options.scene, options)
    table = tables.table({"CorridorC16": tables.counts(result.scene.tree, echoes.data, result.algorithm) + clock.rows()})
    tables.write(options.out, "table", table)
    print(table)
    return scene, echoes.data, result.algorithm


if __name__ == "__main__":
    main()
