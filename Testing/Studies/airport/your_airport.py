# SPDX-License-Identifier: BSD-3-Clause
"""The folder that `avianlidar airport` leaves of Neubrandenburg, from raw OSM of the town in the data folder: the picture of
Documentation/guide/airport.md.

    Testing/Studies/run.py your_airport
"""
import bz2
import pathlib
import tempfile

from avianlidar._command import main as avianlidar
from running import study

PACKED = "osm_neubrandenburg/neubrandenburg.osm.bz2"


@study(data=[PACKED])
def main(options):
    with tempfile.TemporaryDirectory() as folder:
        extract = pathlib.Path(folder) / "neubrandenburg.osm"
        extract.write_bytes(bz2.decompress((options.data / PACKED).read_bytes()))
        return avianlidar(["airport", str(extract), "--icao", "EDBN", "-o", str(options.out)])
