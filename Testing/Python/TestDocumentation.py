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
sys.path.insert(0, str(SOURCE / "Testing"))
import reliability_tables  # noqa: E402
import verdicts  # noqa: E402

FOLDERS = ("CMake", "Documentation", "Examples", "Filters", "IO", "Plugin", "Python", "Testing")
NAMES = {file.name for folder in FOLDERS for file in (SOURCE / folder).rglob("*")} | {
    file.name for file in SOURCE.iterdir()}
PAGES = [*SOURCE.glob("*.md"), *(page for folder in FOLDERS for page in (SOURCE / folder).rglob("*.md"))]
# What examples and tools leave, and what stands for any name.
NOT_OURS = {"table.md", "tables.md", "example.py", "X.h", "X.cxx", "TestX.cxx", "TestX.py", "vtkAvianLidarX.h", "X.xml"}


def anchors(text):
    """Of the headings of a page, as web pages of repositories make them."""
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, re.M)}


class Documentation(unittest.TestCase):
    def test_links_lead_somewhere(self):
        for page in PAGES:
            text = page.read_text(encoding="utf-8")
            for link in re.findall(r"\]\(([^)]+)\)", text):
                if "://" in link:
                    continue
                with self.subTest(page=page.name, link=link):
                    name, _, anchor = link.partition("#")
                    target = page.parent / name if name else page
                    self.assertTrue(target.is_file(), "a link leads to a file, not to a folder")
                    if anchor:
                        self.assertIn(anchor, anchors(target.read_text(encoding="utf-8")))

    def test_index_names_every_page(self):
        folder = SOURCE / "Documentation"
        index = (folder / "README.md").read_text(encoding="utf-8")
        for page in folder.rglob("*.md"):
            self.assertTrue(page == folder / "README.md" or f"({page.relative_to(folder)}" in index, page.name)

    def test_named_files_exist(self):
        found = 0
        for page in PAGES:
            text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
            for name in re.findall(r"`(?:[^`\n]*[/ ])?(\w[\w.\-]*\.(?:h|cxx|py|sh|md|cmake))`", text):
                if name not in NOT_OURS:
                    found += 1
                    self.assertIn(name, NAMES, page.name)
        self.assertGreater(found, 100)

    def test_tests_that_a_page_names_exist(self):
        files = {file.stem for file in (SOURCE / "Testing").rglob("Test*")}
        named = set(re.findall(r"\bTest[A-Z]\w+", (SOURCE / "Documentation" / "tests.md").read_text(encoding="utf-8")))
        self.assertGreater(len(named), 80)
        self.assertEqual(sorted(named - files), [])

    def test_hours_of_fuzzing_are_the_sums_of_the_runs(self):
        for _, table in reliability_tables.fuzzing():
            self.assertIn(table, reliability_tables.PAGE.read_text(encoding="utf-8"))


class Paper(unittest.TestCase):
    """The page on the paper has a row with a verdict for every equation, figure, table and algorithm, and names tests
    that are there."""

    @classmethod
    def setUpClass(cls):
        cls.text = (SOURCE / "Documentation" / "paper.md").read_text(encoding="utf-8")
        cls.figures = verdicts.FIGURES.read_text(encoding="utf-8")
        cls.rows = verdicts.rows_of(cls.text)
        cls.kernel = "".join(file.read_text(encoding="utf-8") for file in (SOURCE / "Testing" / "Kernel").glob("*.*"))

    def test_counts_and_verdicts_are_those_of_the_measurements(self):
        self.assertEqual(sum(verdicts.counts(self.text).values()) // 2, len(self.rows))
        self.assertEqual(verdicts.with_counts(self.text), self.text)
        self.assertEqual(verdicts.differences(self.text, self.figures), [])
        self.assertEqual({verdicts.word_of(row[4]) for row in self.rows}, set(verdicts.VERDICTS))

    def test_what_shows_a_row_is_there(self):
        for row in self.rows:
            names = re.findall(r"`([^`]+)`", row[3])
            self.assertTrue(names or row[3] == "nothing to run", row[0])
            for name in names:
                with self.subTest(row=row[0], name=name):
                    self.assertTrue(self.is_there(name))

    def is_there(self, name):
        """A file, `Kind-TestX` with or without a method, or `Suite.Case` of the kernel."""
        kind, _, test = name.partition("-")
        test, _, method = test.partition(": ")
        if "/" in name:
            return (SOURCE / name).is_file()
        if test:
            file = SOURCE / "Testing" / kind / f"{test}.py"
            there = file.is_file() and (not method or f"def {method}(" in file.read_text(encoding="utf-8"))
            return there or test == "InstructionSets" or f"{test}.cxx" in NAMES
        suite, case = name.split(".")
        case = "" if case == "*" else rf"{case}\)"
        return re.search(rf"^(TYPED_)?TEST(_F|_P)?\({suite}, {case}", self.kernel, re.M) is not None


if __name__ == "__main__":
    unittest.main()
