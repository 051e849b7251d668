#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which echoes does a 16-channel lidar receive from a corridor (paper, Sec. 5.2)? Scans the scene and writes
echoes.vtp, echoes.csv, pictures and a table.

    Examples/corridor/run.sh --paper                             builds the project and runs this script
    xvfb-run -a /usr/bin/python3 Examples/corridor/corridor.py --rays 1000
    xvfb-run -a /usr/bin/python3 Examples/corridor/corridor.py --scene office.lidarscene.json

PYTHONPATH must contain the folder of the Python package (`cat build/paraview/python-path`). Pictures need a display
(`xvfb-run -a`).
"""
import os
import pathlib
import sys

import avianlidar as al

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "airport"))
import corridor_scene  # noqa: E402
import tools  # noqa: E402

def arguments(argv=None):
    parser = tools.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=tools.file, default=corridor_scene.SCENE,
                        help="a .lidarscene.json file instead of the corridor")
    parser.add_argument("--position", type=float, nargs=3, metavar=("X", "Y", "Z"), help="position of the lidar, m")
    tools.add_arguments(parser, "build/corridor")
    options = parser.parse_args(argv)
    if not options.no_pictures and not os.environ.get("DISPLAY"):
        sys.exit("Pictures need a display: run this under `xvfb-run -a`, or with --no-pictures.")
    return options


def scan(scene, position, options, clock):
    """The scan and its coloured echoes."""
    with clock("build the tree"):
        tools.update(scene.tree)
    result = al.Scan(scene, al.Sensor("CorridorC16", position=position), rays_per_beam=options.rays, seed=options.seed,
                     number_of_threads=options.threads, preset=tools.preset(options))
    with clock("trace and light"):
        result.update()
    with clock("colour"):
        return result, result.echoes.annotated()


def work(options):
    clock = tools.Clock()
    with clock("read the scene"):
        scene = al.Scene(options.scene)
        scene.tree.SetPreset(options.paper)
    surfaces = corridor_scene.build() if options.scene == corridor_scene.SCENE else scene.surfaces.GetBlock(0)
    result, echoes = scan(scene, options.position or scene.lidar_position or (0, 0, 0), options, clock)
    options.out.mkdir(parents=True, exist_ok=True)
    with clock("write"):
        for kind in ("vtp", "csv"):
            echoes.save(options.out / f"echoes.{kind}")
    if not options.no_pictures:
        import corridor_pictures  # not at the top, because numbers do not need a display
        with clock("pictures"):
            corridor_pictures.draw(surfaces, result, echoes, options.scene == corridor_scene.SCENE, options)
    rows = tools.counts(result.scene.tree, echoes.data, result.algorithm) + clock.rows()
    tools.leave(options.out, "table", *tools.columns({"CorridorC16": rows}))
    return surfaces, echoes.data, result.algorithm


def main(argv=None):
    options = arguments(argv)
    return tools.run(lambda: work(options))


if __name__ == "__main__":
    main()
