#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The keys of kept beams cover all members of sensor, settings, needs and setup: with another member, the kernel must
not compile until the keys account for the member. Each structure gets another member in copies of the headers. (A
setting has a row that says what it changes.)"""
import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# Header, struct, and the files that must not compile with a member more.
GUARDED = [("Sensor/Sensor.h", "Sensor", ["Sensor/Sensor.cxx", "Scan/TraceCache.cxx"]),
           ("Setup/EchoSettings.h", "EchoSettings", ["Setup/EchoSettings.cxx"]),
           ("Setup/ScanSetup.h", "ModelNeeds", ["Scan/LitBeam.cxx"]),
           ("Setup/ScanSetup.h", "ScanSetup", ["Scan/LitBeam.cxx"])]


def compiles(entry, folder, text):
    """Whether the compiler of the kernel takes `text` in its place, with the headers of `folder` before others."""
    words = entry.get("arguments") or entry["command"].split()
    first = next(i for i, word in enumerate(words) if re.search(r"(g|clang)\+\+|c\+\+", word))  # ccache comes before it
    last = words.index("-o")
    words = [words[first], f"-I{folder}", *words[first + 1:last], "-fsyntax-only", "-w", "-x", "c++", "-"]
    done = subprocess.run(words, cwd=entry["directory"], input=text, text=True, capture_output=True, check=False)
    return done.returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--source", required=True, type=pathlib.Path)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    kernel = arguments.source / "Filters/Kernel"
    entries = json.loads((arguments.build / "compile_commands.json").read_text())
    entry = next(e for e in entries if "/avianlidarKernel.dir/" in e.get("command", " ".join(e.get("arguments", []))))
    texts = {name: (kernel / name).read_text() for _, _, names in GUARDED for name in names}
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        for header in kernel.rglob("*.h"):  # all together, as a header looks for others beside itself first
            shutil.copy(header, folder)
        wrong += [f"{name} as it is does not compile" for name, text in texts.items()
                  if not compiles(entry, folder, text)]
        for header, struct, names in GUARDED:
            copy, text = pathlib.Path(folder, pathlib.Path(header).name), (kernel / header).read_text()
            changed, count = re.subn(rf"(struct {struct}\n{{\n.*?\n)(}};)", r"\1  double another = 0.0;\n\2", text,
                                     flags=re.DOTALL)
            assert count == 1, (header, struct)
            copy.write_text(changed)
            wrong += [f"{name} knows nothing of a new member of {struct}, and compiles" for name in names
                      if compiles(entry, folder, texts[name])]
            copy.write_text(text)
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
