# SPDX-License-Identifier: BSD-3-Clause
"""A process that forks after a scan, as Python's multiprocessing does with the context `fork`: the child and its own child
scan, build trees and compare clouds, with the numbers of the parent. A child that hangs is killed, and a failure."""
import hashlib
import multiprocessing
import subprocess
import sys
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
    tree.SetInputData(town(2))
    one, two = scan(town(1), sensor(180, 8)), scan(tree, sensor(180, 8))
    for echo in (one, two):
        echo.SetNumberOfThreads(threads)
        echo.SetNumberOfReflections(2)
        echo.Update()
    comparison = al.vtkAvianLidarCloudComparison()
    comparison.SetInputData(0, one.GetOutput())
    comparison.SetInputData(1, two.GetOutput())
    comparison.Update()
    assert one.GetOutput().GetNumberOfPoints() > 100
    return digest(one.GetOutput()), digest(two.GetOutput()), comparison.GetHausdorffDistance()


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
    def test_after_a_scan(self):
        for threads in (4, 1, 0):
            with self.subTest(threads=threads):
                expected = work(threads)
                self.assertEqual(in_child(send, threads), expected)
                self.assertEqual(work(threads), expected)  # the parent goes on

    def test_a_child_forks(self):
        expected = work(3)
        self.assertEqual(in_child(send_from_a_grandchild, 3), (expected, expected))

    def test_a_pool(self):
        expected = work(2)
        with FORK.Pool(3) as pool:
            self.assertEqual(pool.map_async(work, [1, 2, 3, 4]).get(4 * HANGS), 4 * [expected])

    def test_before_anything_ran(self):
        expected = work(4)
        fresh = "import TestFork; result = TestFork.in_child(TestFork.send, 4); assert TestFork.work(4) == result; print(result)"
        run = subprocess.run([sys.executable, "-c", fresh], capture_output=True, text=True, timeout=4 * HANGS,
                             cwd=sys.path[0])
        self.assertEqual(run.stdout.strip(), str(expected), run.stderr)


if __name__ == "__main__":
    unittest.main()
