# SPDX-License-Identifier: BSD-3-Clause
"""The notebook runs, its page and pictures are made, and what is committed holds no results."""
import os
import pathlib
import re
import shutil
import sys
import unittest

import nbformat

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"]) / "Examples" / "notebook"
OUT = pathlib.Path(os.environ["AVIANLIDAR_TEST_OUTPUT_DIR"]) / "TestNotebook"
sys.path.insert(0, str(SOURCE))
import render_notebook  # noqa: E402


class Notebook(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(OUT, ignore_errors=True)
        cls.notebook = render_notebook.main(["--out", str(OUT)])
        cls.said = {cell.id: "".join(output.text for output in cell.outputs if output.output_type == "stream")
                    for cell in cls.notebook.cells if cell.cell_type == "code"}

    def test_committed_without_results(self):
        notebook = nbformat.read(SOURCE / "airport.ipynb", as_version=4)
        for cell in notebook.cells:
            if cell.cell_type == "code":
                self.assertEqual((cell.outputs, cell.execution_count), ([], None), cell.id)

    def test_what_it_says(self):
        self.assertGreater(int(re.match(r"(\d+) echoes", self.said["scan"])[1]), 1400)
        haze = [(int(echoes), int(rays))
                for echoes, rays in re.findall(r"(\d+) echoes, (\d+) rays traced", self.said["haze"])]
        # A fresh scan traces thousands; lit again, few paths that were left out before are.
        self.assertTrue(all(rays < 1000 for _, rays in haze), haze)
        self.assertEqual(haze, sorted(haze, key=lambda one: one[0], reverse=True))
        self.assertFalse([name for name, text in self.said.items() if "Warning" in text])

    def test_page_and_pictures(self):
        page = (OUT / "airport.html").read_text("utf-8")
        for name in ("energy-image", "map", "range-image"):
            self.assertEqual((OUT / f"{name}.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(len(re.findall(r'<img [^>]*src="data:image/png;base64,', page)), 3)
        self.assertEqual(re.findall(r'(?:src|href)="https?://[^"]*\.(?:js|css)[^"]*"', page), [])  # no network
