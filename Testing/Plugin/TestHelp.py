# SPDX-License-Identifier: BSD-3-Clause
"""The plugin's help is a Qt help file within the plugin: a page to start with and one page per proxy, all in the table
of contents, links lead somewhere, tooltips read well as pages. Run by the system's Python: TestHelp.py help.qch."""

import os
import sqlite3
import sys
import unittest
import xml.etree.ElementTree as ElementTree
import zlib
from html.parser import HTMLParser

PLUGIN = os.environ["AVIANLIDAR_PLUGIN"]
SOURCE_DIR = os.environ["AVIANLIDAR_SOURCE_DIR"]
QCH = sys.argv.pop(1) if len(sys.argv) > 1 else ""
PROXIES = os.path.join(os.path.dirname(os.path.dirname(QCH)), "AvianLidarProxies.xml")  # made beside the help


def proxies():
    """Pages that there must be: group.name of every proxy in the plugin's XML that menus show."""
    pages = set()
    folders = [os.path.join(SOURCE_DIR, "Plugin", kind) for kind in ("Filters", "IO")]
    files = [os.path.join(folder, file) for folder in folders for file in os.listdir(folder)]
    for file in (*files, PROXIES):
        for group in ElementTree.parse(file).getroot().iter("ProxyGroup"):
            if not group.get("name").startswith(("internal", "representations")):
                pages |= {f"{group.get('name')}.{proxy.get('name')}.html" for proxy in group}
    return pages


class Page(HTMLParser):
    """Links, pictures and text of a page."""

    def __init__(self, content):
        super().__init__()
        self.targets, self.text, self.tags = [], "", []
        self.feed(content)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.targets += [value for key, value in attributes if key in ("href", "src")]

    def handle_data(self, data):
        self.text += data


class TestHelp(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        connection = sqlite3.connect(f"file:{QCH}?mode=ro", uri=True)
        query = "SELECT Name, Data FROM FileNameTable, FileDataTable WHERE FileId = Id AND Data IS NOT NULL"
        rows = connection.execute(query).fetchall()
        # Qt puts the length, four bytes, before the compressed data.
        cls.files = {name: zlib.decompress(data[4:]) for name, data in rows}
        cls.pages = {name: Page(data.decode()) for name, data in cls.files.items() if name.endswith(".html")}
        cls.contents = b"".join(data for (data,) in connection.execute("SELECT Data FROM ContentsTable"))
        connection.close()

    def test_it_is_in_the_plugin(self):
        with open(QCH, "rb") as file, open(PLUGIN, "rb") as plugin:
            self.assertTrue(file.read() in plugin.read())

    def test_every_proxy_has_a_page(self):
        self.assertGreater(len(proxies()), 15)
        self.assertEqual(proxies() - set(self.pages), set())
        missing = {page for page in proxies() | {"index.html"} if page.encode("utf-16-be") not in self.contents}
        self.assertEqual(missing, set())

    def test_links(self):
        for name, page in self.pages.items():
            for target in page.targets:
                self.assertIn(target, self.files, name)
        start = self.pages["index.html"]
        self.assertIn("start-view.png", start.targets)
        self.assertTrue(self.files["start-view.png"].startswith(b"\x89PNG"))
        for macro in os.listdir(os.path.join(os.path.dirname(PLUGIN), "Macros")):
            self.assertIn(os.path.splitext(macro)[0], start.text)

    def test_texts_are_not_markup(self):
        """ParaView takes what stands between two stars for emphasis."""
        for name in proxies():
            page = self.pages[name]
            self.assertEqual({"em", "b"} & set(page.tags), set(), name)


if __name__ == "__main__":
    unittest.main()
