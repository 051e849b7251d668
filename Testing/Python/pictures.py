# SPDX-License-Identifier: BSD-3-Clause
"""A picture against its baseline (Testing/Data/Baseline).

The measure is vtkImageDifference, pixel by pixel: differences of a pixel's three channels that sum to THRESHOLD or less
do not count. VTK's defaults, a threshold of 105 and a shift by a pixel that does not count, would show a hue that is 5
degrees off in no baseline. TestPictures and Testing/Faults/pictures.py plant changes and check that each is seen."""
import os

from vtkmodules.vtkImagingCore import vtkImageDifference, vtkImageExtractComponents
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

THRESHOLD = 10  # of 765
MOST = 5.0  # sum of the differences beyond the threshold, in pixels from black to white


def colours_of(file):
    reader, colours = vtkPNGReader(), vtkImageExtractComponents()  # VTK 9.1 compares no pictures with transparency
    reader.SetFileName(file)
    colours.SetInputConnection(reader.GetOutputPort())
    colours.SetComponents(0, 1, 2)
    colours.Update()
    return colours.GetOutput()


def difference(one, two):
    """The filter that compares two pictures (vtkImageData), updated."""
    compared = vtkImageDifference()
    compared.SetInputData(one)
    compared.SetImageData(two)
    compared.SetThreshold(THRESHOLD)
    compared.AllowShiftOff()
    compared.AveragingOff()
    compared.Update()
    return compared


def compare(file, baseline):
    """Fails if the picture differs from its baseline. The differences are then beside the picture."""
    baseline = os.path.join(os.environ["AVIANLIDAR_BASELINE_DIR"], baseline)
    assert os.path.exists(baseline), f"no baseline {baseline}; this picture is {file}"
    compared = difference(colours_of(file), colours_of(baseline))
    error = compared.GetThresholdedError()
    if os.environ.get("AVIANLIDAR_PICTURES"):  # Testing/Faults/pictures.py asks for the errors of all pictures
        with open(os.environ["AVIANLIDAR_PICTURES"], "a", encoding="utf-8") as stream:
            stream.write(f"{os.path.basename(baseline)} {error}\n")
        return
    if error > MOST:
        writer = vtkPNGWriter()
        writer.SetFileName(file.replace(".png", ".diff.png"))
        writer.SetInputConnection(compared.GetOutputPort())
        writer.Write()
    assert error <= MOST, f"{file}: image error {error:.3f} against {baseline}, allowed {MOST}"
