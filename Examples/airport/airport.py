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

from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from avianlidar.vtkAvianLidar import (vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter,
                                      vtkAvianLidarGeodeticTransform, vtkAvianLidarGeoJSONWriter,
                                      vtkAvianLidarHSBColorMap, vtkAvianLidarLASWriter, vtkAvianLidarMaterial,
                                      vtkAvianLidarPCDWriter, vtkAvianLidarRangeImage)

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


def scan(scene, tree, preset, options, clock):
    """The echoes of one sensor, in their colours and with their places on the Earth; the filter; the range image."""
    sensor = vtkAvianLidarBeamSource()
    getattr(sensor, "SetPresetTo" + preset)()
    if scene.GetFieldData().GetArray("lidar_position"):
        sensor.SetPosition(scene.GetFieldData().GetArray("lidar_position").GetTuple(0))
    if options.unit:
        sensor.SetSamplingInterval(1e-9 * options.unit)
        sensor.SetPulseWidth(1e-9 * options.unit)
    with clock("beams"):
        running.update(sensor)

    lidar = vtkAvianLidarEchoFilter()
    lidar.SetInputConnection(0, sensor.GetOutputPort())
    lidar.SetSurfacesConnection(tree.GetOutputPort())
    lidar.SetRaysPerBeam(options.rays)
    lidar.SetSeed(options.seed)
    lidar.SetNumberOfThreads(options.threads)
    tables.show_progress(lidar, preset)
    with clock("trace and light"):
        running.update(lidar)

    colors = vtkAvianLidarHSBColorMap()  # hue and rgb (paper, Eq. 13)
    colors.SetInputConnection(lidar.GetOutputPort())
    result = colors
    if scene.GetFieldData().GetArray("geodetic_origin"):
        result = vtkAvianLidarGeodeticTransform()  # longitude, latitude, height
        result.SetInputConnection(colors.GetOutputPort())
    image = vtkAvianLidarRangeImage()
    image.SetInputConnection(0, lidar.GetOutputPort())
    image.SetInputConnection(1, sensor.GetOutputPort())
    with clock("colour, coordinates"):
        running.update(result)
        running.update(image)
    return result.GetOutputDataObject(0), lidar, image.GetOutput()


def write(echoes, name):
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(echoes)
    writer.SetFileName(f"{name}.vtp")
    writer.SetDataModeToBinary()  # VTK with Debian's libexpat does not read Appended data back
    writer.Write()
    tables.write_csv(echoes, f"{name}.csv")
    las = vtkAvianLidarLASWriter()  # UTM, with the energies as extra bytes
    las.SetFileName(f"{name}.las")
    pcd = vtkAvianLidarPCDWriter()
    pcd.SetFileName(f"{name}.pcd")
    writers = [las, pcd]
    if echoes.GetFieldData().GetArray("geodetic_origin"):
        maps = vtkAvianLidarGeoJSONWriter()
        maps.SetFileName(f"{name}.geojson")
        writers.append(maps)
    else:
        las.SetCoordinateSystemToLocal()
    for writer in writers:
        writer.SetInputData(echoes)
        running.write(writer)


def main(argv=None):
    options = arguments(argv)
    common = tables.Clock()
    with common("read the scene"):
        reader = running.read_scene(options.scene)
    scene = reader.GetOutput()
    tree = vtkAvianLidarCollisionTree()  # shared by both sensors
    if options.all_wall:
        wall = vtkAvianLidarMaterial()
        wall.SetInputConnection(reader.GetOutputPort())
        tree.SetInputConnection(wall.GetOutputPort())
    else:
        tree.SetInputConnection(reader.GetOutputPort())
    with common("build the tree"):
        running.update(tree)

    columns, results = {}, {}
    for preset in ["Airport16", "Airport32"] if options.preset == "both" else [options.preset]:
        clock = tables.Clock(common.seconds)
        echoes, lidar, image = scan(scene, tree, preset, options, clock)
        options.out.mkdir(parents=True, exist_ok=True)
        with clock("write"):
            write(echoes, options.out / preset)
        if not options.no_pictures:
            import airport_pictures  # only here: numbers need no display
            with clock("pictures"):
                airport_pictures.draw(scene, echoes, image, preset, options)
        results[preset] = echoes, lidar, image
        columns[preset] = tables.counts(tree, echoes, lidar) + tables.hue_of(options.focus, echoes) + clock.rows()
    table = tables.table(columns)
    (options.out / "table.md").write_text(table + "\n", encoding="utf-8")
    print(table)
    return scene, results


if __name__ == "__main__":
    main()
