# SPDX-License-Identifier: BSD-3-Clause
"""The whole pipeline through the plugin gives what the classes give when they are called directly, to the last bit.

Run by pvpython in one process and by pvbatch on two ranks (the argument), where each rank makes its own piece of the
beams."""

import os
import sys

from paraview import simple
from vtkmodules.vtkParallelCore import vtkMultiProcessController

from plugin_testing import OUTPUT_DIR, airport, arrays_of, assert_same, compare, direct_echoes, fetch, load_plugin

COLUMNS = 240
PICTURE = "TestPipelineImage.png"


def test_echoes(echoes, direct):
    found, expected = fetch(echoes), arrays_of(direct.GetOutput(0))
    assert len(expected["energy"]) > 100
    assert_same(found, expected)
    report, expected = fetch(echoes, 1), arrays_of(direct.GetOutput(1))
    assert len(report["beam_id"]) == COLUMNS * 16
    assert_same(report, expected)


def test_multiblock_goes_in_whole(scene, beams, echoes):
    """The reader's blocks hide each other: the same echoes as from the one merged surface with a tree."""
    without_tree = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=scene)
    assert_same(fetch(without_tree), fetch(echoes))
    simple.Delete(without_tree)


def test_moved_beams(tree, echoes):
    """ParaView's Transform turns and scales directions too: beams that were moved by it are as good as ours."""
    at_origin = simple.AvianLidarAirport16(AzimuthStep=360 / COLUMNS)
    moved = simple.Transform(Input=at_origin)
    moved.Transform.Translate = [0, 0, 3]
    moved.Transform.Scale = [2, 2, 2]
    assert_same(fetch(simple.AvianLidarEchoFilter(Beams=moved, Surfaces=tree)), fetch(echoes))


def test_comparison(beams, tree, echoes):
    """Another seed gives another cloud; results are those of the field data."""
    other = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=tree, Seed=1)
    compared = simple.AvianLidarCloudComparison(Simulated=other, Reference=echoes)
    compared.UpdatePipeline()
    compared.UpdatePipelineInformation()
    for name, value in (("hausdorff_distance", compared.HausdorffDistance),
                        ("density_aware_chamfer_distance", compared.DensityAwareChamferDistance)):
        assert 0 < value == compared.FieldData[name].GetRange()[0], name


def test_picture():
    """Terminal and hangars under the echoes, coloured over the receiver's limits. A new baseline: copy the picture from
    the folder for temporary files to Testing/Data/Baseline and look at it."""
    _, tree, _, echoes = airport()
    view = simple.CreateRenderView(ViewSize=[500, 400], OrientationAxesVisibility=0)
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode = "Single Color"
    view.Background = [1, 1, 1]
    surfaces = simple.Show(tree, view)
    surfaces.Representation = "Surface"
    simple.ColorBy(surfaces, ("CELLS", "kd"))
    simple.GetColorTransferFunction("kd").ApplyPreset("Grayscale", True)
    points = simple.Show(echoes, view)
    assert points.Representation == "Points"
    points.PointSize = 4
    simple.ColorBy(points, ("POINTS", "energy"))
    colours = simple.GetColorTransferFunction("energy")
    colours.AutomaticRescaleRangeMode = "Never"
    colours.ApplyPreset("Avian lidar HSB", True)
    colours.RescaleTransferFunction(2e-6, 6.25e-5)
    points.SetScalarBarVisibility(view, True)
    view.CameraPosition = [100, -700, 600]
    view.CameraFocalPoint = [-850, -150, 0]
    view.CameraViewUp = [0, 0, 1]
    simple.SaveScreenshot(os.path.join(OUTPUT_DIR, PICTURE), view, ImageResolution=[500, 400])
    compare(PICTURE)


def main():
    ranks = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    assert vtkMultiProcessController.GetGlobalController().GetNumberOfProcesses() == ranks
    load_plugin()
    scene, tree, beams, echoes = airport(COLUMNS)
    _, direct = direct_echoes(COLUMNS)
    test_echoes(echoes, direct)
    test_multiblock_goes_in_whole(scene, beams, echoes)
    test_moved_beams(tree, echoes)
    test_comparison(beams, tree, echoes)
    if ranks == 1:
        test_picture()


if __name__ == "__main__":
    main()
