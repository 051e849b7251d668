# SPDX-License-Identifier: BSD-3-Clause
"""Memory that runs out in the work of one rank is an error on all, with its message and without a hang; after it the
same filters scan as ever. Needs FailingNew.cxx to be preloaded."""

from paralleltools import (LAST, RANK, RANKS, assert_same, blocks_of, exchange, failing_new, in_order, joined, main,
                           point_arrays, table, update)
import echotools
import vtk
from avianlidar import vtkAvianLidar as al

NEW = failing_new()
TOWN = echotools.town(3, 60)
SETTINGS = {"RaysPerBeam": 20, "NumberOfThreads": 1}
LEAST, MOST = 256, 2**40  # bytes: what grows with surfaces, beams or blocks, and no message's few words
TRIED = 8  # of the allocations on each rank


def run(make, failing, which, least=LEAST, most=MOST):
    """Filters that ran with the `which`-th allocation of rank `failing` failing, what they said, and how many were
    counted there."""
    filters = make()
    messages = echotools.Messages(*filters)
    if RANK == failing:
        NEW.failing_new_begin(which, least, most, False)
    update(filters[-1])
    count = NEW.failing_new_end() if RANK == failing else 0
    return filters, messages, int(exchange(str(count))[failing])


def check_failed(filters, messages, failing, which):
    heard = exchange("\n".join(messages.errors))
    if not any(heard):
        return False
    assert "not enough memory" in heard[failing], (which, heard)
    assert "not enough memory" in heard[0] or "upstream" in heard[0], (which, heard)
    sizes = exchange(str(sum(filters[-1].GetOutput(port).GetNumberOfPoints() for port in (0, 1))))
    assert set(sizes) == {"0"}, (which, sizes)
    messages.errors.clear()
    for algorithm in filters:
        algorithm.Modified()
    update(filters[-1])
    assert not any(exchange("\n".join(messages.errors))), which
    return True


def try_all(make):
    """Let allocations fail on the first rank and on the last. `make`: filters, the last of them the echo filter."""
    alone = echotools.scan(TOWN, **SETTINGS)
    alone.Update()
    expected = in_order(point_arrays(alone.GetOutput()))
    for failing in {0, LAST}:
        count = run(make, failing, 0)[2]
        failed = 0
        for which in range(1, count + 1, max(1, count // TRIED)):
            filters, messages, _ = run(make, failing, which)
            failed += check_failed(filters, messages, failing, which)
            assert_same(joined(filters[-1].GetOutput()), expected)
        if RANK == 0:
            print(f"  rank {failing}: {count} allocations; {failed} of those tried were errors", flush=True)
        assert failed > TRIED / 2, failed


def spread():
    return blocks_of(TOWN, lambda i: i % RANKS == RANK)


def test_surfaces_are_spread():
    def make():
        sensor = echotools.sensor()
        return [sensor, echotools.scan(spread(), sensor, **SETTINGS)]
    try_all(make)


def test_tree_filter():
    def make():
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputData(spread())
        sensor = echotools.sensor()
        return [sensor, tree, echotools.scan(tree, sensor, **SETTINGS)]
    try_all(make)


def test_beams_in_turn():
    """All ids of beams are compared."""
    beams = table(range(RANK, 360, RANKS))
    try_all(lambda: [echotools.scan(spread(), beams, **SETTINGS)])


def test_the_scene_before_is_not_put_out():
    """Each allocation fails while the tree filter has another scene than before, with a tree in its field data."""
    first = al.vtkAvianLidarCollisionTree()
    first.SetInputData(echotools.town(3, 12))
    first.Update()
    scene = vtk.vtkPolyData()
    scene.DeepCopy(first.GetOutput())
    scene.GetFieldData().GetArray("tree_checksum").GetInformation().Clear()
    before = echotools.box((50, 0, 0), (5, 5, 5), "Metal")

    def make():
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputData(before)
        update(tree)
        tree.SetInputData(scene)
        return [tree]
    for which in range(1, run(make, LAST, 0)[2] + 1):
        filters, messages, _ = run(make, LAST, which)
        check_failed(filters, messages, LAST, which)
        assert RANK != 0 or filters[0].GetOutput().GetNumberOfCells() == scene.GetNumberOfCells(), which


def test_a_few_bytes_that_are_missing():
    """Each small allocation of the tree filter fails on a rank: nobody waits for ever, and what is put out the next time is no scene
    from before."""
    before, after = echotools.box((50, 0, 0), (5, 5, 5), "Metal"), echotools.box((30, 0, 0), (2, 2, 2), "Metal")

    def make():
        tree = al.vtkAvianLidarCollisionTree()
        tree.SetInputData(before)
        update(tree)
        tree.SetInputData(after)
        return [tree]
    for failing in {0, LAST}:
        for which in range(1, run(make, failing, 0, 1, LEAST - 1)[2] + 1):
            (tree,), messages, _ = run(make, failing, which, 1, LEAST - 1)
            messages.errors.clear()
            tree.Modified()
            update(tree)
            assert not any(exchange("\n".join(messages.errors))), which
            assert RANK != 0 or tree.GetOutput().GetBounds() == after.GetBounds(), (failing, which, tree.GetOutput().GetBounds())


def test_no_memory_for_a_message():
    """What another rank sends is left out by VTK where there is no memory for it."""
    echo = echotools.scan(TOWN, **SETTINGS)
    if RANK == LAST:
        echo.SetInputData(1, echotools.box((50, 0, 0), (5, 5, 5), "Metal"))
        NEW.failing_new_begin(1, 2000, MOST, True)  # bytes: VTK's text of a box is longer
    messages = echotools.Messages(echo)
    update(echo)
    if RANK == LAST:
        NEW.failing_new_end()
    assert "not enough memory" in exchange("\n".join(messages.errors))[0]
    assert set(exchange(str(echo.GetOutput().GetNumberOfPoints()))) == {"0"}
    messages.errors.clear()
    echo.Modified()
    update(echo)
    assert not any(exchange("\n".join(messages.errors)))
    assert len(joined(echo.GetOutput())["beam_id"]) > 0


if __name__ == "__main__":
    main([test_surfaces_are_spread, test_tree_filter, test_beams_in_turn, test_no_memory_for_a_message,
          test_the_scene_before_is_not_put_out, test_a_few_bytes_that_are_missing])
