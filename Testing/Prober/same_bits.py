# SPDX-License-Identifier: BSD-3-Clause
"""Random sequences of changes to a pipeline: after each step what has run before must give, bit by bit, what one that never ran
gives, by another number of threads, on copies of the present data. See README.md."""

import argparse
import os
import random
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

import numpy as np  # noqa: E402
from vtk.util.numpy_support import vtk_to_numpy  # noqa: E402

import children  # noqa: E402
from data import contents, copy_of, difference, is_empty, leaves  # noqa: E402
from pipeline import SINKS  # noqa: E402
from steps import KINDS, WEIGHTS, World, arrays_of, edit_values  # noqa: E402

ECHOES, REPORT = ("echo", 0), ("echo", 1)


class Fault(Exception):
    """The pipeline that has run before is not as a fresh one."""


def sequence(seed, count):
    """The steps of a seed: (kind, its own seed)."""
    r = random.Random(seed)
    return [(kind, r.randrange(2**32)) for kind in r.choices([*KINDS], [WEIGHTS.get(kind, 1) for kind in KINDS], k=count)]


def run(tell, seed, steps):
    """Run steps from the world of a seed; what is wrong in the end, what was done, and counts."""
    world, counts, waiting = World(random.Random(f"world {seed}")), {}, []
    try:
        check(world, random.Random(seed), counts)
        for number, (kind, own) in enumerate(steps):
            tell(f"step {number}, {kind}")
            r = random.Random(own)
            world.say(f"-- {kind}")
            undo = world.before()
            undo.append(KINDS[kind](world, r))
            if world.abort:
                break_off(world, r)
            if check(world, r, counts):
                waiting.append(undo)
            if waiting and r.random() < 0.7:
                world.say("   mended")
                while waiting:
                    [one() for one in reversed(waiting.pop()) if one]
                check(world, r, counts)
        sweep(world, random.Random(seed))
        return "", world.said, counts
    except Fault as fault:
        return str(fault), world.said, counts


def sweep(world, r):
    """Each kind of array once, in all blocks."""
    world.route.material = False
    world.used.connect(world)
    found = [(root, leaf, *pair) for root in world.roots() for _, _, leaf in leaves(root) if leaf.GetNumberOfPoints() for pair in arrays_of(leaf)]
    for name in sorted({array.GetName() or "" for _, _, array, _ in found}):
        world.say(f"-- sweep: {name}")
        for root, leaf, array, holder in found:
            if (array.GetName() or "") == name:
                edit_values(array, r)
                world.modified(r, root, leaf, array, holder)
        compare(ECHOES, world.used.update(ECHOES, world.moment), world.fresh().update(ECHOES, world.moment))


def check(world, r, counts):
    """Look at some outputs, in any order; whether one of them could not be made."""
    sinks = r.sample(SINKS, r.randint(0, 2)) + r.choice(([ECHOES], [REPORT], [ECHOES, REPORT]))
    r.shuffle(sinks)
    fresh, failed = world.fresh(), False
    for sink in sinks:
        held = [contents(copy) for _, copy in world.held]
        found, expected = world.used.update(sink, world.moment), fresh.update(sink, world.moment)
        counts["looks"] = counts.get("looks", 0) + 1
        counts["errors"] = counts.get("errors", 0) + bool(expected.errors)
        compare(sink, found, expected)
        for (name, copy), before in zip(world.held, held):
            if difference(before, contents(copy)):
                raise Fault(f"updating {sink} writes into {name} that somebody holds:\n{difference(before, contents(copy))}")
        if expected.errors:
            failed = True
            fresh = world.fresh()
    if not failed and sinks[-1] == ECHOES and world.moment[1] == 1 and not world.route.table and r.random() < 0.2:
        compare_pieces(expected.found, fresh, world.moment[2])
    return failed


def compare(sink, found, expected):
    if expected.errors:
        if not found.errors and found.executed:
            raise Fault(f"{sink} is made without a word where a fresh pipeline says: {expected.errors}")
        if found.executed and expected.by_sink and found.by_sink != expected.by_sink:
            raise Fault(f"{sink}: {found.errors}, a fresh pipeline: {expected.errors}")
        if expected.by_sink and not (is_empty(expected.found) and is_empty(found.found)):
            raise Fault(f"{sink} is not empty after {expected.errors}")
        return
    if found.errors:
        raise Fault(f"{sink}: {found.errors}, a fresh pipeline says nothing")
    different = difference(found.found, expected.found)
    if different:
        raise Fault(f"{sink}: has run before / fresh\n{different}")


def compare_pieces(whole, pipeline, time):
    """The echoes of all pieces are those of the whole."""
    if rows_of([whole]) != rows_of([pipeline.update(ECHOES, (i, 3, time)).found for i in range(3)]):
        raise Fault("echoes are not the same in pieces")


def rows_of(parts):
    """All bytes of each echo, in an order that follows from them."""
    rows = [np.hstack([np.frombuffer(what[-1], np.uint8).reshape(what[0], -1) for where, what in sorted(part.items())
                       if (where.startswith("/point ") or where == "/points") and isinstance(what[-1], bytes)])
            for part in parts if part["/points"][0]]
    return sorted(map(bytes, np.vstack(rows))) if rows else []


def touch(world, _):
    """Nothing is traced or built for a Modified() alone of whatever there is; nor is a tree built for other materials, which are
    another scene."""
    echo, tree = world.used.algorithms["echo"], world.used.algorithms["tree"]
    if echo.GetMaximumCacheSize() < 1024 or world.used.update(ECHOES, world.moment).errors:
        return
    before = [tree.GetNumberOfBuilds(), echo.GetNumberOfTreeBuilds(), checksum_of(echo)]
    every = [*world.used.algorithms.values(), *world.roots()]
    for _, _, leaf in sum(map(leaves, world.roots()), []):
        every += [leaf] + [one for pair in arrays_of(leaf) for one in pair] if leaf.GetNumberOfPoints() else [leaf]
    for one in every:
        one.Modified()
    world.used.update(ECHOES, world.moment)
    traced = echo.GetNumberOfTracedRays() if world.route.movers is None else echo.GetNumberOfTracedBeams()  # movers are always met anew
    if traced or checksum_of(echo) != before[2]:
        raise Fault(f"{traced} rays or beams are traced for Modified() alone")
    seen = 0
    for _, _, leaf in leaves(world.data):
        kd = leaf.GetCellData().GetArray("kd")
        if kd and kd.IsA("vtkDataArray") and leaf.GetNumberOfPolys():
            seen += not world.route.material and np.any(vtk_to_numpy(kd))
            vtk_to_numpy(kd)[:] *= 0.9
            kd.Modified()
    world.data.Modified()
    if not world.used.update(ECHOES, world.moment).errors:
        after = [tree.GetNumberOfBuilds(), echo.GetNumberOfTreeBuilds(), checksum_of(echo)]
        if before[:2] != after[:2] or seen and before[2] == after[2]:
            raise Fault(f"a tree is built anew for other materials, or they are the same scene: {before} / {after}")


def checksum_of(echo):
    return echo.GetOutput().GetFieldData().GetArray("scene_checksum").GetVariantValue(0).ToString()


def scribble(world, r):
    """An output is edited in place: what follows sees it, and the next execution makes what it makes without."""
    name = r.choice(("tree", "sensor"))
    algorithm = world.used.algorithms[name]
    if world.used.update(ECHOES, world.moment).errors or not getattr(world.route, name, not world.route.table):
        return
    output = algorithm.GetOutput()
    found = [pair for pair in arrays_of(output) if pair[0].GetName() in ("kd", "ks", "Points", "direction", "object_id")] if output.GetNumberOfPoints() else []
    if found:
        array, holder = r.choice(found)
        edit_values(array, r)
        r.choice((array, holder, output)).Modified()
        world.say(f"{array.GetName()} of the output of {name}")
        world.used.algorithms["echo"].Modified()
        fresh, copy = world.fresh(), copy_of(output)
        copy.GetFieldData().RemoveArray("tree_checksum")
        fresh.algorithms["echo"].SetInputDataObject(int(name == "tree"), copy)
        compare(ECHOES, world.used.update(ECHOES, world.moment), fresh.update(ECHOES, world.moment))
    algorithm.Modified()


KINDS.update({"touch": touch, "scribble": scribble})


def break_off(world, r):
    """Abort an algorithm in the middle of an update: what it then has is empty or whole; then go on."""
    (name, fraction), world.abort = world.abort, None
    algorithm, stopped = world.used.algorithms[name], []

    def stop(caller, _):
        if caller.GetProgress() >= fraction:
            stopped.append(caller.GetProgress())
            caller.SetAbortExecute(1)

    observer = algorithm.AddObserver("ProgressEvent", stop)
    algorithm.Modified()
    sink = r.choice([sink for sink in SINKS if sink[0] == name] or [ECHOES])
    found = world.used.update(sink, world.moment)
    algorithm.RemoveObserver(observer)
    algorithm.SetAbortExecute(0)
    algorithm.Modified()
    if stopped and stopped[0] < 1.0 and sink[0] == name:
        expected = world.fresh().update(sink, world.moment)
        if not expected.errors and (found.errors or not is_empty(found.found)):
            different = found.errors or difference(found.found, expected.found)
            if different:
                raise Fault(f"{sink} of an aborted {name} are neither empty nor whole:\n{different}")


def outcome_of(seed, steps, seconds):
    """(what is wrong, what was done, counts) of a child that runs the steps."""
    value, fault, told = children.run(run, seed, steps, seconds=seconds)
    return (f"{told[-1:]}: {fault}", told, {}) if fault else value


def shrunk(seed, steps, kept, seconds):
    """The numbers of the steps that are needed to fail."""
    for one in list(kept):
        fewer = [i for i in kept if i != one]
        if outcome_of(seed, [steps[i] for i in fewer], seconds)[0]:
            kept = fewer
    return kept


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="+", help="7, 3-9, 3- (until stopped), +100 from a free one, or + (until stopped)")
    parser.add_argument("--steps", type=int, default=25, help="in a sequence")
    parser.add_argument("--keep", help="numbers of the steps to run, with commas; none: only the first look")
    parser.add_argument("--limit", type=int, default=60, help="seconds of the processor for a sequence")
    parser.add_argument("--no-shrink", action="store_true")
    arguments = parser.parse_args()
    failed, total, begin = [], {}, time.monotonic()
    for seed in children.seeds(arguments.seeds):
        steps = sequence(seed, arguments.steps)
        kept = range(len(steps)) if arguments.keep is None else [int(i) for i in arguments.keep.split(",") if i != "none"]
        wrong, _, counts = outcome_of(seed, [steps[i] for i in kept], arguments.limit)
        total = {name: total.get(name, 0) + counts.get(name, 0) for name in total | counts}
        if wrong:
            failed.append(seed)
            kept = kept if arguments.keep or arguments.no_shrink else shrunk(seed, steps, kept, arguments.limit)
            wrong, said, _ = outcome_of(seed, [steps[i] for i in kept], arguments.limit)
            print(f"\nseed {seed} fails with {len(kept)} of {len(steps)} steps. Again: same_bits.py --seeds {seed} "
                  f"--steps {len(steps)} --keep {','.join(map(str, kept)) or 'none'}\n  " + "\n  ".join(said) + f"\n{wrong}", flush=True)
    print(f"{total}, {time.monotonic() - begin:.0f} s; failed: {failed or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
