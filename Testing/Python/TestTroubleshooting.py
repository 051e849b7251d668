# SPDX-License-Identifier: BSD-3-Clause
"""Documentation/troubleshooting.md has an entry for every error, warning and note that the sources can say.

A message is what one statement of the sources is made of: its texts, with `…` for each value between them. An entry is
words in code in the first column of a table of the page, with `…` for anything. It covers each message that holds these
words in their order."""
import ast
import os
import pathlib
import re
import unittest

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
PAGE = SOURCE / "Documentation" / "troubleshooting.md"
ANY = "…"
# Of a property or an array: what it is, and what was expected. The one entry that may cover any number of messages.
VALUE = f"{ANY} is {ANY} , expected {ANY}"
MOST = 16  # messages that another entry may cover: above, it says too little
# Texts that no user is shown as an error: assertions, units with words, texts in files that are written.
NOT_SHOWN = ("vtkAvianLidarMaterial.cxx: … Material: ", "Unable to allocate", "Echoes of a lidar; heights", "Wavelength",
             "LasWriting.cxx: ", "vtkAvianLidarAdviceNotes.cxx: ", "vtkAvianLidarCoverageOutput.cxx: ", "# .PCD v0.7", "USGS Spectral Library", "property list uchar", "no triangle is bad", "species,mass [kg]")
TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|\w+|[^\s\w]', re.S)
WHERE = set("and another array arrays beams block cell cells cloud collision columns comparison data echoes field image input is line "
            "movers of or places point points port rows scan surfaces the tree whole".split())


def prose(text):
    """Whether a text may be a message: three words or more, of which two in a row, that do not only say where."""
    words = re.findall(r"[a-z]{2,}", text.lower())
    return re.search(r"[A-Za-z]{2,}'?,? +[a-z]{2,}", text) and len(words) > 2 and not WHERE.issuperset(words)


def plain(text):
    """Without quotation marks, escapes and needless blanks."""
    text = re.sub(r"\\n|\\?[\"']|[`{}]", "", text)
    return re.sub(rf"(?:\s*{ANY}\s*)+", f" {ANY} ", text.replace("\n", " ")).strip(" .:,;")


def cxx_messages(file):
    """Of the statements of a file in C++. A bare name followed by texts is valueError()'s: name is value, expected text."""
    texts, previous, checked = [], "", False
    for token in TOKEN.findall(re.sub(r"(?m)^\s*#.*$", "", file.read_text(encoding="utf-8"))) + [";"]:
        if token.startswith(("//", "/*")):
            continue
        if token in (";", "{", "}"):
            if not checked and prose(ANY.join(texts)):
                named = re.fullmatch(r"\w+", texts[0]) and len(texts) > 1 and "expected" not in " ".join(texts)
                yield VALUE if named else plain(ANY.join(["", *texts, ""]))
            texts, checked = [], False
        elif token.startswith('"'):
            if previous.startswith('"'):
                texts[-1] += token[1:-1]
            else:
                texts.append(token[1:-1])
        checked |= token == "static_assert"
        previous = token


def python_text(node):
    """The texts in an expression, and the functions that it calls to make one."""
    if isinstance(node, ast.JoinedStr):
        return "".join(part.value if isinstance(part, ast.Constant) else ANY for part in node.values), set()
    if isinstance(node, ast.Constant):
        return (node.value, set()) if isinstance(node.value, str) else ("", set())
    found = [python_text(child) for child in ast.iter_child_nodes(node)]
    called = {node.func.id} if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) else set()
    return ANY.join(text for text, _ in found if text), called.union(*(names for _, names in found))


def says(node):
    """What is shown: the value of a raise or a yield, the arguments of a warning, an end or a line of standard error."""
    if isinstance(node, (ast.Raise, ast.Yield)):
        return node.exc if isinstance(node, ast.Raise) else node.value
    if isinstance(node, ast.Call):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if name in ("warn", "exit", "error", "say") or (name == "print" and any(word.arg == "file" for word in node.keywords)):
            return ast.Tuple(node.args)
    return None


def python_messages(file):
    tree = ast.parse(file.read_text(encoding="utf-8"))
    makers = set()
    for node in ast.walk(tree):
        what = says(node)
        if what is not None:
            text, called = python_text(what)
            makers |= called
            if prose(text):
                yield plain(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef) and node.name in makers:
            for one in ast.walk(node):
                if isinstance(one, (ast.Return, ast.Assign, ast.AugAssign)) and one.value and prose(python_text(one.value)[0]):
                    yield plain(python_text(one.value)[0])


def shell_messages(file):
    for text in re.findall(r'echo "([^"]*)" >&2', file.read_text(encoding="utf-8")):
        yield plain(re.sub(r"\$\{?\w+\}?", ANY, text))


def messages():
    """{message: file}"""
    found = {}
    for folders, endings, read in ((("Filters", "IO"), (".h", ".cxx"), cxx_messages),
                                   (("Python", "Plugin/Macros", "Plugin/States", "Examples/common"), (".py",), python_messages),
                                   (("CMake", "Examples"), (".sh",), shell_messages)):
        for folder in folders:
            for file in sorted((SOURCE / folder).rglob("*")):
                if file.suffix in endings:
                    found.update({one: file.name for one in read(file)
                                  if not any(part in f"{file.name}: {one}" for part in NOT_SHOWN)})
    return found


def entries(text):
    """The words in code of the first columns of the tables of messages or notes."""
    tables = re.findall(r"^\| (?:message|words) \|.*\n\|[-|]+\|\n((?:\|.*\n)*)", text, re.M)
    return [plain(words) for row in "".join(tables).splitlines() for words in re.findall(r"`([^`]+)`", row.split(" | ")[0])]


def covers(entry):
    """A function that finds the words of an entry, whole ones, in a message."""
    parts = [part.strip() for part in entry.split(ANY) if part.strip()]
    return re.compile(".*?".join(rf"(?<!\w){re.escape(part)}(?!\w)" for part in parts)).search


class Troubleshooting(unittest.TestCase):
    maxDiff = None
    @classmethod
    def setUpClass(cls):
        cls.page = PAGE.read_text(encoding="utf-8")
        ours, cls.others = cls.page.split("\n## Messages of other programs\n")
        cls.entries = entries(ours)
        cls.messages = messages()

    def test_what_is_found_in_the_sources(self):
        """One of each kind, as the sources have it."""
        self.assertGreater(len(self.messages), 400)
        for file, part in (("Bird.cxx", "passerine is … , expected yes or no"),
                           ("vtkAvianLidarMaterial.cxx", "fits no block: no material was set"),
                           ("_cloud.py", "a cloud is made of a vtkPointSet, not of …"),
                           ("_writers.py", "by its suffix; known are"), ("_sight.py", "if its file is in millimetres"),
                           ("_sight.py", "no echoes of … beams"),
                           ("run.sh", "There is no display to open ParaView on")):
            self.assertTrue(any(name == file and part in one for one, name in self.messages.items()), (file, part))
        self.assertIn(VALUE, self.messages)

    def test_every_message_has_an_entry(self):
        found = [covers(entry) for entry in self.entries]
        missing = [f"{file}: {one}" for one, file in self.messages.items() if not any(search(one) for search in found)]
        self.assertEqual(missing, [], f"{len(missing)} messages without an entry in {PAGE.name}: add a row to its tables "
                                      "whose first column has the message's words in code, with … for what varies")

    def test_every_entry_has_a_message(self):
        for entry in self.entries:
            with self.subTest(entry=entry):
                self.assertGreater(len(re.findall(r"\w{2,}", entry)), 1, "one word says too little")
                count = sum(bool(covers(entry)(one)) for one in self.messages)
                self.assertGreater(count, 0, "no source says this")
                if entry != VALUE:
                    self.assertLessEqual(count, MOST, "these words fit too much")

    def test_a_new_message_is_missed(self):
        new = "the wings of … are asleep, expected them awake"
        self.assertFalse(any(covers(entry)(new) for entry in self.entries))

    def test_no_cell_is_empty(self):
        for row in re.findall(r"^\|(.*)\|$", self.page, re.M):
            self.assertTrue(all(cell.strip() for cell in row.split("|")), row)


if __name__ == "__main__":
    unittest.main()
