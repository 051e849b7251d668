# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces and comparisons for the tests of the helpers of the package."""
import contextlib
import csv
import io
import multiprocessing
import os
import pty
import socket
import subprocess
import warnings

import numpy as np


def box(low, high):
    """Corners and triangles of a box, metres."""
    ends = (low, high)
    points = np.array([[ends[(i >> axis) & 1][axis] for axis in range(3)] for i in range(8)], dtype=float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points, np.array([(a, b, c) for a, b, c, d in sides] + [(a, c, d) for a, b, c, d in sides])


def wall(y, half=5):
    """Corners and triangles of a square across the direction north."""
    return [(-half, y, -half), (half, y, -half), (half, y, half), (-half, y, half)], [(0, 1, 2), (0, 2, 3)]


WALL = box((-20, 50, -5), (20, 52, 15))


def address(array):
    return array.__array_interface__["data"][0]


def same(one, two):
    """Two clouds are the same, bit for bit."""
    return list(one) == list(two) and one.points.tobytes() == two.points.tobytes() and all(
        one[name].tobytes() == two[name].tobytes() for name in one)


def from_terminal(test, work, typed="", **options):
    """What a command writes to a pseudo-terminal, and its exit code; without one the test is skipped. @param
    typed into it @param options of Popen"""
    try:
        parent, child = pty.openpty()
    except OSError as error:  # in a chroot or a container without /dev/pts
        test.skipTest(f"no pseudo-terminal here: {error}")
    with subprocess.Popen(work, **{"stdin": child, "stdout": child, "stderr": child, **options}) as process:
        os.close(child)
        os.write(parent, typed.encode())
        text = b""
        with contextlib.suppress(OSError):  # the terminal's end
            while part := os.read(parent, 4096):
                text += part
    os.close(parent)
    return text.decode(), process.returncode


def run(*words):
    """Exit status of a command, and what it writes to the streams of output and of errors."""
    from avianlidar._command import main  # not for those who use no command
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        try:
            code = main([str(word) for word in words])
        except SystemExit as end:
            code = end.code
    return code, out.getvalue(), err.getvalue()


def error_of(*words):
    """What a command writes to the error stream where it ends with status 2."""
    code, _, said = run(*words)
    assert code == 2, said
    return said


class Server:
    """Answers in a process of its own that nothing is there, and counts who asks."""

    def __init__(self):
        self.listener, self.requests = socket.create_server(("127.0.0.1", 0)), multiprocessing.Value("i", 0)
        self.url = f"http://127.0.0.1:{self.listener.getsockname()[1]}"
        multiprocessing.get_context("fork").Process(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            connection, _ = self.listener.accept()
            with self.requests.get_lock():
                self.requests.value += 1
            connection.recv(1000)
            connection.sendall(b"HTTP/1.0 404 none\r\n\r\n")
            connection.close()

    def asked(self):
        """How many have asked, with this request."""
        with socket.create_connection(self.listener.getsockname()) as connection:
            connection.sendall(b"GET / HTTP/1.0\r\n\r\n")
            assert b"404" in connection.recv(100)
        return self.requests.value


def warned(call):
    """What a call gives, and the texts of its warnings."""
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        return call(), [str(one.message) for one in heard]


def rows_of(file):
    """The rows of a table with a head, {column: text} each."""
    with open(file, newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))
