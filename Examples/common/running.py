# SPDX-License-Identifier: BSD-3-Clause
"""Arguments and errors of the examples: whatever is wrong is said in one line, before any file is written."""
import argparse
import math
import os
import pathlib
import sys

from vtkmodules.util.misc import calldata_type
from vtkmodules.util.vtkConstants import VTK_STRING

from avianlidar import Error
from avianlidar.vtkAvianLidar import vtkAvianLidarSceneReader


class Parser(argparse.ArgumentParser):
    """A bad argument ends with one line and the exit code 2."""

    def error(self, message):
        self.exit(2, f"{self.prog}: {message} (--help says more)\n")


def whole(low, high):
    """An integer from low to high."""
    def convert(text):
        try:
            value = int(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"expected an integer from {low} to {high}, not '{text}'") from None
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"expected an integer from {low} to {high}, not {value}")
        return value
    return convert


def above_zero(text):
    """A finite number greater than 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"expected a number greater than 0, not '{text}'")
    return value


def finite(text):
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"expected a finite number, not '{text}'")
    return value


def file(text):
    """A file that can be read."""
    if not os.path.isfile(text) or not os.access(text, os.R_OK):
        raise argparse.ArgumentTypeError(f"there is no file {text} to read")
    return pathlib.Path(text)


def add_arguments(parser, out):
    """What both examples know."""
    parser.add_argument("--rays", type=whole(1, 1000000), default=100, help="rays per beam, default 100")
    parser.add_argument("--seed", type=whole(-2**31, 2**31 - 1), default=0, help="of the random numbers, default 0")
    parser.add_argument("--threads", type=whole(0, 4096), default=0, help="default 0: as many as there are cores")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(out), help="folder for results")
    parser.add_argument("--no-pictures", action="store_true", help="needs no display")


def parse(parser, argv):
    options = parser.parse_args(argv)
    if not options.no_pictures and not os.environ.get("DISPLAY"):
        sys.exit("Pictures need a display: run this under `xvfb-run -a`, or with --no-pictures.")
    return options


def _chain(algorithm):
    """The algorithm and all that it depends on."""
    found, ahead = [], [algorithm]
    while ahead:
        one = ahead.pop()
        if one is None or one in found:
            continue
        found.append(one)
        for port in range(one.GetNumberOfInputPorts()):
            ahead += [one.GetInputAlgorithm(port, i) for i in range(one.GetNumberOfInputConnections(port))]
    return found


def _run(algorithm, method):
    """Call the method; the first error of the algorithm, or of one that it depends on, ends the script in one line with
    the exit code 1. (What follows an algorithm that failed is not run and keeps its last output: without listening to
    all of them that would be taken for the new one.)"""
    errors, failed = [], []

    @calldata_type(VTK_STRING)
    def keep(caller, _, text):
        # VTK puts file, line, class and address in front.
        errors.append(" ".join(text.split("): ", 1)[-1].split()))
        failed.append(caller)

    observed = [(thing, thing.AddObserver("ErrorEvent", keep))
                for one in _chain(algorithm) for thing in (one, one.GetExecutive())]
    try:
        method()
    finally:
        for thing, tag in observed:
            thing.RemoveObserver(tag)
    for thing in failed:
        thing.Modified()  # else what it left would count as up to date the next time
    if errors:
        sys.exit(errors[0])


def run(work):
    """Do it and return what it gives; an error ends the script in one line with the exit code 1."""
    try:
        return work()
    except (Error, OSError, ValueError) as error:
        sys.exit(" ".join(str(error).split()))


def update(algorithm):
    """Bring it up to date; its first error ends the script in one line with the exit code 1."""
    _run(algorithm, algorithm.Update)


def write(writer):
    """Let it write; its first error ends the script in one line with the exit code 1."""
    _run(writer, writer.Write)


def read_scene(name):
    """The reader of a scene that has surfaces."""
    reader = vtkAvianLidarSceneReader()
    reader.SetFileName(str(name))
    update(reader)
    if reader.GetOutput().GetNumberOfBlocks() == 0:
        sys.exit(f"{name}: no surfaces")
    return reader
