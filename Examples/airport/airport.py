#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which echoes does an avian lidar receive from an airport? Scans a scene and writes for each sensor
<sensor>.vtp (the echoes), <sensor>.csv (with longitude, latitude, height), <sensor>.las, .pcd and .geojson for other
programs, three pictures and a table.

    Examples/airport/run.sh                                      builds the project and runs this script
    Examples/airport/run.sh --paper --out build/airport-paper    uses the method of the paper
    airport.py --preset Airport32 --rays 1000 --seed 7 --out build/scan
    airport.py --scene my.lidarscene.json

PYTHONPATH must contain the folder of the Python package (`cat build/paraview/python-path`).
"""
import pathlib
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import avianlidar as al
import tools

SCENE = pathlib.Path(__file__).resolve().parent / "scene" / "hongqiao.lidarscene.json"


def arguments(argv=None):
    parser = tools.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=tools.file, default=SCENE,
                        help="a .lidarscene.json file; default: Shanghai Hongqiao")
    parser.add_argument("--preset", choices=["Airport16", "Airport32", "both"], default="both", help="the sensor")
    parser.add_argument("--unit", type=tools.above_zero,
                        help="range unit and pulse width, ns; default: values of the preset")
    tools.add_arguments(parser, "build/airport")
    parser.add_argument("--focus", default="Terminal 1", help="object of the close view, default 'Terminal 1'")
    parser.add_argument("--all-wall", action="store_true", help="give all objects the paper's wall material")
    return parser.parse_args(argv)


def scan(scene, preset, options, clock):
    """The scan of one sensor, its echoes with colours and positions on the Earth, and its range image."""
    sensor = al.Sensor(preset, position=scene.lidar_position or (0, 0, 0))
    if options.unit:
        sensor.set(sampling_interval=1e-9 * options.unit, pulse_width=1e-9 * options.unit)
    with clock("beams"):
        tools.update(sensor.algorithm)
    result = al.Scan(scene, sensor, rays_per_beam=options.rays, seed=options.seed, number_of_threads=options.threads,
                     preset=tools.preset(options))
    with clock("trace and light"):
        result.update()
    with clock("colour, coordinates"):
        return result, result.echoes.annotated(), result.range_image()


def focus(surfaces, echoes, name):
    """Title and limits of the close view: the object `name`, else the square of 500 m with the most echoes."""
    names = tools.strings(surfaces, "object_names")
    if name in names:
        return name, tools.around(vtk_to_numpy(surfaces.GetBlock(names.index(name)).GetPoints().GetData()), 0.06)
    points = echoes.points if echoes.number_of_points else np.array([echoes.fields["position"]])
    squares, count = np.unique(np.floor(points[:, :2] / 500), axis=0, return_counts=True)
    return "Square of 500 m with the most echoes", tuple((500 * x, 500 * x + 500) for x in squares[count.argmax()])


def draw(surfaces, result, echoes, preset, options):
    """Write <preset>-top.png, <preset>-close.png and <preset>-range.png."""
    words = f"{preset}, {'preset Paper' if options.paper else f'{options.rays} rays per beam'}"
    title, limits = focus(surfaces, echoes, options.focus)
    for view, said, bounds in (("top", "From above", tools.extent(surfaces, echoes)), ("close", title, limits)):
        with tools.figure(options.out / f"{preset}-{view}.png", figsize=tools.shape(bounds)) as axes:
            tools.from_above(axes, surfaces, echoes, bounds, f"{said}, {words}", scan=result)
    tools.range_images(options.out / f"{preset}-range.png", result, words)


def work(options):
    common = tools.Clock()
    with common("read the scene"):
        seen = al.Scene(options.scene)
        scene = al.Scene(seen.surfaces, material="Wall") if options.all_wall else seen
    surfaces = seen.surfaces.GetBlock(0)
    if not surfaces.GetNumberOfPoints():
        sys.exit(f"{options.scene}: no surfaces")
    scene.tree.SetPreset(options.paper)
    with common("build the tree"):
        tools.update(scene.tree)  # shared by both sensors

    columns, results = {}, {}
    presets = ["Airport16", "Airport32"] if options.preset == "both" else [options.preset]
    kinds = ["vtp", "csv", "las", "pcd"]
    if scene.geodetic_origin:
        kinds.append("geojson")
    for preset in presets:
        clock = tools.Clock(common.seconds)
        result, echoes, image = scan(scene, preset, options, clock)
        options.out.mkdir(parents=True, exist_ok=True)
        with clock("write"):
            for kind in kinds:
                al.save(echoes, options.out / f"{preset}.{kind}")
        if not options.no_pictures:
            with clock("pictures"):
                draw(surfaces, result, echoes, preset, options)
        results[preset] = echoes.data, result.algorithm, image
        columns[preset] = [*tools.counts(scene.tree, echoes.data, result.algorithm),
                           *tools.hue_of(options.focus, echoes.data), *clock.rows()]
    tools.leave(options.out, "table", *tools.columns(columns))
    return surfaces, results


def main(argv=None):
    options = arguments(argv)
    return tools.run(lambda: work(options))


if __name__ == "__main__":
    main()
