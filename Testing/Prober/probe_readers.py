# SPDX-License-Identifier: BSD-3-Clause
"""Mutated files of every format to the readers, in child processes with little memory: what comes is a sound result or an
error that names a file; never a signal, a hang, or nothing at all. See README.md."""

import argparse
import os
import random
import re
import shutil
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

import numpy as np  # noqa: E402
from vtk.util.numpy_support import vtk_to_numpy  # noqa: E402

import children  # noqa: E402
import mutations  # noqa: E402
from avianlidar import vtkAvianLidar as al  # noqa: E402
from contents import contents, difference, leaves  # noqa: E402
from echotools import Messages  # noqa: E402
from samples import all_samples  # noqa: E402

BATCH = 40  # files to a child


def mutated(seed, samples):
    """(which sample, mutations) of a seed."""
    r = random.Random(seed)
    return r.randrange(len(samples)), mutations.drawn(r)


def put(files, folder):
    for name, content in files.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(content)


def reader_of(name):
    return al.vtkAvianLidarSceneReader() if name.endswith(".json") else al.vtkAvianLidarPointCloudReader()


def read(reader, file):
    reader.SetFileName(file)
    reader.Modified()
    reader.Update()
    return reader.GetOutput()


def judge(data, heard, names):
    """What is wrong with an outcome, or nothing; and the kind of the outcome."""
    size = sum(leaf.GetNumberOfPoints() for _, _, leaf in leaves(data))
    blocks = 0 if data.IsA("vtkPolyData") else data.GetNumberOfBlocks()
    if heard.errors:
        if heard.errors[0] is None:
            return "an error whose text is not UTF-8", "error"
        if size or blocks:
            return "an error and an output that is not empty", "error"
        if not any(os.path.basename(name) in heard.errors[0] for name in names):
            return f"an error that names no file: {heard.errors[0]}", "error"
        return "", "error"
    for _, _, leaf in leaves(data):
        points = leaf.GetNumberOfPoints()
        for cells in (leaf.GetVerts(), leaf.GetPolys()):
            if cells.GetNumberOfCells():
                ids = vtk_to_numpy(cells.GetConnectivityArray())
                if len(ids) and (ids.min() < 0 or ids.max() >= points):
                    return "a cell with a point that is not there", "result"
        for arrays, count in ((leaf.GetPointData(), points), (leaf.GetCellData(), leaf.GetNumberOfCells())):
            for i in range(arrays.GetNumberOfArrays()):
                if arrays.GetAbstractArray(i).GetNumberOfTuples() != count:
                    return f"array {arrays.GetArrayName(i)} is not one value for each", "result"
        if points and not data.IsA("vtkPolyData") and not np.isfinite(vtk_to_numpy(leaf.GetPoints().GetData())).all():
            return "coordinates that are not finite", "result"
    return "", "result" if size else "warning" if heard.warnings else "nothing"


def says_nothing(name, content):
    """True if a file itself says that it holds nothing."""
    if name.endswith(".bin"):
        return len(content) == 0
    if name.endswith(".pcd"):
        words = content.split()
        counts = [b for a, b in zip(words, words[1:]) if a in (b"POINTS", b"WIDTH", b"HEIGHT")]
        # A cell that is not a number is no point, so a small file may have none.
        return b"0" in counts or b"nan" in content.lower() or b"DATA binary" in content
    if name == "cloud.ply":
        return re.search(rb"vertex +[0+-]", content) is not None or b"nan" in content.lower() or b"format binary" in content
    if name.endswith(".las"):
        return content[107:111] == b"\0\0\0\0"
    return False


def run(tell, cases, samples, folder, memory):
    """Read the files of cases, and after each a good one by the same reader."""
    kinds = {}
    for number, (which, changes) in enumerate(cases):
        tell(number)
        name, opened, files = samples[which]
        put(files, folder)
        file = os.path.join(folder, opened)
        reader = reader_of(opened)
        heard = Messages(reader)
        good = contents(read(reader, file)) if number % 8 == 0 else None
        errors = heard.errors[:]  # LAZ is one where there is no LASzip
        heard.errors.clear()
        heard.warnings.clear()
        content = mutations.applied(files[name], changes)
        put({name: content}, folder)
        data = read(reader, file)
        wrong, kind = judge(data, heard, files)
        if not wrong and kind == "nothing" and not says_nothing(name, content):
            wrong = "no output and not a word"
        if not wrong and good is not None:
            put(files, folder)
            heard.errors.clear()
            wrong = difference(good, contents(read(reader, file)))
            if not wrong and heard.errors != errors:
                wrong = f"errors were {errors}, now they are {heard.errors}"
            wrong = wrong and f"the good file afterwards:\n{wrong}"
        kinds[kind] = kinds.get(kind, 0) + 1
        if wrong:
            return number, wrong, kinds
    return None, "", kinds


def outcome_of(cases, samples, arguments):
    """(number of the first case that fails or None, what is wrong, counts)"""
    last = [0]
    folder = tempfile.mkdtemp(prefix="probe-readers-")
    try:
        outcome = children.run(run, cases, samples, folder, arguments.memory, seconds=arguments.limit,
                               memory=arguments.memory << 20, progress=last.append)
    finally:
        shutil.rmtree(folder)
    if outcome.fault:
        return last[-1], f"{outcome.fault}\n{outcome.output[-2500:]}", {}
    return outcome.value


def shrunk(case, samples, arguments):
    """The mutations that are needed."""
    which, changes = case
    i = 0
    while i < len(changes) and len(changes) > 1:
        fewer = changes[:i] + changes[i + 1 :]
        if outcome_of([(which, fewer)], samples, arguments)[1]:
            changes = fewer
        else:
            i += 1
    return which, changes


def report(seed, case, wrong, samples, arguments):
    which, changes = shrunk(case, samples, arguments)
    name, opened, files = samples[which]
    content = mutations.applied(files[name], changes)
    words = [mutations.MUTATIONS[kind].__name__.strip("_") for kind, _ in changes]
    print(f"\nseed {seed}: {name} of {len(files[name])} bytes after {words}\n{wrong.strip()}")
    if arguments.keep:
        folder = os.path.join(arguments.keep, str(seed))
        os.makedirs(folder, exist_ok=True)
        put({**files, name: content}, folder)
        print(f"kept: {os.path.join(folder, opened)}", flush=True)


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="0-", help="one seed, first-last, or first- (until stopped)")
    parser.add_argument("--memory", type=int, default=3072, help="MiB of address space")
    parser.add_argument("--limit", type=int, default=60, help="seconds of the processor for 40 files, and for one")
    parser.add_argument("--skip", default="", help="seeds to leave out, with commas")
    parser.add_argument("--library-faults", action="store_true", help="formats that libraries are known to die of, too")
    parser.add_argument("--keep", help="folder for the files that fail")
    arguments = parser.parse_args()
    arguments.skip = {int(one) for one in arguments.skip.split(",") if one}
    arguments.first, arguments.last = children.seeds(arguments.seeds)
    return arguments


def main():
    arguments = parse()
    with tempfile.TemporaryDirectory() as folder:
        samples = all_samples(folder, arguments.library_faults)
    failed, total, begin = [], {}, time.monotonic()
    seed = first = arguments.first
    shown = 0
    while seed <= arguments.last:
        end = min(seed + BATCH, arguments.last + 1)
        seeds = [one for one in range(seed, end) if one not in arguments.skip]
        cases = [mutated(one, samples) for one in seeds]
        number, wrong, kinds = outcome_of(cases, samples, arguments)
        for kind, count in kinds.items():
            total[kind] = total.get(kind, 0) + count
        if number is None:
            seed = end
        else:
            alone = outcome_of([cases[number]], samples, arguments)
            if alone[1] or not wrong.startswith("takes more"):
                failed.append(seeds[number])
                report(seeds[number], cases[number], alone[1] or f"only after others: {wrong}", samples, arguments)
            seed = seeds[number] + 1
        if (seed - first) // 2000 > shown:
            shown = (seed - first) // 2000
            print(f"{seed - first} files, {total}, {len(failed)} failed, {time.monotonic() - begin:.0f} s", flush=True)
    print(f"{seed - first} files, {total}, {time.monotonic() - begin:.0f} s; failed: {failed or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
