# SPDX-License-Identifier: BSD-3-Clause
"""The pages say what is there: links and the files that they name exist, the page on the architecture names every file
of the kernel, and the README has the numbers of the page that it sums up."""
import os
import pathlib
import re
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
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
                    self.assertTrue(target.exists())
                    if anchor:
                        self.assertIn(anchor, anchors(target.read_text(encoding="utf-8")))

    def test_no_line_of_prose_begins_like_a_list_or_a_quotation(self):
        for page in PAGES:
            text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
            self.assertEqual(re.findall(r"^ *[+>] .*", text, re.M), [], page.name)

    def test_named_files_exist(self):
        found = 0
        for page in PAGES:
            text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
            for name in re.findall(r"`(?:[^`\n]*[/ ])?(\w[\w.\-]*\.(?:h|cxx|py|sh|md|cmake))`", text):
                if name not in NOT_OURS:
                    found += 1
                    self.assertIn(name, NAMES, page.name)
        self.assertGreater(found, 100)

    def test_architecture_names_the_folders_of_the_kernel(self):
        text = (SOURCE / "Documentation" / "architecture.md").read_text(encoding="utf-8")
        named = re.findall(r"^\| `(\w+)/` \|", part(text, "## The seven folders of the kernel", "\n## "), re.M)
        lists = (SOURCE / "Filters" / "Kernel" / "CMakeLists.txt").read_text(encoding="utf-8")
        folders = re.search(r"set\(kernel_folders\s+([\w\s/]+)\)", lists)[1].split()
        self.assertEqual(named, [folder for folder in folders if "/" not in folder])

    def test_readme_has_the_numbers_of_the_presets(self):
        readme = " ".join((SOURCE / "README.md").read_text(encoding="utf-8").split())
        page = (SOURCE / "Documentation" / "results" / "accuracy.md").read_text(encoding="utf-8")
        number = r"([\d.]+)"
        claimed = re.search(rf"have {number}, {number} and {number} % rms error of energy on the airport's [\d,]+ "
                            rf"beams, in {number}, {number} and {number} s", readme).groups()
        header = (SOURCE / "Filters" / "vtkAvianLidarScanFilter.h").read_text(encoding="utf-8")
        panel = (SOURCE / "Plugin" / "Filters" / "AvianLidarEchoFilter.xml").read_text(encoding="utf-8")
        for i, preset in enumerate(("Draft", "Standard", "Reference")):
            with self.subTest(preset):
                row = re.search(rf"^\| `{preset}` \| (.*)$", page, re.M)[1]
                scenes = re.findall(rf"{number} s, [^;]*; energy (?:≤ )?{number} %", row)
                self.assertEqual(len(scenes), 3)
                self.assertEqual(scenes[0], (claimed[3 + i], claimed[i]))
                self.assertIn(f"PRESET_{preset.upper()}: " + "; ".join(f"{e} %, {t} s" for t, e in scenes), header)
                time, error = scenes[0]
                words = rf"{preset}\s+\([^()]*?{error} percent[^()]*? {time} s"
                self.assertRegex(panel, words)


if __name__ == "__main__":
    unittest.main()
