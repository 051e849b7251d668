# SPDX-License-Identifier: BSD-3-Clause
"""From extracts to reports by the plans as `avianlidar airport` leaves them: those that TestAirport.py writes, and of real airports
where the data folder is there."""
import os
import pathlib
import unittest

import TestAirport

DATA = pathlib.Path(os.environ.get("AVIANLIDAR_DATA_DIR") or "none")


TestAirport.PAGES = True


class Written(TestAirport.Extracts):
    """The same, and their reports."""


@unittest.skipUnless(DATA.is_dir(), "AVIANLIDAR_DATA_DIR is not set")
class Real(unittest.TestCase):
    def test_reports(self):
        for name, file in (("hongqiao", DATA / "airport_zsss" / "osm" / "ZSSS_osm.geojson"),
                           ("neubrandenburg", DATA / "osm_neubrandenburg" / "edbn_3km.geojson")):
            folder = TestAirport.fresh("reports-" + name)
            for words in (("airport", file, "-o", folder), ("coverage", folder / "airport.coverage.json", "-o", folder / "maps"),
                          ("report", folder / "siting.coverage.json", "-o", folder / "report.html", "--siting-set", "spacing=400", "--siting-set", "draws=0")):
                code, said = TestAirport.run(*words)
                self.assertEqual(code, 0, said)
            self.assertGreater((folder / "report.html").stat().st_size, 1e5)


if __name__ == "__main__":
    unittest.main()
