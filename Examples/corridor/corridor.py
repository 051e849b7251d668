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

from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from avianlidar.vtkAvianLidar import (vtkAvianLidarBeamSource, vtkAvianLidarCollisionTree, vtkAvianLidarEchoFilter,
                                      vtkAvianLidarHSBColorMap, vtkAvianLidarRangeImage)

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "common"))
sys.path.insert(0, str(HERE))
import corridor_scene  # noqa: E402
import running  # noqa: E402
import tables  # noqa: E402

HAZE = 8.8e-5  # 1/m: paper, Table 2, whose 0.088 is per kilometre


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
    """The coloured echoes, the filters that made them, and the range image."""
    tree = vtkAvianLidarCollisionTree()
    tree.SetInputDataObject(scene)
    with clock("build the tree"):
        running.update(tree)
    sensor = vtkAvianLidarBeamSource()
    sensor.SetPresetToCorridorC16()
    sensor.SetPosition(position)
    running.update(sensor)
    lidar = vtkAvianLidarEchoFilter()
    lidar.SetInputConnection(0, sensor.GetOutputPort())
    lidar.SetSurfacesConnection(tree.GetOutputPort())
    lidar.SetAttenuationCoefficient(HAZE)
    lidar.SetRaysPerBeam(options.rays)
    lidar.SetSeed(options.seed)
    lidar.SetNumberOfThreads(options.threads)
    with clock("trace and light"):
        running.update(lidar)
    colors = vtkAvianLidarHSBColorMap()
    colors.SetInputConnection(lidar.GetOutputPort())
    image = vtkAvianLidarRangeImage()
    image.SetInputConnection(0, lidar.GetOutputPort())
    image.SetInputConnection(1, sensor.GetOutputPort())
    with clock("colour, range image"):
        running.update(colors)
        running.update(image)
    return colors.GetOutput(), lidar, tree, image.GetOutput()


def main(argv=None):
    options = arguments(argv)
    clock = tables.Clock()
    with clock("make the scene"):
        scene, position = surfaces(options)
    echoes, lidar, tree, image = scan(scene, position, options, clock)
    options.out.mkdir(parents=True, exist_ok=True)
    with clock("write"):
        writer = vtkXMLPolyDataWriter()
        writer.SetInputData(echoes)
        writer.SetFileName(str(options.out / "echoes.vtp"))
        writer.SetDataModeToBinary()  # VTK with Debian's libexpat does not read Appended data back
        writer.Write()
        tables.write_csv(echoes, options.out / "echoes.csv")
    if not options.no_pictures:
        import corridor_pictures  # only here: numbers need no display
        with clock("pictures"):
            corridor_pictures.draw(scene, echoes, image, not options.scene, options)
    table = tables.table({"CorridorC16": tables.counts(tree, echoes, lidar) + clock.rows()})
    (options.out / "table.md").write_text(table + "\n", encoding="utf-8")
    print(table)
    return scene, echoes, lidar


if __name__ == "__main__":
    main()
