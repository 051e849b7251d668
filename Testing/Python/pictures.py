# SPDX-License-Identifier: BSD-3-Clause
"""A picture against its baseline (Testing/Data/Baseline)."""
import os

from vtkmodules.vtkImagingCore import vtkImageDifference, vtkImageExtractComponents
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter


def colours_of(file):
    reader, colours = vtkPNGReader(), vtkImageExtractComponents()  # VTK 9.1 compares no pictures with transparency
    reader.SetFileName(file)
    colours.SetInputConnection(reader.GetOutputPort())
    colours.SetComponents(0, 1, 2)
    colours.Update()
    return colours.GetOutput()


def compare(file, baseline, most):
    """@param most as VTK's tests: the sum of differences that no shift by a pixel explains; beyond it they are beside the picture"""
    baseline = os.path.join(os.environ["AVIANLIDAR_BASELINE_DIR"], baseline)
    assert os.path.exists(baseline), f"no baseline {baseline}; this picture is {file}"
    difference, writer = vtkImageDifference(), vtkPNGWriter()
    difference.SetInputData(colours_of(file))
    difference.SetImageData(colours_of(baseline))
    difference.Update()
    error = difference.GetThresholdedError()
    if error > most:
        writer.SetFileName(file.replace(".png", ".diff.png"))
        writer.SetInputConnection(difference.GetOutputPort())
        writer.Write()
    assert error <= most, f"{file}: image error {error:.3f} against {baseline}, allowed {most}"
