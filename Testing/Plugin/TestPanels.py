# SPDX-License-Identifier: BSD-3-Clause
"""Every panel of the plugin is photographed: it shows what a beginner changes and the rest behind the gear button, no text
has less room than it needs in the width that ParaView starts with, and files are offered by their kinds.

Run by the system's Python: TestPanels.py paraview pvpython [--documentation]. The pictures go to the folder TestPanels in
the one for temporary files; with the option (and Debian's libqt5svg5, without which ParaView has no icons) some of them
become Documentation/images/panel-*.png."""

import os
import re
import shutil
import sys

import matplotlib.image
import numpy

from gui_testing import OUTPUT_DIR, SOURCE_DIR, empty, run_script

PHOTOS = os.path.join(OUTPUT_DIR, "TestPanels")
SIZE = (1300, 1900)
# ParaView's way to write 9.62751e-16: longer than a field. 5.13 writes 0.000004166666666666667.
SIXTEEN_DIGITS = re.compile(r"[1-9]\.?\d{15}")
WIDTH = 300  # pixels of a panel, at most: ParaView starts with 290

# What each panel shows to a beginner; the panel of the pipeline's other ends is empty.
BEAM_SOURCE = """ReceiverModel Position Orientation NumberOfChannels MinimumElevation ElevationStep AzimuthRange AzimuthStep
    NumberOfRevolutions StepsPerRevolution
    BeamwidthMilliradians BeamProfile PulseEnergy PulseWidth SamplingInterval Wavelength RangeGate LowerEnergyLimit
    UpperEnergyLimit DisplayLength"""
PHOTON_SOURCE = BEAM_SOURCE.replace("LowerEnergyLimit\n    UpperEnergyLimit", "FalseAlarmsPerScan BackgroundRadiance")
FIRST_SHOWN = {
    "AvianLidarBeamSource": BEAM_SOURCE,
    "AvianLidarAirport16": BEAM_SOURCE,
    "AvianLidarAirport32": BEAM_SOURCE,
    "AvianLidarCorridorC16": BEAM_SOURCE,
    **{"AvianLidar" + name: PHOTON_SOURCE for name in
       ("Search905", "Search1550", "Automotive16", "OS0128", "OS164", "OS2128", "Avia", "Mid40", "Mid360")},
    **{"AvianLidar" + name: BEAM_SOURCE for name in ("HDL32E", "Helios16P", "Pandar40P", "PandarXT32", "VLP16", "VLP32C")},
    "AvianLidarBeamView": "BeamId RaysPerBeam AttenuationCoefficient",
    "AvianLidarBirdSource": "Species Reflectance WingPhase Gliding Position Heading Bank",
    "AvianLidarMedium": "Kind Name MeteorologicalVisibility Shape Bottom Top Softness",
    "AvianLidarMediumShower": "Kind Name RainRate Shape Center Lengths Heading",
    "AvianLidarMediumInSurface": "Kind Name MeteorologicalVisibility",
    "AvianLidarTracks": "Pattern Species NumberOfBirds Reflectance TimeRange Center Radius Heights",
    "AvianLidarTracksApproach": """Pattern Species NumberOfBirds Reflectance TimeRange Radius ThresholdPosition
        ThresholdHeading""",
    "AvianLidarMaterial": "Material Kd Ks Kp BlockNamePattern",
    "AvianLidarMaterialCustom": "Material Kd Ks Kp BlockNamePattern",
    "AvianLidarCollisionTree": "SplitRule BoundingVolume DisplayLevel",
    "AvianLidarClutterFilter": "ClutterThreshold Learning Window WarmUp AzimuthStep ElevationStep",
    "AvianLidarCoverage": """Bounds Spacing Species Reflectance EffectiveArea MeteorologicalVisibility RequiredDetections NumberOfScans
        HeightLimits""",
    "AvianLidarEchoFilter": "Preset RaysPerBeam Advise AttenuationCoefficient NumberOfReflections Noise ReturnMode",
    "AvianLidarEchoFilterStandard": "Preset Advise AttenuationCoefficient Noise ReturnMode",
    "AvianLidarGeodeticTransform": "SourceFrame MovePoints TargetFrame UseFieldDataOrigin Origin",
    "AvianLidarGeodeticTransformMoved": "SourceFrame MovePoints TargetFrame UseFieldDataOrigin Origin",
    "AvianLidarTracker": """ClusterDistance ClusterAngle MotionModel AccelerationDensity MaximumSpeed MinimumSpeed ConfirmHits
        ConfirmScans MaximumMisses""",
    "AvianLidarHSBColorMap": "EnergyArray UseFieldDataRange EnergyRange",
    "AvianLidarHSBColorMapGiven": "EnergyArray UseFieldDataRange EnergyRange",
    "AvianLidarPointCloudReader": "LocalCoordinates SensorAddress",
    "AvianLidarSensorReader": "Position Orientation NumberOfRevolutions StepsPerRevolution",
}
# ParaView's own part of the options of Save Data.
SAVE_DATA = "ChooseArraysToWrite WriteTimeSteps FileNameSuffix NumberOfIORanks RankAssignmentMode "
WRITERS = {
    "LAS": "CoordinateSystem WriteAllArrays",
    "PCD": "FileType Organisation Precision",
    "PLY": "FileType Precision",
    "KITTI": "WriteLabels LabelSource",
    "GeoJSON": "UseFieldDataLimit MinimumEnergy",
}
OPEN = ["Avian lidar scene (*.lidarscene.json)", "Avian lidar sensor (*.lidarsensor.json)", "Lidar point cloud (*.las *.laz *.pcd *.ply *.bin *.pcap *.pcapng)"]
SAVE = ["GeoJSON points(*.geojson )", "KITTI lidar scan(*.bin )", "LAS lidar points(*.las *.laz )"]
SAVE += ["PLY lidar points(*.ply )", "Point Cloud Library points(*.pcd )"]

DOCUMENTATION = {
    "AvianLidarCoverage-default": "panel-coverage",
    "AvianLidarEchoFilter-default": "panel-echo-filter",
    "AvianLidarMaterialCustom-default": "panel-material",
    "SaveData-LAS-default": "panel-save-las",
}


def proxies():
    """The sources, readers and filters in the plugin's XML files; what they have in common has no class, and what the button Advise
    runs has no panel."""
    names = []
    for folder in ("Filters", "IO"):
        folder = os.path.join(SOURCE_DIR, "Plugin", folder)
        for file_name in os.listdir(folder):
            with open(os.path.join(folder, file_name), encoding="utf-8") as file:
                names += re.findall(r'<SourceProxy name="(\w+)"\s+class=', file.read())
    return [name for name in names if name != "AvianLidarAdvisor"]


def check_panels(panels):
    for name in sorted({*proxies(), *FIRST_SHOWN}):
        assert name in panels, f"{name} has no panel"
        pages = panels[name]
        assert pages["default"] == FIRST_SHOWN.get(name, "").split(), (name, pages["default"])
        assert set(pages["default"]) <= set(pages["advanced"]), name


def check_dialogs(found):
    for name, properties in WRITERS.items():
        assert found["writers"][name]["default"] == (SAVE_DATA + properties).split(), found["writers"][name]
    for name, wanted in (("open", OPEN), ("save", SAVE)):
        missing = set(wanted) - set(found[name])
        assert not missing, f"{name}: no {missing} among {found[name]}"


def check_pictures(found):
    """One of every page, which is not empty."""
    pages = [f"{name}-{page}" for name, panel in found["panels"].items() for page in panel]
    pages += [f"SaveData-{name}-{page}" for name, options in found["writers"].items() for page in options]
    for name in (*pages, "File-Open", "File-SaveData"):
        pixels = matplotlib.image.imread(os.path.join(PHOTOS, name + ".png"))
        colours = numpy.unique(pixels.reshape(-1, pixels.shape[2]), axis=0)
        assert min(pixels.shape[:2]) > 80 and len(colours) > 20, (name, pixels.shape, len(colours))


def check_texts(found):
    """Labels wrap between words and widen the panel for long words; fields and choices do not."""
    assert len(found["samples"]) == 5, found["samples"]
    cut = [text for text in found["cut"] if not SIXTEEN_DIGITS.search(text)]
    assert not cut, "\n".join(cut)
    assert found["width"] <= WIDTH, found["width"]


def main(paraview, _, option=None):
    empty(PHOTOS)
    found = run_script(paraview, "panel_photos.py", PHOTOS, SIZE)
    check_panels(found["panels"])
    check_dialogs(found)
    check_pictures(found)
    check_texts(found)
    if option == "--documentation":
        for name, image in DOCUMENTATION.items():
            target = os.path.join(SOURCE_DIR, "Documentation", "images", image + ".png")
            shutil.copyfile(os.path.join(PHOTOS, name + ".png"), target)


if __name__ == "__main__":
    main(*sys.argv[1:])
