# SPDX-License-Identifier: BSD-3-Clause
"""The documentation as a site: it is made without a warning, and Chromium shows its menu from the disk, without a
network. Links are TestDocumentation's."""
import os
import pathlib
import shutil
import subprocess
import unittest

import exampletools
from browser import Browser

SITE = pathlib.Path(exampletools.OUTPUT) / "TestSite"
MAKE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Documentation" / "make_site.sh"


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(SITE, ignore_errors=True)
        made = subprocess.run([MAKE, SITE], capture_output=True, text=True, check=False)
        assert made.returncode == 0, made.stderr
        cls.browser = Browser()

    @classmethod
    def tearDownClass(cls):
        cls.browser.driver.quit()

    def test_the_menu_leads_to_every_page(self):
        asked = self.browser.open(SITE / "index.html")
        self.assertEqual([address for address in asked if not address.startswith(("file:", "data:"))], [])
        self.assertEqual(self.browser.complaints(), [])
        menu = self.browser.run("return [...document.querySelectorAll('.wy-menu a.reference')].map(a => a.href)")
        for file in SITE.rglob("*.html"):
            if file.name not in ("index.html", "README.html", "genindex.html", "py-modindex.html", "search.html"):
                self.assertIn(file.resolve().as_uri(), menu)
