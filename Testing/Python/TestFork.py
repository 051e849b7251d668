# SPDX-License-Identifier: BSD-3-Clause
"""A process that forks after a scan, as Python's multiprocessing does with the context `fork`: the child and its own
child scan, build trees and compare clouds, with the numbers of the parent. A child that hangs is killed, and a
failure."""
import hashlib
import multiprocessing
import unittest

from avianlidar import vtkAvianLidar as al
from echotools import arrays, scan, sensor, town

FORK = multiprocessing.get_context("fork")
HANGS = 60  # s; a scan of this test takes less than one


def digest(data):
    found = arrays(data)
    return hashlib.sha256(b"".join(name.encode() + found[name].tobytes() for name in sorted(found))).hexdigest()


def work(threads):
    """What a scan with a tree of its own, one with a tree made before, and a comparison of both clouds give."""
    tree = al.vtkAvianLidarCollisionTree()
    tree.SetInputData(town(2, 20))
    scans = [scan(surfaces, sensor(180, 8), NumberOfThreads=threads, NumberOfReflections=2)
             for surfaces in (town(1, 20), tree)]
    comparison = al.vtkAvianLidarCloudComparison()
    for port, echo in enumerate(scans):
        echo.Update()
        comparison.SetInputData(port, echo.GetOutput())
    comparison.Update()
    assert scans[0].GetOutput().GetNumberOfPoints() > 50
    return [digest(echo.GetOutput()) for echo in scans], comparison.GetHausdorffDistance()


def send(pipe, threads):
    pipe.send(work(threads))


def send_from_a_grandchild(pipe, threads):
    pipe.send((work(threads), in_child(send, threads)))


def in_child(task, threads):
    """What a task sends from a child, or the failure that a hang is."""
    here, there = FORK.Pipe(duplex=False)
    child = FORK.Process(target=task, args=(there, threads))
    child.start()
    there.close()
    try:
        if not here.poll(HANGS):
            raise AssertionError("the child hangs")
        result = here.recv()
        child.join(HANGS)
        if child.exitcode != 0:
            raise AssertionError(f"the child ended with {child.exitcode}")
        return result
    finally:
        child.kill()
        child.join()


class TestFork(unittest.TestCase):
    def test_0_before_anything_ran(self):
        """Comes first, by its name."""
        found = in_child(send, 4)
        self.assertEqual(work(4), found)

    def test_after_a_scan(self):
        expected = work(0)
        self.assertEqual(in_child(send, 0), expected)
        self.assertEqual(work(0), expected)  # the parent goes on

    def test_a_child_forks(self):
        expected = work(3)
        self.assertEqual(in_child(send_from_a_grandchild, 3), (expected, expected))
