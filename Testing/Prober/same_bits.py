# SPDX-License-Identifier: BSD-3-Clause
"""Random sequences of changes to a pipeline: after each step what has run before must give, bit by bit, what one that
never ran gives, by another number of threads, on copies of the present data. See README.md."""

import argparse
import os
import random
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

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
    return [(kind, r.randrange(2**32)) for kind in r.choices([*KINDS], [WEIGHTS.get(kind, 1) for kind in KINDS],
                                                             k=count)]


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
    found = [(root, leaf, *pair) for root in world.roots() for _, _, leaf in leaves(root) if leaf.GetNumberOfPoints()
             for pair in arrays_of(leaf)]
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
                raise Fault(f"updating {sink} writes into {name} that somebody holds:\n"
                            f"{difference(before, contents(copy))}")
        if expected.errors:
            failed = True
            fresh = world.fresh()
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


def scribble(world, r):
    """An output is edited in place: what follows sees it, and the next execution makes what it makes without."""
    name = r.choice(("tree", "sensor"))
    algorithm = world.used.algorithms[name]
    # so that the output is the piece that echoes are made from, not one for an image
    world.used.algorithms["echo"].Modified()
    if world.used.update(ECHOES, world.moment).errors or not getattr(world.route, name, not world.route.table):
        return
    output = algorithm.GetOutput()
    found = [pair for pair in (arrays_of(output) if output.GetNumberOfPoints() else ())
             if pair[0].GetName() in ("kd", "ks", "Points", "direction", "object_id")]
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


KINDS["scribble"] = scribble


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="+", help="7, 3-9, 3- (until stopped), +100 from a free one, or + (until "
                                                     "stopped)")
    parser.add_argument("--steps", type=int, default=25, help="in a sequence")
    parser.add_argument("--limit", type=int, default=60, help="seconds of the processor for a sequence")
    arguments = parser.parse_args()
    failed, total, begin = [], {}, time.monotonic()
    for seed in children.seeds(arguments.seeds):
        steps = sequence(seed, arguments.steps)
        value, fault, told = children.run(run, seed, steps, seconds=arguments.limit)
        wrong, said, counts = (f"{told[-1:]}: {fault}", told, {}) if fault else value
        total = {name: total.get(name, 0) + counts.get(name, 0) for name in total | counts}
        if wrong:
            failed.append(seed)
            print(f"\nseed {seed} fails. Again: same_bits.py --seeds {seed} --steps {arguments.steps}\n  "
                  + "\n  ".join(said) + f"\n{wrong}", flush=True)
    print(f"{total}, {time.monotonic() - begin:.0f} s; failed: {failed or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
