#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What does a 16-channel lidar get back from a corridor (paper, Sec. 5.2)? Builds the corridor, or reads a scene, scans
it and leaves echoes.vtp, echoes.csv, pictures and a table.

    xvfb-run -a /usr/bin/python3 Examples/corridor/corridor.py --rays 1000
    xvfb-run -a /usr/bin/python3 Examples/corridor/corridor.py --scene office.lidarscene.json

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`), pictures need a display (`xvfb-run -a`).
"""
import os
import pathlib
import sys

import avianlidar as al

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "airport"))
import corridor_scene  # noqa: E402
import tools  # noqa: E402

HAZE = 8.8e-5  # 1/m: paper, Table 2: 0.088, without unit, read as per kilometre


def arguments(argv=None):
    parser = tools.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=tools.file, help="a .lidarscene.json file instead of the built corridor")
    parser.add_argument("--position", type=float, nargs=3, metavar=("X", "Y", "Z"), help="where the lidar stands, m")
    tools.add_arguments(parser, "build/corridor")
    options = parser.parse_args(argv)
    if not options.no_pictures and not os.environ.get("DISPLAY"):
        sys.exit("Pictures need a display: run this under `xvfb-run -a`, or with --no-pictures.")
    return options


def surfaces(options):
    """The scene and where the lidar stands."""
    if not options.scene:
        return corridor_scene.build(), options.position or corridor_scene.LIDAR
    scene = tools.run(lambda: al.Scene(options.scene))
    return scene.surfaces.GetBlock(0), options.position or scene.lidar_position or (0, 0, 0)


def scan(scene, position, options, clock):
    """The scan, and its coloured echoes."""
    seen = al.Scene(scene)
    with clock("build the tree"):
        tools.update(seen.tree)
    result = al.Scan(seen, al.Sensor("CorridorC16", position=position), attenuation_coefficient=HAZE, rays_per_beam=options.rays,
                     seed=options.seed, number_of_threads=options.threads)
    with clock("trace and light"):
        tools.run(result.update)
    with clock("colour"):
        return result, tools.run(result.echoes.annotated)


def main(argv=None):
    options = arguments(argv)
    clock = tools.Clock()
    with clock("make the scene"):
        scene, position = surfaces(options)
    result, echoes = scan(scene, position, options, clock)
    options.out.mkdir(parents=True, exist_ok=True)
    with clock("write"):
        for kind in ("vtp", "csv"):
            tools.run(lambda: echoes.save(options.out / f"echoes.{kind}"))  # noqa: B023
    if not options.no_pictures:
        import corridor_pictures  # only here: numbers need no display
        with clock("pictures"):
            corridor_pictures.draw(scene, result, echoes, not options.scene, options)
    rows = tools.counts(result.scene.tree, echoes.data, result.algorithm) + clock.rows()
    tools.leave(options.out, "table", *tools.columns({"CorridorC16": rows}))
    return scene, echoes.data, result.algorithm


if __name__ == "__main__":
    main()
