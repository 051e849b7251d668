# SPDX-License-Identifier: BSD-3-Clause
"""The documentation as a site: every link of every page leads somewhere, and Chromium shows its menu from the disk, without
a network."""
import html.parser
import os
import pathlib
import shutil
import subprocess
import unittest
import urllib.parse

import exampletools
from browser import Browser

SITE = pathlib.Path(exampletools.OUTPUT) / "TestSite"
MAKE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Documentation" / "make_site.sh"


class Page(html.parser.HTMLParser):
    """Names of a page, and what it links to."""

    def __init__(self, file):
        super().__init__()
        self.names, self.links = set(), set()
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.names.add(values.get("id"))
        self.links |= {values[name] for name in ("href", "src") if values.get(name)}


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

    def no_network_and_no_complaint(self, asked):
        self.assertEqual([address for address in asked if not address.startswith(("file:", "data:"))], [])
        self.assertEqual(self.browser.complaints(), [])

    def test_links_lead_somewhere(self):
        pages = {file.resolve(): Page(file) for file in SITE.rglob("*.html")}
        self.assertGreater(len(pages), 50)
        count = 0
        for file, page in pages.items():
            for link in page.links:
                parts = urllib.parse.urlsplit(link)
                if parts.scheme in ("http", "https", "data", "mailto"):
                    continue
                with self.subTest(page=file.name, link=link):
                    count += 1
                    target = (file.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else file
                    self.assertTrue(target.is_file())
                    if parts.fragment and target in pages:
                        self.assertIn(urllib.parse.unquote(parts.fragment), pages[target].names)
        self.assertGreater(count, 4000)

    def test_the_menu_leads_to_every_page(self):
        self.no_network_and_no_complaint(self.browser.open(SITE / "index.html"))
        menu = self.browser.run("return [...document.querySelectorAll('.wy-menu a.reference')].map(a => a.href)")
        for file in SITE.rglob("*.html"):
            if file.name not in ("index.html", "README.html", "genindex.html", "py-modindex.html", "search.html"):
                self.assertIn(file.resolve().as_uri(), menu)


if __name__ == "__main__":
    unittest.main()
