#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Labelled sequences of scans of a scenario, on one process or on several MPI ranks:

    sequence.py hongqiao.scenario.json -o build/sequences
    mpiexec -n 2 pvbatch --sym Examples/sequence/sequence.py Examples/sequence/hongqiao.scenario.json -o build/sequences

The arguments are those of `avianlidar sequence`. Each rank takes whole sequences and one thread. Killed and started
again with the same arguments, the work goes on with the next sequence.

PYTHONPATH has to name the Python package (`cat build/paraview/python-path`).
"""
import sys

from avianlidar._command import main

if __name__ == "__main__":
    code = main(["sequence", *sys.argv[1:]])
    if code:  # a script that ends by sys.exit(0) ends pvbatch before MPI is finalized
        sys.exit(code)
