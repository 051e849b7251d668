# SPDX-License-Identifier: BSD-3-Clause
"""What several ranks make together is what one makes alone, to the last bit, wherever the surfaces and beams are; a
scene that has not changed is not sent again. With the tests of clouds and coverage: one start of the ranks has all."""

import functools
import sys

import numpy as np
import vtk

import TestRanksClouds
import TestRanksCoverage
from paralleltools import (CONTROLLER, COSTS, LAST, RANK, RANKS, assert_same, blocks_of, collect, exchange, field_texts,
                           in_order, joined, main, point_arrays, table, tests_of, total, update)
import cloudtools
import echotools
from avianlidar import mover, trajectory, vtkAvianLidar as al

TOWN = echotools.town(3, 24)
for number in range(0, 24, 3):
    cloudtools.add_field(TOWN.GetBlock(number), "object_classes", [f"class {number}"])
SETTINGS = {"RaysPerBeam": 40, "NumberOfThreads": 1}


@functools.lru_cache(maxsize=None)
def alone(surfaces=TOWN, **settings):
    """The scan of one process: as one piece nothing is exchanged."""
    echo = echotools.scan(surfaces, **{**SETTINGS, **settings})
    echo.Update()
    return echo


def interleaved(i):
    """Blocks that are this rank's."""
    return i % RANKS == RANK


def multiblock(count, block, mine=lambda i: True):
    """Blocks of which those that are mine are there."""
    return echotools.group(*(block(i) if mine(i) else None for i in range(count)))


def together(surfaces, beams=None, **settings):
    return update(echotools.scan(surfaces, beams, **{**SETTINGS, **settings}))


# What the model did without, of which less has to be bounded the more is known.
LEFT_OUT = ("skipped", "skipped_bound")


def check(echo, expected, without=()):
    for port in (0, 1):
        arrays = [joined(echo.GetOutput(port)), in_order(point_arrays(expected.GetOutput(port)))]
        assert_same(*({name: values for name, values in a.items() if name not in without} for a in arrays))
        mine, serial = (field_texts(e.GetOutput(port), without) for e in (echo, expected))
        assert mine == serial, {name: (mine.get(name), serial.get(name))
                                for name in mine.keys() | serial.keys() if mine.get(name) != serial.get(name)}


def with_tree(surfaces):
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(surfaces)
    return tree


def with_tree_output(surfaces):
    """All surfaces as one vtkPolyData, made by a tree of this rank alone."""
    tree = with_tree(surfaces)
    tree.SetController(None)
    tree.Update()
    return tree.GetOutput()


def test_everybody_has_all():
    """Trees of all kinds; a choice of threads of each rank's own changes nothing, and keeps nobody waiting."""
    echo = together(TOWN, NumberOfThreads=RANK % 2)
    check(echo, alone())
    assert total(echo.GetNumberOfTreeBuilds()) == RANKS
    for volume in range(3):
        tree = with_tree(TOWN)
        tree.SetBoundingVolume(volume)
        check(together(tree), alone())
        assert total(tree.GetNumberOfBuilds()) == RANKS


def test_one_rank_has_all():
    expected = alone()
    for reader in {0, LAST}:
        surfaces = blocks_of(TOWN, lambda i: RANK == reader)
        echo = together(surfaces)
        check(echo, expected)
        assert total(echo.GetNumberOfTreeBuilds()) == RANKS
        assert (echo.GetNumberOfBytesSent() > 0) == (RANKS > 1 and RANK == reader), echo.GetNumberOfBytesSent()
        if RANK != reader:
            surfaces = vtk.vtkMultiBlockDataSet()  # a reader that did not run leaves no blocks at all
        check(together(surfaces), expected, ("geodetic_origin",))


def test_blocks_are_spread():
    expected = alone()
    check(together(blocks_of(TOWN, lambda i: (i * i) % RANKS == RANK or i % 5 == 0)), expected)  # some are everywhere
    tree = with_tree(blocks_of(TOWN, lambda i: i % RANKS == LAST - RANK))
    echo = together(tree)
    check(echo, expected)
    assert total(tree.GetNumberOfBuilds()) == RANKS and total(echo.GetNumberOfTreeBuilds()) == 0
    assert total(echo.GetNumberOfBytesSent()) == 0
    # One copy of the surfaces: of all ranks together they are those of one.
    cells = [part.GetNumberOfCells() for part in collect(tree.GetOutput())]
    assert cells[0] > 0 and not any(cells[1:]), cells


def test_objects_are_numbered_as_alone():
    """Blocks without a name or without a triangle are objects too, in the order of the blocks."""
    def blocks(mine):
        some = multiblock(8, lambda i: vtk.vtkPolyData() if i in (2, 5) else TOWN.GetBlock(i), mine)
        for i in (1, 2, 4, 5, 7):
            some.GetMetaData(i).Set(vtk.vtkCompositeDataSet.NAME(), f"block of {i}")
        return some
    expected = alone(blocks(lambda i: True))
    texts = field_texts(expected.GetOutput())
    assert texts["object_names"][4:7] == ["block of 4", "block of 5", "block 6"]
    assert texts["object_classes"] == ["class 0", "", "", "class 3", "", "", "class 6", ""]
    for mine in (interleaved, lambda i: i >= RANK):
        check(together(blocks(mine)), expected)


def test_media_are_those_of_all_ranks():
    """Ground fog, a shower and trees among the surfaces, wherever they are."""
    def medium(kind, shape, **properties):
        source = echotools.given(al.vtkAvianLidarMedium(), **properties)
        getattr(source, "SetKindTo" + kind)()
        getattr(source, "SetShapeTo" + shape)()
        source.Update()
        return source.GetOutput()

    media = [medium("Fog", "Layer", Top=1.0, Softness=2.0, Name="fog"),
             medium("Rain", "Box", Center=(0, 60, 0), Lengths=(300, 80, 100), RainRate=50, Name="shower"),
             *(medium("Foliage", "Ellipsoid", Center=(12 * k - 30, 20, 2), Lengths=(5, 5, 6), Name=f"tree {k}")
               for k in range(5))]

    def blocks(mine):
        return multiblock(24 + len(media), lambda i: TOWN.GetBlock(i) if i < 24 else media[i - 24], mine)

    beams = al.vtkAvianLidarBeamSource()
    beams.SetPresetToSearch905()
    beams.SetAzimuthStep(24)
    expected = echotools.scan(blocks(lambda i: True), beams, **SETTINGS)
    expected.Update()
    objects = point_arrays(expected.GetOutput())["object_id"]
    assert (objects == -2).sum() > 20 and len(field_texts(expected.GetOutput())["media"]) == len(media)
    assert set(field_texts(expected.GetOutput())["object_names"]) >= {f"tree {k}" for k in range(5)}
    check(together(blocks(interleaved), beams), expected, LEFT_OUT)
    check(together(with_tree(blocks(lambda i: (i >= 24) == (RANK == LAST))), beams), expected, LEFT_OUT)


def gull(number):
    azimuth, away = 0.4 * number, 15 + number % 3
    here = (away * np.sin(azimuth), away * np.cos(azimuth), 0.2)
    return mover(echotools.bird(ObjectId=100 + number), [here, (here[0] + 1, here[1], 0.4)], times=[-1, 1])


def test_movers_are_those_of_all_ranks():
    """A rank without movers may have an empty vtkPolyData, also where others have arrays that nobody reads."""
    gulls = [gull(i) for i in range(15)]
    for one in gulls:
        cloudtools.add_field(one, "block_name", [])  # a user's own
    beams = echotools.given(echotools.sensor(), LowerEnergyLimit=1e-8, HalfBeamwidth=1e-2)

    def with_movers(movers):
        echo = echotools.scan(TOWN, beams, **SETTINGS)
        echo.SetMoversData(movers)
        return echo
    expected = with_movers(multiblock(15, gulls.__getitem__))
    expected.Update()
    assert expected.GetNumberOfTouchedBeams() > 15
    for mine in (lambda i: RANK == LAST, interleaved):
        some = multiblock(15, gulls.__getitem__, mine)
        echo = update(with_movers(some if any(map(mine, range(15))) else vtk.vtkPolyData()))
        check(echo, expected, COSTS + LEFT_OUT)
        assert echo.GetNumberOfTouchedBeams() == expected.GetNumberOfTouchedBeams()


def test_one_surface_in_pieces():
    """With ghost cells or without. Points on the seams are there twice, so the checksum alone is another one."""
    ball = echotools.output(echotools.given(vtk.vtkSphereSource(), Center=(60, 0, 0), Radius=30))
    surface = echotools.painted(ball, "Metal")
    expected = alone(surface)
    for ghosts in (0, 1):
        pieces = vtk.vtkExtractPolyDataPiece()
        pieces.SetInputData(surface)
        pieces.UpdatePiece(RANK, RANKS, ghosts)
        part = pieces.GetOutput()
        part.GetFieldData().PassData(surface.GetFieldData())
        assert part.HasAnyGhostCells() == bool(ghosts)
        for pipeline in (lambda data: data, with_tree):
            check(together(pipeline(part)), expected, () if RANKS == 1 else ("scene_checksum",))


def test_triangles_of_one_surface_in_turn():
    """Each rank has every RANKS-th triangle of a town; all others are ghosts there."""
    surface = vtk.vtkPolyData()
    surface.DeepCopy(with_tree_output(TOWN))
    surface.GetFieldData().RemoveArray("tree_checksum")
    expected = alone(surface)
    ghosts = vtk.vtkUnsignedCharArray()
    ghosts.SetName(vtk.vtkDataSetAttributes.GhostArrayName())
    for i in range(surface.GetNumberOfCells()):
        ghosts.InsertNextValue(0 if interleaved(i) else vtk.vtkDataSetAttributes.DUPLICATECELL)
    surface.GetCellData().AddArray(ghosts)
    for pipeline in (lambda data: data, with_tree):
        check(together(pipeline(surface)), expected, () if RANKS == 1 else ("scene_checksum",))


def test_field_data_of_one_rank():
    """Field data that one rank has reach all, to the last bit; so they do when the same scene is read anew."""
    origin = (121.33612345678901, 31.19734567890123, 2.9)
    tree, echo = with_tree(TOWN), echotools.scan(TOWN, **SETTINGS)
    for _ in range(2):
        scene = blocks_of(TOWN, interleaved)
        if RANK == LAST:
            cloudtools.add_field(scene, "geodetic_origin", origin)
        tree.SetInputData(scene)
        echo.SetInputData(1, scene)
        for algorithm in (tree, echo):
            assert cloudtools.field(update(algorithm).GetOutput(), "geodetic_origin") == [*origin]


def test_second_scan_sends_nothing():
    tree = with_tree(blocks_of(TOWN, lambda i: RANK == 0))
    for first in (tree, blocks_of(TOWN, interleaved)):
        echo = together(first)
        sent = total(echo.GetNumberOfBytesSent()) + total(tree.GetNumberOfBytesSent())
        assert (sent > 0) == (RANKS > 1)
        echo.SetSeed(7)
        check(update(echo), alone(Seed=7))
        if first is not tree:
            # Read again: other objects of the same content.
            copy = vtk.vtkMultiBlockDataSet()
            copy.DeepCopy(first)
            echo.SetInputData(1, copy)
            check(update(echo), alone(Seed=7), LEFT_OUT)
            assert echo.GetNumberOfTracedRays() == 0  # all hits are known
        assert total(echo.GetNumberOfBytesSent()) + total(tree.GetNumberOfBytesSent()) == sent


def test_changed_scene():
    """Other materials, then another shape: the ranks go along, and back again."""
    shape = [echotools.box((60, 0, 0), (10, 30, 10), material) for material in ("Metal", "Wood")]
    shape.append(echotools.box((80, 5, 0), (10, 30, 10), "Wood"))
    echo = together(shape[0] if RANK == LAST else vtk.vtkPolyData())
    for surface in shape + shape[:1]:
        echo.SetInputData(1, surface if RANK == LAST else vtk.vtkPolyData())
        echo.Modified()  # all must execute, whoever's input is another one
        check(update(echo), alone(surface))


def test_beams_of_any_source():
    """A rank's own piece of a table is what it has: interleaved, all on one rank, nothing at all on another."""
    expected, count = alone(), 360
    check(together(TOWN, table(range(RANK, count, RANKS))), expected)
    mine = table(range(count)) if RANK == LAST else vtk.vtkPolyData()
    echo = together(blocks_of(TOWN, lambda i: RANK == 0), mine)
    assert_same(joined(echo.GetOutput(0)), in_order(point_arrays(expected.GetOutput(0))))


def test_a_sensor_that_moves():
    """Every rank has the whole trajectory, and its own columns."""
    beams = echotools.sensor()
    beams.SetInputData(trajectory([(0, 0, 0), (3, 4, 0.5)], [0, 2], [(1, 0, 0, 0), (0.8, 0, 0, 0.6)]))
    expected = echotools.scan(TOWN, beams, **SETTINGS)
    expected.Update()
    assert expected.GetOutput().GetPointData().HasArray("sensor_position")
    check(together(blocks_of(TOWN, interleaved), beams), expected)


def test_nothing_anywhere():
    echo = together(vtk.vtkPolyData())
    assert joined(echo.GetOutput(0)) == {} or len(joined(echo.GetOutput(0))["beam_id"]) == 0
    assert len(joined(echo.GetOutput(1))["beam_id"]) == 360
    echo = together(TOWN, vtk.vtkPolyData())
    assert echo.GetOutput(0).GetNumberOfPoints() == 0


def test_alone_and_together_in_turn():
    """What one rank merged of its own is not taken for the whole, nor the other way round."""
    mine = blocks_of(TOWN, interleaved)
    for pipeline in (lambda data: data, with_tree):
        echo = echotools.scan(pipeline(mine), **SETTINGS)
        for _ in range(2):
            echo.UpdatePiece(0, 1, 0)
            assert_same(in_order(point_arrays(echo.GetOutput())), in_order(point_arrays(alone(mine).GetOutput())))
            check(update(echo), alone())


def check_piece(echo, expected):
    """This rank's piece alone is as it is in the whole."""
    mine, whole = (in_order(point_arrays(e.GetOutput())) for e in (echo, expected))
    beams = point_arrays(echo.GetOutput(1))["beam_id"]
    assert_same(mine, {name: values[np.isin(whole["beam_id"], beams)] for name, values in whole.items()})


def test_controllers_of_ones_own():
    """The ranks of another controller work together, those of each parting in turn; without one each works alone."""
    if RANKS == 1:
        return
    mine = blocks_of(TOWN, interleaved)
    echo = echotools.scan(mine, **SETTINGS)
    assert echo.GetController() == CONTROLLER
    for parting in (RANK % 2, RANK // 2, RANK % 2):
        group = CONTROLLER.PartitionController(parting, RANK)
        rank, ranks = group.GetLocalProcessId(), group.GetNumberOfProcesses()
        members = [int(text) for text, other in zip(exchange(str(RANK)), exchange(str(parting))) if other
                   == str(parting)]
        echo.SetController(group)
        echo.UpdatePiece(rank, ranks, 0)
        check_piece(echo, alone(blocks_of(TOWN, lambda i: i % RANKS in members)))
    echo.SetController(None)
    check_piece(update(echo), alone(mine))


def test_work_of_ones_own():
    """A piece that one rank makes by itself needs no other rank."""
    if RANK == LAST:
        echo = echotools.scan(TOWN, **SETTINGS)
        echo.UpdatePiece(1, RANKS + 1, 0)
        check_piece(echo, alone())


if __name__ == "__main__":
    main(tests_of(sys.modules[__name__], TestRanksClouds, TestRanksCoverage))
