# SPDX-License-Identifier: BSD-3-Clause
"""The pages say what is there: links and the files that they name exist, generated tables are current, and every row
of the page on the paper has a verdict."""
import os
import pathlib
import re
import sys
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "Testing" / "Studies" / "paper"))
sys.path[:0] = [str(SOURCE / "Testing"), str(SOURCE / "Documentation")]
import page_tables  # noqa: E402
import reliability_tables  # noqa: E402
import verdicts  # noqa: E402

FOLDERS = ("CMake", "Documentation", "Examples", "Filters", "IO", "Plugin", "Python", "Testing")
NAMES = {file.name for folder in FOLDERS for file in (SOURCE / folder).rglob("*")} | {
    file.name for file in SOURCE.iterdir()}
PAGES = [*SOURCE.glob("*.md"), *(page for folder in FOLDERS for page in (SOURCE / folder).rglob("*.md"))]
# What examples and tools leave, and what stands for any name.
NOT_OURS = {"table.md", "tables.md", "example.py", "X.h", "X.cxx", "TestX.cxx", "TestX.py", "vtkAvianLidarX.h", "X.xml"}


def anchors(text):
    """Anchors of the headings of a page, as web pages of repositories make them."""
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, re.M)}


class Documentation(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for page in PAGES:
            text = page.read_text("utf-8")
            for link in re.findall(r"\]\(([^)]+)\)", text):
                if "://" in link:
                    continue
                with self.subTest(page=page.name, link=link):
                    name, _, anchor = link.partition("#")
                    target = page.parent / name if name else page
                    self.assertTrue(target.is_file(), "a link leads to a file, not to a folder")
                    if anchor:
                        self.assertIn(anchor, anchors(target.read_text("utf-8")))

    def test_index_names_every_page(self):
        folder = SOURCE / "Documentation"
        index = (folder / "README.md").read_text("utf-8")
        for page in folder.rglob("*.md"):
            self.assertTrue(page == folder / "README.md" or f"({page.relative_to(folder)}" in index, page.name)

    def test_named_files_exist(self):
        found = 0
        for page in PAGES:
            text = re.sub(r"```.*?```", "", page.read_text("utf-8"), flags=re.S)
            for name in re.findall(r"`(?:[^`\n]*[/ ])?(\w[\w.\-]*\.(?:h|cxx|py|sh|md|cmake))`", text):
                if name not in NOT_OURS:
                    found += 1
                    self.assertIn(name, NAMES, page.name)
        self.assertGreater(found, 100)

    def test_hours_of_fuzzing_are_the_sums_of_the_runs(self):
        for name, table in reliability_tables.fuzzing():
            self.assertEqual(page_tables.cells_of(table), page_tables.rows(name))


class Presets(unittest.TestCase):
    """One table has the errors and times of the presets of the echo filter. Helps and pages quote it."""

    @classmethod
    def setUpClass(cls):
        head, *rows = page_tables.rows("presets")
        cls.cells = {row[0]: dict(zip((name.strip("`") for name in head[1:]), row[1:])) for row in rows}
        cls.text = {file: " ".join((SOURCE / file).read_text("utf-8").replace("///", " ").replace("%%", "%").split())
                    for file in ("Filters/vtkAvianLidarScanFilter.h", "Plugin/Filters/AvianLidarEchoFilter.xml",
                                 "Python/avianlidar/_command.py", "Documentation/guide/accuracy.md")}

    def test_helps_quote_the_table(self):
        for preset in ("Preview", "Draft", "Standard", "Reference", "Paper"):
            quoted = "; ".join(self.cells[place][preset].rpartition(",")[0]
                               for place in ("airport, Airport16", "Hongqiao with masts and jetways, Airport16"))
            for file, text in self.text.items():
                if not file.endswith(".md"):
                    self.assertTrue(quoted in text, (preset, file, quoted))

    def test_the_guide_has_the_spans_of_the_table(self):
        page = self.text["Documentation/guide/accuracy.md"]
        for preset in ("Preview", "Draft", "default", "Standard", "Reference", "Paper"):
            name = "default (`Custom`)" if preset == "default" else f"`{preset}`"
            # | name | rays | connections | 3 to 12 % | 0 to 0.9 % | 0.05 s |
            spans = re.search(re.escape(f"| {name} |") + r"[^|]*\|[^|]*\|([^|]*)\|([^|]*)\|([^|]*)\|", page).groups()
            outdoors = [[float(part.split()[0].lstrip("≤")) for part in cells[preset].split(", ")]
                        for place, cells in self.cells.items() if not place.startswith("corridor")]
            for span, part in ((spans[0], 0), (spans[1], 2)):
                for said, true in zip(re.findall(r"[\d.]+", span),
                                      (min(c[part] for c in outdoors), max(c[part] for c in outdoors))):
                    digits = len(said.partition(".")[2])
                    self.assertLessEqual(abs(float(said) - true), 0.5001 * 10**-digits, (preset, span, true))
            self.assertEqual(spans[2].strip(), self.cells["airport, Airport16"][preset].split(", ")[1], preset)


class Paper(unittest.TestCase):
    """The page of the paper's claims has a row for every equation, figure, table and algorithm, verdicts and numbers
    that agree with the tables, and names tests that exist."""

    @classmethod
    def setUpClass(cls):
        cls.text = verdicts.PAGE.read_text("utf-8")
        cls.rows = verdicts.rows_of(cls.text)
        cls.kernel = "".join(file.read_text("utf-8") for file in (SOURCE / "Testing").rglob("Test*.cxx"))

    def test_rows_are_numbered_and_short(self):
        self.assertEqual([row[0] for row in self.rows], [str(number + 1) for number in range(len(self.rows))])
        for number, _, verdict, finding, _ in self.rows:
            self.assertIn(verdict, verdicts.VERDICTS, number)
            self.assertLessEqual(len(finding.split()), 40, number)

    def test_every_part_of_the_paper_has_a_row(self):
        places = " ".join(row[1].partition(":")[0] for row in self.rows)
        for kind, last in (("Eq.", 20), ("Fig.", 17), ("Table", 2), ("Algorithm", 2)):
            for number in range(1, last + 1):
                self.assertRegex(places, rf"{kind} {number}\b")

    def test_counts_verdicts_and_numbers_are_those_of_the_tables(self):
        self.assertEqual(verdicts.differences(self.text), [])
        for word, number in verdicts.counts(self.text).items():
            self.assertIn(f"| {word} | {number} |", self.text)

    def test_what_shows_a_row_is_there(self):
        for number, *_, shown in self.rows:
            names = re.findall(r"`([^`]+)`", shown)
            self.assertTrue(names or "](" in shown, number)
            for name in names:
                self.assertTrue(self.is_there(*name.split(".")), (number, name))

    def is_there(self, suite, case):
        """`TestX.test_y` of Python or `Suite.Case` of C++."""
        file = next((SOURCE / "Testing").rglob(f"{suite}.py"), None)
        return f"def {case}(" in file.read_text("utf-8") if file else \
            re.search(rf"^(TYPED_)?TEST(_F|_P)?\({suite}, {case}\)", self.kernel, re.M) is not None
