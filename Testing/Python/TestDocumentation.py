# SPDX-License-Identifier: BSD-3-Clause
"""The pages say what is there: links and the files that they name exist, generated tables are current, and every row
of the page on the paper has a verdict."""
import fcntl
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "Examples" / "paper"))
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


def part(text, begin, end):
    return text.split(begin, 1)[1].split(end, 1)[0]


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

    def test_architecture_names_the_folders_of_the_kernel(self):
        text = (SOURCE / "Documentation" / "architecture.md").read_text(encoding="utf-8")
        named = re.findall(r"^\| `(\w+)/` \|", part(text, "## The folders of the kernel", "\n## "), re.M)
        lists = (SOURCE / "Filters" / "Kernel" / "CMakeLists.txt").read_text(encoding="utf-8")
        folders = re.search(r"set\(kernel_folders\s+([\w\s/]+)\)", lists)[1].split()
        self.assertEqual(named, [folder for folder in folders if "/" not in folder])

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

    def test_every_row_has_a_verdict(self):
        self.assertGreater(len(self.rows), 200)
        for row in self.rows:
            with self.subTest(row=row[0]):
                self.assertEqual(len(row), 5)
                self.assertTrue(all(cell.strip() for cell in row))
                self.assertRegex(row[4], r"^(same(: \S.+)?|(in part|corrected|contradicted|not reproducible): \S.+)$")

    def test_counts_and_verdicts_are_those_of_the_measurements(self):
        self.assertEqual(sum(verdicts.counts(self.text).values()) // 2, len(self.rows))
        self.assertEqual(verdicts.with_counts(self.text), self.text)
        self.assertEqual(verdicts.differences(self.text, self.figures), [])
        self.assertEqual({verdicts.word_of(row[4]) for row in self.rows}, set(verdicts.VERDICTS))

    def test_a_verdict_or_a_number_typed_otherwise_is_found(self):
        row = next(row for row in self.rows if row[0].startswith("Fig. 11: all three"))
        self.assertTrue(row[4].startswith("in part: in 16 of 18 scenes"))
        for typed, word, stale in ((row[4].replace("in part", "same", 1), "in part", []),
                                   (row[4].replace("16 of", "17 of", 1), "in part", ["17 of 18"])):
            found = verdicts.differences(self.text.replace(row[4], typed), self.figures)
            self.assertEqual([(one[0], *rest) for one, *rest in found], [(row[0], word, stale)])
        fewer = "\n".join(line for line in self.text.splitlines() if not line.startswith("| Eq. 1: "))
        self.assertNotEqual(verdicts.with_counts(fewer), fewer)

    def test_one_run_at_a_time_writes_into_a_folder(self):
        with tempfile.TemporaryDirectory() as folder, open(pathlib.Path(folder, "lock"), "w", encoding="utf-8") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            done = subprocess.run([SOURCE / "Examples" / "paper" / "run.sh", "--quick", "--no-build", "--out", folder],
                                  check=False, capture_output=True, text=True)
            self.assertEqual(done.returncode, 2)
            self.assertIn("another run writes into", done.stderr)
            self.assertEqual([file.name for file in pathlib.Path(folder).iterdir()], ["lock"])

    def test_the_one_command_runs_every_script(self):
        text = (SOURCE / "Examples" / "paper" / "run.sh").read_text(encoding="utf-8")
        for script in (SOURCE / "Examples" / "paper").glob("*.py"):
            self.assertIn(script.name, text)

    def test_nothing_that_has_a_number_is_left_out(self):
        for kind, numbers in (("Eq.", range(1, 21)), ("Fig.", range(1, 18)), ("Table", (1, 2)), ("Algorithm", (1, 2)),
                              ("Sec.", (1, 2, 3, 4, 5, 6, 7))):
            for number in numbers:
                place = re.compile(rf"{re.escape(kind)} {number}(?!\d)")
                self.assertTrue(any(place.match(row[0]) for row in self.rows), (kind, number))

    def test_what_shows_a_row_is_there(self):
        for row in self.rows:
            names = re.findall(r"`([^`]+)`", row[3])
            self.assertTrue(names or row[3] == "nothing to run", row[0])
            for name in names:
                with self.subTest(row=row[0], name=name):
                    self.assertTrue(self.is_there(name))

    def is_there(self, name):
        kind, _, test = name.partition("-")
        test, _, method = test.partition(": ")
        if "/" in name:
            return (SOURCE / name).is_file()
        if kind == "Python":
            file = SOURCE / "Testing" / "Python" / f"{test}.py"
            return file.is_file() and (not method or f"def {method}(" in file.read_text(encoding="utf-8"))
        if kind == "Kernel":
            return test == "InstructionSets" or f"{test}.cxx" in NAMES
        if kind == "AvianLidarCxx":
            return (SOURCE / "Testing" / "Cxx" / f"{test}.cxx").is_file()
        if kind == "Parallel":
            return (SOURCE / "Testing" / "Parallel" / f"{test}.py").is_file()
        suite, case = name.split(".")
        case = "" if case == "*" else rf"{case}\)"
        return re.search(rf"^(TYPED_)?TEST(_F|_P)?\({suite}, {case}", self.kernel, re.M) is not None


if __name__ == "__main__":
    unittest.main()
