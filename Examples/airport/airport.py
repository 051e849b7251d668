#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Which echoes does an avian lidar get from an airport? Reads a scene, scans it and leaves for each sensor
<sensor>.vtp (the echoes), <sensor>.csv (with longitude, latitude, height), <sensor>.las, .pcd and .geojson for other
programs, three pictures and a table.

    Examples/airport/run.sh                                      builds everything and runs this script
    airport.py --preset Airport32 --rays 1000 --seed 7 --out build/scan
    airport.py --scene my.lidarscene.json

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`), pictures need a display (`xvfb-run -a`).
"""
import pathlib
import sys

import avianlidar as al

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
sys.path.insert(0, str(HERE))
import running  # noqa: E402
import tables  # noqa: E402


def arguments(argv=None):
    parser = running.Parser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--scene", type=running.file, default=HERE / "scene" / "hongqiao.lidarscene.json",
                        help="a .lidarscene.json file; default: Shanghai Hongqiao")
    parser.add_argument("--preset", choices=["Airport16", "Airport32", "both"], default="both", help="the sensor")
    parser.add_argument("--unit", type=running.above_zero, help="range unit and pulse width, ns; default: the preset's")
    running.add_arguments(parser, "build/airport")
    parser.add_argument("--focus", default="Terminal 1", help="object of the close view, default 'Terminal 1'")
    parser.add_argument("--all-wall", action="store_true", help="make everything of the paper's wall material")
    return running.parse(parser, argv)


def scan(scene, preset, options, clock):
    """The scan of one sensor, its echoes with colours and places on the Earth, and its range image."""
    sensor = al.Sensor(preset, position=scene.lidar_position or (0, 0, 0))
    if options.unit:
        sensor.set(sampling_interval=1e-9 * options.unit, pulse_width=1e-9 * options.unit)
    with clock("beams"):
        running.run(lambda: sensor.beams)
    result = al.Scan(scene, sensor, rays_per_beam=options.rays, seed=options.seed, number_of_threads=options.threads)
    tables.show_progress(result.algorithm, preset)
    with clock("trace and light"):
        running.run(result.update)
    with clock("colour, coordinates"):
        return result, running.run(result.echoes.annotated), running.run(result.range_image)


def main(argv=None):
    options = arguments(argv)
    common = tables.Clock()
    with common("read the scene"):
        seen = running.run(lambda: al.Scene(options.scene))
        scene = al.Scene(seen.surfaces, material="Wall") if options.all_wall else seen
    surfaces = seen.surfaces.GetBlock(0)
    if not surfaces.GetNumberOfPoints():
        sys.exit(f"{options.scene}: no surfaces")
    with common("build the tree"):
        running.update(scene.tree)  # shared by both sensors

    columns, results = {}, {}
    for preset in ["Airport16", "Airport32"] if options.preset == "both" else [options.preset]:
        clock = tables.Clock(common.seconds)
        result, echoes, image = scan(scene, preset, options, clock)
        options.out.mkdir(parents=True, exist_ok=True)
        with clock("write"):
            for kind in ("vtp", "csv", "las", "pcd", "geojson")[:5 if scene.geodetic_origin else 4]:
                running.run(lambda: al.save(echoes, options.out / f"{preset}.{kind}"))  # noqa: B023
        if not options.no_pictures:
            import airport_pictures  # only here: numbers need no display
            with clock("pictures"):
                airport_pictures.draw(surfaces, echoes.data, image, preset, options)
        results[preset] = echoes.data, result.algorithm, image
        columns[preset] = [*tables.counts(scene.tree, echoes.data, result.algorithm), *tables.hue_of(options.focus, echoes.data),
                           *clock.rows()]
    table = tables.table(columns)
    tables.write(options.out, "table", table)
    print(table)
    return surfaces, results


if __name__ == "__main__":
    main()
