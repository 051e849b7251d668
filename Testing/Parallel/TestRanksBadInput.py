# SPDX-License-Identifier: BSD-3-Clause
"""The table of bad inputs (badinput.py) on one rank, on another and on all: each ends with an error on all ranks, empty
outputs and no hang, and the next good input gives all of them the echoes of one process."""

import faulthandler
import sys

from paralleltools import LAST, RANK, RANKS, assert_same, exchange, in_order, joined, main, point_arrays
import badinput
import echotools
from avianlidar import vtkAvianLidar as al

# A case that hangs is named, with where it hangs, and ends the job.
SECONDS = 120
SETTINGS = {"RaysPerBeam": 20, "NumberOfThreads": 1}
WHO = [{0}, {LAST}, set(range(RANKS))] if RANKS > 1 else [{0}]


class Chain:
    """Beams and surfaces of this rank, through the tree or not, and what is said."""

    def __init__(self, with_tree, surfaces):
        self.tree = al.vtkAvianLidarCollisionTree() if with_tree else None
        self.echo = echotools.scan(self.tree or surfaces, badinput.beams(None, RANK, RANKS), **SETTINGS)
        self.messages = echotools.Messages(self.echo, *([self.tree] if with_tree else []))
        self.give_surfaces(surfaces)

    def give_surfaces(self, data):
        if self.tree:
            self.tree.SetInputDataObject(0, data)
            self.tree.Modified()
        else:
            self.echo.SetInputDataObject(1, data)
        self.echo.Modified()

    def give_beams(self, data):
        self.echo.SetInputDataObject(0, data)
        self.echo.Modified()

    def set(self, algorithm, **properties):
        for name, value in properties.items():
            getattr(algorithm, "Set" + name)(value)
        algorithm.Modified()
        self.echo.Modified()

    def update(self):
        """Whether VTK says that it went well on this rank."""
        self.messages.errors.clear()
        return bool(self.echo.UpdatePiece(RANK, RANKS, 0))


def good_echoes(surfaces):
    echo = echotools.scan(surfaces, badinput.beams(), **SETTINGS)
    echo.Update()
    return in_order(point_arrays(echo.GetOutput()))


def check(what, chain, who, words, good):
    """An error where the input is bad and on rank 0, its words among them; nobody goes on. Then all is mended."""
    faulthandler.dump_traceback_later(SECONDS, exit=True, file=sys.__stderr__)
    ends = exchange("went on" if chain.update() else "ended")
    heard = exchange("\n".join(chain.messages.errors))
    sizes = exchange(" ".join(str(chain.echo.GetOutput(port).GetNumberOfPoints()) for port in (0, 1)))
    assert set(ends) == {"ended"}, (what, who, ends, heard)
    assert set(sizes) == {"0 0"}, (what, who, sizes, heard)
    assert all(heard[rank] for rank in who | {0}), (what, who, heard)
    assert any(all(word in text for word in words) for text in heard), (what, who, words, heard)
    good()
    chain.set(chain.echo, **SETTINGS)
    ends = exchange("went on" if chain.update() else "ended")
    heard = exchange("\n".join(chain.messages.errors))
    assert set(ends) == {"went on"} and not any(heard), (what, who, ends, heard)
    faulthandler.cancel_dump_traceback_later()


def counterpart(data):
    """Good surfaces of the same structure."""
    if data.IsA("vtkPolyData"):
        return badinput.surfaces()
    return echotools.town(count=data.GetNumberOfBlocks())


def test_surfaces():
    for with_tree in (False, True):
        for number, (data, words) in enumerate(badinput.bad_surfaces):
            good = counterpart(data)
            expected = good_echoes(good)
            # What is found when the surfaces of all are together is counted there: the number may be another.
            words = [word for word in words if not word.startswith(("point ", "cell "))]
            for who in WHO:
                chain = Chain(with_tree, data if RANK in who else good)
                check(f"surfaces {number}, tree {with_tree}", chain, who, words, lambda: chain.give_surfaces(good))
                assert_same(joined(chain.echo.GetOutput()), expected)


def test_beams():
    expected = good_echoes(badinput.surfaces())
    good = badinput.beams(None, RANK, RANKS)
    for number, (change, words) in enumerate(badinput.bad_beams):
        bad = badinput.beams(change, RANK, RANKS)
        for who in WHO:
            chain = Chain(False, badinput.surfaces())
            chain.give_beams(bad if RANK in who else good)
            check(f"beams {number}", chain, who, words, lambda: chain.give_beams(good))
            assert_same(joined(chain.echo.GetOutput()), expected)


def test_properties():
    expected = good_echoes(badinput.surfaces())
    for name, value in badinput.bad_properties:
        many = {"RaysPerBeam": 70000} if value == 2000000000 else {}  # more paths than can be numbered
        for who in WHO:
            chain = Chain(False, badinput.surfaces())
            before = {key: getattr(chain.echo, "Get" + key)() for key in (name, *many)}
            chain.set(chain.echo, **(dict(many, **{name: value}) if RANK in who else before))
            check(f"{name} = {value}", chain, who, [name], lambda: chain.set(chain.echo, **before))
            assert_same(joined(chain.echo.GetOutput()), expected)


def test_properties_of_the_tree():
    expected = good_echoes(badinput.surfaces())
    for name, value in badinput.bad_tree_properties:
        for who in WHO:
            chain = Chain(True, badinput.surfaces())
            before = {name: getattr(chain.tree, "Get" + name)()}
            chain.set(chain.tree, **({name: value} if RANK in who else before))
            check(f"tree: {name} = {value}", chain, who, [name], lambda: chain.set(chain.tree, **before))
            assert_same(joined(chain.echo.GetOutput()), expected)


if __name__ == "__main__":
    main([test_surfaces, test_beams, test_properties, test_properties_of_the_tree])
