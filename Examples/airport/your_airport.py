#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The folder that `avianlidar airport` leaves of Neubrandenburg, from raw OSM of the town in the data folder: the picture of
Documentation/your-airport.md.

    PYTHONPATH=$(cat build/paraview/python-path) /usr/bin/python3 your_airport.py [--out DIR]
"""
import argparse
import bz2
import os
import pathlib
import tempfile

from avianlidar._command import main as avianlidar


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("neubrandenburg"))
    out = parser.parse_args(arguments).out
    packed = pathlib.Path(os.environ["AVIANLIDAR_DATA_DIR"]) / "osm_neubrandenburg" / "neubrandenburg.osm.bz2"
    with tempfile.TemporaryDirectory() as folder:
        extract = pathlib.Path(folder) / "neubrandenburg.osm"
        extract.write_bytes(bz2.decompress(packed.read_bytes()))
        avianlidar(["airport", str(extract), "--icao", "EDBN", "-o", str(out)])


if __name__ == "__main__":
    main()
