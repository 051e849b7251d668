# SPDX-License-Identifier: BSD-3-Clause
"""Tables of files and of what must be said of them. A process with limits opens each file, as files may crash
libraries, never end or take all memory. An error must hold in all ways: of the reader, of the reader with errors as
data, of the filter behind it, and of the Python package; then the same reader reads a good file."""
import functools
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import unittest

import avianlidar
import helpertools
import scenetools as st
from avianlidar import _suffixes
from echotools import InFolder, Messages, given
from faulttools import error_of, make, outputs, size_of

ADDRESSES = 4 << 30  # bytes, of the process that reads
MESH_GIGABYTES = "0.5"
STACK = 8 << 20
SECONDS = 240  # for all files of one process; then the file that is being read counts as one that never ends
GOOD = {"good.lidarscene.json": json.dumps({"version": 1, "objects": [{"file": "good.obj", "material": "Wall"}]}),
        "good.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
        "good.pcd": "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n"
                    "1 2 3\n"}


@functools.cache
def good_folder():
    """A folder with the good files, for as long as this process lives."""
    folder = tempfile.TemporaryDirectory()
    for name, text in GOOD.items():
        pathlib.Path(folder.name, name).write_text(text, encoding="utf-8")
    return folder


def words_of(message):
    """Without the place in the code and addresses."""
    return re.sub("0x[0-9a-f]+", "0x", re.sub(r"\AERROR: .*\n.* \(0x[0-9a-f]+\): ", "", message).strip())


# Readers by the ending of their files: the filter behind, how the package reads such a file, and a good file. A later
# reader is a row.
READERS = {".json": ("SceneReader", "CollisionTree", avianlidar.Scene, "good.lidarscene.json"),
           ".txt": ("SequenceReader", "UnitNames", None, None),
           **dict.fromkeys(_suffixes.READERS, ("PointCloudReader", "UnitNames", avianlidar.load_cloud, "good.pcd"))}
OTHERS = "PointCloudReader", "UnitNames", None, "good.pcd"


def said_of(item):
    """Errors, the size of the output without them, and what does not hold beside. @param item a file that is read, or a
    command"""
    if isinstance(item, list):
        status, _, error = helpertools.run(*item)
        return error.splitlines(), int(status != 2), []
    name, behind, load, good = READERS.get(os.path.splitext(item)[1].lower(), OTHERS)
    reader, behind = make(name), make(behind)
    behind.SetInputConnection(reader.GetOutputPort())
    heard = Messages(reader)
    can = reader.CanReadFile(item) if name == "PointCloudReader" else 0
    given(reader, FileName=item).Update()
    errors, data = list(heard.errors), outputs(reader)[0]
    size = data.GetNumberOfElements(0 if data.IsA("vtkPolyData") else 1) + can
    return errors, size, list(broken_ways(item, reader, behind, heard, load, good)) if errors else []


def broken_ways(item, reader, behind, heard, load, good):
    """The ways in which an error of the reader does not hold."""
    for data in outputs(reader):
        arrays = data.GetPointData().GetNumberOfArrays() if data.IsA("vtkPolyData") else 0
        if size_of(data) or arrays or not error_of(data) or error_of(data) not in heard.errors[0]:
            yield f"its output: {size_of(data)}, {arrays}, {error_of(data)}"
    for algorithm in (reader, behind):
        algorithm.SetErrorsAsData(True)
    later = Messages(behind)
    behind.Update()
    texts = [words_of(text) for text in heard.errors]
    fields = {words_of(error_of(data)) for data in outputs(reader)}
    if len(texts) != 2 or fields != {*texts[1:]} or any(map(size_of, outputs(behind))):
        yield f"as data: {texts}, {fields}"
    if [words_of(text).partition("its producer failed: ")[2] for text in later.errors] != texts[1:]:
        yield f"behind it: {later.errors}"
    try:
        if load:
            load(item)
            yield "the package takes it"
    except FileNotFoundError:
        yield from ["the package finds no file"] if os.path.exists(item) else []
    except Exception as error:  # noqa: B902
        yield from [] if texts[0] in words_of(str(error)) else [f"the package: {error}"]
    if good:
        del heard.errors[:], later.errors[:]
        reader.SetFileName(os.path.join(good_folder().name, good))
        behind.Update()
        if heard.errors or later.errors or not size_of(outputs(behind)[0]):
            yield f"the next good file: {heard.errors} {later.errors}"


class Table(unittest.TestCase):
    def read(self, items):
        """What was said of each, by processes with limits; nothing of one that ended its process or was waited for."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
            resource.setrlimit(resource.RLIMIT_STACK, (STACK, STACK))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        said = []
        while len(said) < len(items):
            try:
                text = subprocess.run([sys.executable, os.path.abspath(__file__)], preexec_fn=limit, text=True,
                                      errors="replace", check=False,
                                      input="".join(json.dumps(item) + "\n" for item in items[len(said):]),
                                      stdout=subprocess.PIPE,
                                      env={**os.environ, "AVIANLIDAR_MESH_GIGABYTES": MESH_GIGABYTES},
                                      stderr=subprocess.DEVNULL, timeout=SECONDS).stdout
            except subprocess.TimeoutExpired as late:
                text = (late.stdout or b"").decode()
            said += [json.loads(line) for line in text.splitlines() if line.startswith("[")]
            said += [None] if len(said) < len(items) else []
        return said

    def assert_said(self, table):
        """@param table rows of a file and the words of the one error, which names the file, or of a command (a list)
        and their pattern; None: any error, or one triangle; True: it is sound"""
        for (item, words), answer in zip(table, self.read([item for item, _ in table])):
            with self.subTest(item if isinstance(item, list) else os.path.basename(item), words=words):
                self.assertIsNotNone(answer, "it ended the process, or it is waited for")
                errors, count, wrong = answer
                if words is True or (words is None and count):
                    self.assertEqual(errors, [])
                    self.assertTrue(count == 1 or words)
                    self.assertGreater(count, 0)
                    continue
                self.assertEqual((len(errors), count, wrong), (1, 0, []), errors)
                self.assertNotRegex(words_of(errors[0]), r"\n|ERROR:|\.cpp|\.cxx")
                if isinstance(item, list):
                    self.assertRegex(errors[0], words)
                else:
                    self.assertIn(words or "", errors[0])
                    self.assertIn(item, errors[0])


class Files(InFolder, Table):
    def setUp(self):
        super().setUp()
        self.scenes = 0

    def save(self, name, content):
        (self.folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
        return str(self.folder / name)

    def scene(self, *objects):
        """A scene file of objects."""
        self.scenes += 1
        return st.write_scene(str(self.folder), f"scene{self.scenes}", {
            "version": 1, "origin": {"latitude": 0, "longitude": 0, "height": 0}, "material_map": {"*": "Wall"},
            "objects": list(objects)})


if __name__ == "__main__":
    out = os.dup(1)
    os.dup2(2, 1)  # libraries write what they like
    with open(out, "w", encoding="utf-8") as answers:
        for line in sys.stdin:
            print(json.dumps(said_of(json.loads(line))), file=answers, flush=True)
