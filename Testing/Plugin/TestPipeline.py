# SPDX-License-Identifier: BSD-3-Clause
"""The whole pipeline through the plugin gives what the classes give when they are called directly, to the last bit.

Run by pvpython in one process and by pvbatch on two ranks (the argument), where each rank makes its own piece of the
beams."""

import contextlib
import os
import struct
import sys

import avianlidar.vtkAvianLidar as module
import numpy
from paraview import simple
from vtkmodules.vtkParallelCore import vtkDummyController, vtkMultiProcessController

from plugin_testing import OUTPUT_DIR, SCENE, airport, arrays_of, assert_same, fetch, load_plugin

COLUMNS = 240


@contextlib.contextmanager
def one_process():
    """Filters that run in here take this process for the only one."""
    before = vtkMultiProcessController.GetGlobalController()
    vtkMultiProcessController.SetGlobalController(vtkDummyController())
    try:
        yield
    finally:
        vtkMultiProcessController.SetGlobalController(before)


def direct_echoes():
    """The same scan with the classes themselves: (beams, echo filter)."""
    reader = module.vtkAvianLidarSceneReader()
    reader.SetFileName(SCENE)
    beams = module.vtkAvianLidarBeamSource()
    beams.SetPresetToAirport16()
    beams.SetPosition(0, 0, 3)
    beams.SetAzimuthStep(360 / COLUMNS)
    echoes = module.vtkAvianLidarEchoFilter()
    echoes.SetInputConnection(0, beams.GetOutputPort())
    echoes.SetInputConnection(1, reader.GetOutputPort())
    with one_process():
        echoes.Update()
    return beams, echoes


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


def test_material(scene, beams, echoes):
    """The standard wall on everything: ids in order, brighter or darker echoes, but none of glass or metal."""
    wall = simple.AvianLidarMaterial(Input=scene, Material="Wall", BlockNamePattern="*")
    walls = fetch(simple.AvianLidarEchoFilter(Beams=beams, Surfaces=wall))
    assert set(walls["material_id"]) == {0}
    assert set(fetch(echoes)["material_id"]) != {0}


def test_medium_in_a_surface():
    """A cube is the box of the source."""
    beams = simple.AvianLidarSearch905(AzimuthStep=10)
    cube = simple.Box(XLength=60, YLength=60, ZLength=60, Center=[0, 100, 0])
    leaves = {"Kind": "Foliage", "LeafAreaDensity": 0.2, "Name": "wood"}
    inside = simple.AvianLidarMediumInSurface(Input=cube, **leaves)
    box = simple.AvianLidarMedium(Shape="Box", Lengths=[60, 60, 60], Center=[0, 100, 0], **leaves)
    found, expected = (simple.AvianLidarEchoFilter(Beams=beams, Surfaces=simple.GroupDatasets(Input=[medium, simple.Plane()]), Noise=0)
                       for medium in (inside, box))
    assert len(fetch(expected)["energy"]) > 10
    assert numpy.allclose(fetch(found)["energy"], fetch(expected)["energy"], rtol=1e-6)


def test_colours(echoes):
    """Eq. 13 on every echo."""
    coloured = fetch(simple.AvianLidarHSBColorMap(Input=echoes))
    low, high = 2e-6, 6.25e-5
    hue = 240 * (high - numpy.clip(coloured["energy"], low, high)) / (high - low)
    assert numpy.allclose(coloured["hue"], hue, rtol=0, atol=1e-9)
    assert coloured["rgb"].dtype == numpy.uint8 and coloured["rgb"].shape[1] == 3


def test_range_image(beams, echoes):
    image = simple.AvianLidarRangeImage(Echoes=echoes, Beams=beams)
    image.UpdatePipeline()
    columns, rows = image.GetDataInformation().GetExtent()[1] + 1, image.GetDataInformation().GetExtent()[3] + 1
    assert (columns, rows) == (COLUMNS, 16)
    low, high = image.PointData["distance_m"].GetRange()
    ranges = fetch(echoes)["distance_m"]
    assert ranges.min() <= low <= high <= ranges.max()


def test_geodetic(echoes):
    """Near Hongqiao, and as far from its origin as the echo is from the lidar."""
    located = fetch(simple.AvianLidarGeodeticTransform(Input=echoes))
    points = located["points"]
    metres_per_degree = 111e3
    north = (located["latitude"] - 31.1979) * metres_per_degree
    east = (located["longitude"] - 121.3363) * metres_per_degree * numpy.cos(numpy.radians(31.1979))
    assert numpy.allclose(points[:, 0], east, atol=10) and numpy.allclose(points[:, 1], north, atol=10)


def test_comparison(beams, tree, echoes):
    """A cloud is at no distance from itself, and another seed gives another cloud."""
    same = simple.AvianLidarCloudComparison(Simulated=echoes, Reference=echoes)
    same.UpdatePipeline()
    assert same.FieldData["hausdorff_distance"].GetRange() == (0, 0)
    assert same.FieldData["density_aware_chamfer_distance"].GetRange() == (0, 0)
    other = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=tree, Seed=1)
    compared = simple.AvianLidarCloudComparison(Simulated=other, Reference=echoes)
    compared.UpdatePipeline()
    assert 0 < compared.FieldData["rmse_reference_to_simulated"].GetRange()[0] < 50
    assert numpy.any(fetch(compared)["nearest_distance"] > 0)
    compared.UpdatePipelineInformation()
    assert compared.HausdorffDistance == compared.FieldData["hausdorff_distance"].GetRange()[0]
    near = compared.DensityAwareChamferDistance
    assert 0 < near == compared.FieldData["density_aware_chamfer_distance"].GetRange()[0]
    compared.ChamferAlpha = 100
    compared.UpdatePipeline()
    assert near < compared.FieldData["density_aware_chamfer_distance"].GetRange()[0] <= 1


def test_relighting(echoes):
    """A value changed and changed back gives the same echoes."""
    before = fetch(echoes)
    echoes.AttenuationCoefficient = 8.8e-5
    assert not numpy.array_equal(fetch(echoes).get("energy"), before["energy"])
    echoes.AttenuationCoefficient = 3.5e-5
    assert_same(fetch(echoes), before)


def test_packets():
    """Revolutions of a recording are time steps."""
    ethernet = bytes(12) + b"\x08\x00" + b"\x45" + bytes(8) + b"\x11" + bytes(10)  # IPv4, UDP
    ethernet += struct.pack(">HHHH", 2368, 2368, 1214, 0)
    packets = b""
    for number in range(3):
        blocks = (struct.pack("<HH", 0xEEFF, (35000 + 500 * block) % 36000) + struct.pack("<HB", 5000, 9) * 32 for block in range(12))
        packets += struct.pack("<IIII", 0, 0, 1248, 1248) + ethernet + b"".join(blocks) + struct.pack("<IBB", 100000 * number, 0x37, 0x22)
    file = os.path.join(OUTPUT_DIR, f"TestPipeline-{os.getpid()}.pcap")
    with open(file, "wb") as stream:
        stream.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 1) + packets)
    reader = simple.OpenDataFile(file)
    times = list(reader.TimestepValues)
    counts = []
    for time in times:
        reader.UpdatePipeline(time)
        counts.append(reader.GetDataInformation().GetNumberOfPoints())
    os.remove(file)
    assert counts == [64, 384, 384, 320], counts
    assert numpy.allclose(times, [0, 2 * 110.592e-6, 0.1 + 2 * 110.592e-6, 0.2 + 2 * 110.592e-6]), times
    simple.Delete(reader)


def main():
    ranks = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    assert vtkMultiProcessController.GetGlobalController().GetNumberOfProcesses() == ranks
    load_plugin()
    if ranks == 1:
        test_packets()
    scene, tree, beams, echoes = airport(COLUMNS)
    _, direct = direct_echoes()
    test_echoes(echoes, direct)
    test_multiblock_goes_in_whole(scene, beams, echoes)
    test_moved_beams(tree, echoes)
    test_material(scene, beams, echoes)
    test_medium_in_a_surface()
    test_colours(echoes)
    test_range_image(beams, echoes)
    test_geodetic(echoes)
    test_comparison(beams, tree, echoes)
    test_relighting(echoes)


if __name__ == "__main__":
    main()
