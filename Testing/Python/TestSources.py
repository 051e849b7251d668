# SPDX-License-Identifier: BSD-3-Clause
"""Every source names its licence, the lists of files in CMake are complete, modules of the kernel and of Python depend
in one direction, and whoever writes VTK's XML files chooses a data mode that every libexpat reads back."""

import ast
import graphlib
import importlib.util
import os
import re

from avianlidar import _suffixes, apps

source = os.environ["AVIANLIDAR_SOURCE_DIR"]


def read(*path):
    with open(os.path.join(source, *path), encoding="utf-8") as file:
        return file.read()


def files(folder, *endings):
    for path, folders, names in os.walk(os.path.join(source, folder)):
        folders[:] = [name for name in folders if name != "__pycache__"]
        for name in names:
            if name.endswith(endings):
                yield os.path.relpath(os.path.join(path, name), source)


# The licence.
FORMATS = (".h", ".cxx", ".py", ".py.in", ".sh", ".cmake", "CMakeLists.txt", ".jinja", ".xml", ".js")
for folder in ("CMake", "Documentation", "Examples", "Filters", "IO", "Plugin", "Python", "Testing"):
    for path in (*files(folder, *FORMATS), *(["Python/avianlidar.in"] if folder == "Python" else [])):
        assert "SPDX-License-Identifier: BSD-3-Clause" in read(path)[:200], f"{path}: no SPDX line"

# Nothing is left out of a build: a test or a source that no list names would never be seen again.
lists = {
    "Filters/Kernel": ("Filters/Kernel/CMakeLists.txt", ".cxx"),
    "IO/MeshReader": ("IO/MeshReader/CMakeLists.txt", ".cxx"),
    "Filters/VolumeTree": ("Filters/VolumeTree/CMakeLists.txt", ".cxx"),
    "Testing/Kernel": ("Testing/Kernel/CMakeLists.txt", ".cxx"),
    "Testing/Cxx": ("Testing/Cxx/CMakeLists.txt", ".cxx"),
    "Testing/Plugin": ("Testing/Plugin/CMakeLists.txt", ".py"),
}
for folder, (cmake, ending) in lists.items():
    words = set(re.findall(r"[\w./-]+", read(cmake)))
    for path in files(folder, ending):
        name = os.path.relpath(path, folder)
        if ending == ".py" and not name.startswith("Test"):
            continue  # what tests import
        assert name in words, f"{path} is not listed in {cmake}"

words = set(re.findall(r"[\w./-]+", read("CMake/AvianLidarSources.cmake") + read("Plugin/CMakeLists.txt")))
for folder in ("Filters", "IO"):
    for path in files(folder, ".cxx"):
        if not path.startswith(("Filters/Kernel/", "Filters/VolumeTree/", "IO/MeshReader/")):
            assert path in words or path[: -len(".cxx")] in words, f"{path} is not listed"
for path in files("Plugin", ".xml"):
    name = os.path.relpath(path, "Plugin")
    assert name in words or name[: -len(".xml")].replace("/", "/vtk") in words, f"{path} is of no class"

# VTK's copy of the JSON library and Debian's have the same include guards: one header decides which is included.
for folder in ("Filters", "IO", "Plugin"):
    for path in files(folder, ".h", ".cxx"):
        includes = re.search(r"#include.*(nlohmann|NLOHMANN)", read(path))
        assert not includes or path == "Filters/Private/Files/Json.h", f"{path}: include Json.h"

# Folders depend in one direction: each on those before it in CMake's list.
def names_in(text):
    """The names of the files that a source includes."""
    return [os.path.basename(name) for name in re.findall(r'#include "([\w./-]+)"', text)]


def check_folders(root, listed, cmake, above=()):
    """@param above folders that use all folders of the list"""
    folders = re.search(rf"set\({listed}\s+([\w\s/]+)\)", read(cmake))[1].split() + [*above]
    paths = list(files(root, ".h", ".cxx"))
    home = {os.path.basename(path): os.path.relpath(os.path.dirname(path), root) for path in paths}
    assert len(home) == len(paths), f"two files of {root} have one name"
    assert set(home.values()) == set(folders), set(home.values()) ^ set(folders)
    for path in paths:
        own = home[os.path.basename(path)]
        for name in names_in(read(path)):
            above = folders.index(home.get(name, own)) <= folders.index(own)
            assert above, f"{path} includes {name} of {home[name]}, which comes after it"

check_folders("Filters/Kernel", "kernel_folders", "Filters/Kernel/CMakeLists.txt")
check_folders("Filters/Private", "private_folders", "CMake/AvianLidarPrivateFolders.cmake")
check_folders("IO", "io_folders", "CMake/AvianLidarPrivateFolders.cmake", ["MeshReader", "."])

# The kernel does not know the library beside it; IO uses Filters, never the reverse.
for folder, headers in (("Filters/Kernel", files("Filters/VolumeTree", ".h")), ("Filters", files("IO", ".h"))):
    forbidden = {os.path.basename(path) for path in headers}
    assert forbidden, folder
    for path in files(folder, ".h", ".cxx"):
        used = forbidden.intersection(names_in(read(path)))
        assert not used, f"{path} includes {used}"

# The Python package's modules import each other in no circle, also where functions import.
modules = {re.sub(r"(\.__init__)?\.py(\.in)?$", "", os.path.relpath(path, "Python").replace("/", ".")): path
           for path in files("Python/avianlidar", ".py", ".py.in")}


def imports_of(text, package):
    """Names of the modules that a text imports anywhere. @param package that the text is in"""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            home = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
            for name in node.names:
                inner = f"{home}.{name.name}"
                yield inner if inner in modules or name.name == "vtkAvianLidar" else home


imports = {module: set(imports_of(read(path), os.path.dirname(path)[len("Python/"):].replace("/", ".")))
           for module, path in modules.items()}
assert "avianlidar._cloud" in imports["avianlidar._scan"] and "avianlidar" in imports["avianlidar._verbs"], imports
tuple(graphlib.TopologicalSorter(imports).static_order())  # CycleError names the circle

# What stands on top of scans is imported by public names and the command only.
APPS, PUBLIC = "avianlidar.apps", {"avianlidar", "avianlidar._verbs", "avianlidar.reach", "avianlidar.siting"}
for module in imports.keys() - PUBLIC:
    above = {name for name in imports[module] if name.startswith(APPS)}
    assert module.startswith(APPS) or not above, f"{module} imports {above}, which stand on top of it"

# Packages of applications import only packages before them in their list, which names all of them.
found = {package.split(".")[2] for package in modules if package.count(".") > 2}
assert found == set(apps.PACKAGES), found ^ set(apps.PACKAGES)
for module in (module for module in modules if module.count(".") > 2):
    used = {name.split(".")[2] for name in imports[module] if name.startswith(f"{APPS}.")}
    above = used - set(apps.PACKAGES[:apps.PACKAGES.index(module.split(".")[2]) + 1])
    assert not above, f"{module} imports {above}, which come after it in apps.PACKAGES"

# The tests that a header of the kernel names are there.
tests = {os.path.basename(path) for path in files("Testing", ".cxx", ".py", ".h")}
for path in (*files("Filters/Kernel", ".h"), *files("Filters/VolumeTree", ".h")):
    held = re.findall(r"\w+\.(?:cxx|py|h)\b", re.search(r" \* Test: (.*?)\*/", read(path), re.DOTALL)[1])
    assert held and tests.issuperset(held), f"{path} names {set(held) - tests}, which are not there"

# VTK 9.1 and 9.2 do not read the default, Appended, back with today's libexpat: whoever leaves XML files chooses Binary
# or Ascii, within a few lines of the writer, or in the call of ParaView's Save Data.
XML_WRITER = re.compile(r"\bvtkXML\w*Writer\b")
PARAVIEW = re.compile(r"\b(?:SaveData|CreateWriter|XML\w*Writer)\((?:[^()]|\([^()]*\))*\)")
OURS = re.compile(rf"(?:{'|'.join(map(re.escape, (*_suffixes.WRITERS, '.csv')))})\"")
MODE = re.compile(r"(?:SetDataModeTo|DataMode\b\W{1,4})(?:Ascii|Binary|\{mode\})")


def without_a_mode(text):
    """The writers of VTK's XML files in a text that leave the data mode as it is."""
    lines = [line for line in text.splitlines() if not re.match(r"\s*(?:#include|from|import)\b", line)]
    found = [line.strip() for number, line in enumerate(lines) if XML_WRITER.search(line)
             and not MODE.search(" ".join(lines[number:number + 10]))]
    if re.search(r"[.\"'`]p?vt[a-z]\b", text):
        found += [call[0] for call in PARAVIEW.finditer(text) if not OURS.search(call[0])
                  and not MODE.search(call[0] if "**" not in call[0] else text)]
    return found


assert without_a_mode("vtkNew<vtkXMLPolyDataWriter> "
                      "writer;\nwriter->Write();") and without_a_mode('SaveData("a.vtp", proxy=f(1))')
writers = 0
folders = ("Documentation", "Examples", "Filters", "IO", "Plugin", "Python", "Testing")
for path in ["README.md", *(path for folder in folders
                            for path in files(folder, ".cxx", ".h", ".py", ".py.in", ".sh", ".md", ".html", ".ipynb"))]:
    if path.endswith("TestSources.py"):
        continue
    text = read(path)
    writers += len(XML_WRITER.findall(text))
    assert not without_a_mode(text), f"{path}: VTK's XML without DataMode Binary or Ascii: {without_a_mode(text)}"
assert writers > 15, writers
