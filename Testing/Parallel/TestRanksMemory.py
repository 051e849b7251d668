# SPDX-License-Identifier: BSD-3-Clause
"""Memory that runs out in the work of one rank, or what else is thrown there, is an error on all, with its message and
without a hang; after it the same filters scan as ever. Needs FailingNew.cxx to be preloaded."""

import os

from paralleltools import (LAST, RANK, RANKS, assert_same, blocks_of, exchange, failing_new, in_order, joined, main,
                           point_arrays, table, update)
import echotools
import vtk
from avianlidar import vtkAvianLidar as al

NEW = failing_new()
TOWN = echotools.town(3, 60)
SETTINGS = {"RaysPerBeam": 20, "NumberOfThreads": 1}
LEAST, MOST = 256, 2**40  # bytes: what grows with surfaces, beams or blocks, and no message's few words
SOME = 3
TRIED = int(os.environ.get("AVIANLIDAR_ALLOCATIONS", SOME))  # of the allocations on each rank
WORDS = ("not enough memory", "A planted error", "An unknown exception was thrown")
METAL = [echotools.box((x, 0, 0), (5, 5, 5), "Metal") for x in (50, 30)]


def run(make, failing, which, least=LEAST, most=MOST, thrown=0):
    """Filters that ran with the `which`-th allocation of rank `failing` failing, what they said, and how many were
    counted there."""
    filters = make()
    messages = echotools.Messages(*filters)
    if RANK == failing:
        NEW.failing_new_begin(which, least, most, False, thrown)
    update(filters[-1])
    count = NEW.failing_new_end() if RANK == failing else 0
    return filters, messages, int(exchange(str(count))[failing])


def tried(count):
    return range(1, count + 1, max(1, count // TRIED))


def check_failed(filters, messages, failing, which, words=WORDS[0]):
    heard = exchange("\n".join(messages.errors))
    if not any(heard):
        return False
    assert words in heard[failing], (which, heard)
    assert words in heard[0] or "upstream" in heard[0], (which, heard)
    sizes = exchange(str(sum(filters[-1].GetOutput(port).GetNumberOfPoints() for port in (0, 1))))
    assert set(sizes) == {"0"}, (which, sizes)
    mend(filters, messages, which)
    return True


def mend(filters, messages, which):
    messages.errors.clear()
    for algorithm in filters:
        algorithm.Modified()
    update(filters[-1])
    assert not any(exchange("\n".join(messages.errors))), which


def spread():
    return blocks_of(TOWN, lambda i: i % RANKS == RANK)


def test_scans():
    """Surfaces that are spread, the tree filter, and beams in turn, of which all ids are compared."""
    def plain():
        sensor = echotools.sensor()
        return [sensor, echotools.scan(spread(), sensor, **SETTINGS)]

    def with_tree():
        sensor, tree = echotools.sensor(), al.vtkAvianLidarCollisionTree()
        tree.SetInputData(spread())
        return [sensor, tree, echotools.scan(tree, sensor, **SETTINGS)]

    beams = table(range(RANK, 360, RANKS))
    alone = echotools.scan(TOWN, **SETTINGS)
    alone.Update()
    expected = in_order(point_arrays(alone.GetOutput()))
    makes = (plain, with_tree, lambda: [echotools.scan(spread(), beams, **SETTINGS)])
    for make in makes if TRIED > SOME else makes[:1]:
        for failing in {0, LAST}:
            count = run(make, failing, 0)[2]
            for thrown, words in enumerate(WORDS if make is plain else WORDS[:1]):
                failed = 0
                for which in tried(count):
                    filters, messages, _ = run(make, failing, which, thrown=thrown)
                    failed += check_failed(filters, messages, failing, which, words)
                    assert_same(joined(filters[-1].GetOutput()), expected)
                assert failed > min(TRIED, count) / 2, (failed, count)


def made(before, after):
    """The tree filter with another scene than before."""
    def make():
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputData(before)
        update(tree)
        tree.SetInputData(after)
        return [tree]
    return make


def test_the_scene_before_is_not_put_out():
    """Allocations fail while the tree filter has another scene than before, with a tree in its field data."""
    first = al.vtkAvianLidarCollisionTree()
    first.SetInputData(echotools.town(3, 12))
    first.Update()
    scene = vtk.vtkPolyData()
    scene.DeepCopy(first.GetOutput())
    scene.GetFieldData().GetArray("tree_checksum").GetInformation().Clear()
    make = made(METAL[0], scene)
    for which in tried(run(make, LAST, 0)[2]):
        filters, messages, _ = run(make, LAST, which)
        check_failed(filters, messages, LAST, which)
        assert RANK != 0 or filters[0].GetOutput().GetNumberOfCells() == scene.GetNumberOfCells(), which


def test_a_few_bytes_that_are_missing():
    """Small allocations of the tree filter fail on a rank: nobody waits for ever, and what is put out the next time is
    no scene from before."""
    make = made(*METAL)
    for failing in {0, LAST}:
        for which in tried(run(make, failing, 0, 1, LEAST - 1)[2]):
            filters, messages, _ = run(make, failing, which, 1, LEAST - 1)
            mend(filters, messages, which)
            bounds = filters[0].GetOutput().GetBounds()
            assert RANK != 0 or bounds == METAL[1].GetBounds(), (failing, which, bounds)


def test_no_memory_for_a_message():
    """VTK leaves out messages of other ranks for which there is no memory."""
    echo = echotools.scan(TOWN, **SETTINGS)
    if RANK == LAST:
        echo.SetInputData(1, METAL[0])
        NEW.failing_new_begin(1, 2000, MOST, True, 0)  # bytes: VTK's text of a box is longer
    messages = echotools.Messages(echo)
    update(echo)
    if RANK == LAST:
        NEW.failing_new_end()
    assert WORDS[0] in exchange("\n".join(messages.errors))[0]
    assert set(exchange(str(echo.GetOutput().GetNumberOfPoints()))) == {"0"}
    mend([echo], messages, 1)
    assert len(joined(echo.GetOutput())["beam_id"]) > 0


if __name__ == "__main__":
    main([test_scans, test_no_memory_for_a_message, test_the_scene_before_is_not_put_out,
          test_a_few_bytes_that_are_missing])
