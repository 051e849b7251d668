# SPDX-License-Identifier: BSD-3-Clause
"""What tests of commands on ranks share. The arguments of a test: mpiexec, pvbatch."""
import os
import pathlib
import shutil
import subprocess
import sys

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
LAUNCHER = sys.argv[1:3]


def fresh(*names):
    """A folder that is not there yet."""
    folder = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"], *names)
    shutil.rmtree(folder, ignore_errors=True)
    return folder


def run(*command):
    return subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, timeout=550)


def on_ranks(*arguments):
    mpiexec, pvbatch = LAUNCHER
    return run(mpiexec, "-n", "2", pvbatch, "--sym", *arguments)
