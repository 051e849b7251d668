# SPDX-License-Identifier: BSD-3-Clause
"""The airport as ParaView draws it: terminal and hangars under the echoes, coloured over the receiver's limits.

A new baseline: copy TestPipelineImage.png from the folder for temporary files to Testing/Data/Baseline and look at
it."""

import os
import sys

from paraview import simple
from vtkmodules.vtkImagingCore import vtkImageDifference
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

from plugin_testing import OUTPUT_DIR, airport, load_plugin

NAME = "TestPipelineImage.png"
THRESHOLD = 15


def draw(file_name):
    scene, tree, _, echoes = airport()
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
    view.CameraPosition = [100, -700, 600]
    view.CameraFocalPoint = [-850, -150, 0]
    view.CameraViewUp = [0, 0, 1]
    simple.SaveScreenshot(file_name, view, ImageResolution=[500, 400])


def read(file_name):
    reader = vtkPNGReader()
    reader.SetFileName(file_name)
    reader.Update()
    return reader


def compare(name):
    """The picture in the folder for temporary files with the baseline of that name; ends the test if they differ."""
    drawn = os.path.join(OUTPUT_DIR, name)
    baseline = os.path.join(os.environ["AVIANLIDAR_BASELINE_DIR"], name)
    difference = vtkImageDifference()
    images = read(drawn), read(baseline)
    difference.SetInputConnection(images[0].GetOutputPort())
    difference.SetImageConnection(images[1].GetOutputPort())
    difference.Update()
    error = difference.GetThresholdedError()
    print(f"{name}: image error {error:.3f}, allowed {THRESHOLD}")
    if error > THRESHOLD:
        writer = vtkPNGWriter()
        writer.SetFileName(os.path.join(OUTPUT_DIR, name.replace(".png", ".diff.png")))
        writer.SetInputConnection(difference.GetOutputPort())
        writer.Write()
        sys.exit(1)


def main():
    load_plugin()
    draw(os.path.join(OUTPUT_DIR, NAME))
    compare(NAME)


if __name__ == "__main__":
    main()
