# SPDX-License-Identifier: BSD-3-Clause
"""Random sequences of changes to a pipeline: after each step what has run before must give, bit by bit, what one that
never ran gives on copies of the present data. See README.md."""

import argparse
import os
import random
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

import children  # noqa: E402
from contents import contents, copy_of, difference, is_empty  # noqa: E402
from pipeline import Pipeline, SINKS  # noqa: E402
from steps import KINDS, WEIGHTS, World  # noqa: E402

# Kinds of faults that can be left out, to look for others: --without.
SWITCHES = ("stale", "after errors", "abort", "strips", "bad")

BAD_KINDS = ("bad property", "bad data", "missing array")


class Fault(Exception):
    """The pipeline that has run before is not as a fresh one."""


def sequence(seed, count, without):
    """The steps of a seed: (kind, its own seed)."""
    r = random.Random(seed)
    kinds = [kind for kind in KINDS if kind not in without and not ("bad" in without and kind in BAD_KINDS)]
    weights = [WEIGHTS.get(kind, 1) for kind in kinds]
    return [(kind, r.randrange(2**32)) for kind in r.choices(kinds, weights, k=count)]


def run(tell, seed, steps, without):
    """Run steps from the world of a seed; what was done and what is wrong in the end."""
    world = World(random.Random(f"world {seed}"), without)
    world.used = Pipeline(world.settings)
    world.connect()
    world.undo = []
    world.abort = None
    counts = {}
    try:
        check(world, random.Random(seed), counts)
        for number, (kind, own) in enumerate(steps):
            tell(f"{number} {kind}")
            r = random.Random(own)
            if world.undo and (r.random() < 0.5 or kind == "abort"):
                mend(world)
            world.say(f"-- {kind}")
            undo = KINDS[kind](world, r)
            if undo and kind in BAD_KINDS:
                world.undo.append(undo)
            if world.abort:
                break_off(world, r)
            failed = check(world, r, counts)
            if failed and undo and kind not in BAD_KINDS:
                world.undo.append(undo)  # good by itself, but not with the rest
            if failed and "after errors" in without:
                mend(world)
                if check(world, r, counts):
                    break  # of its own: settings that do not go together
        return "", world.said, counts
    except Fault as fault:
        return str(fault), world.said, counts


def mend(world):
    world.say("   mended")
    while world.undo:
        world.undo.pop()()


def fresh_pipeline(world):
    pipeline = Pipeline(world.settings)
    pipeline.connect(copy_of(world.data), world.table and copy_of(world.table), world.route)
    return pipeline


def check(world, r, counts):
    """Look at some outputs, in any order; whether one of them could not be made."""
    sinks = r.sample(sorted(SINKS), r.randint(1, 4))
    if r.random() < 0.7 and not {"echoes", "report"} & set(sinks):
        sinks.append(r.choice(("echoes", "report")))
    fresh, failed = fresh_pipeline(world), False
    for sink in sinks:
        held = [contents(copy) for _, copy in world.held]
        found, expected = world.used.update(sink, world.moment), fresh.update(sink, world.moment)
        counts["looks"] = counts.get("looks", 0) + 1
        counts["errors"] = counts.get("errors", 0) + bool(expected.errors)
        compare(sink, found, expected)
        for (name, copy), before in zip(world.held, held):
            changed = difference(before, contents(copy))
            if changed:
                raise Fault(f"updating {sink} writes into {name} that somebody holds:\n{changed}")
        if expected.errors:
            failed = True
            if "after errors" in world.without:
                break
            fresh = fresh_pipeline(world)
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
    sinks = [sink for sink, (owner, _) in SINKS.items() if owner == name] or ["echoes"]
    sink = r.choice(sinks)
    found = world.used.update(sink, world.moment)
    algorithm.RemoveObserver(observer)
    algorithm.SetAbortExecute(0)
    algorithm.Modified()
    if stopped and stopped[0] < 1.0 and SINKS[sink][0] == name:
        expected = fresh_pipeline(world).update(sink, world.moment)
        if not expected.errors and (found.errors or not is_empty(found.found)):
            different = found.errors or difference(found.found, expected.found)
            if different:
                raise Fault(f"{sink} of an aborted {name} are neither empty nor whole:\n{different}")


def outcome_of(seed, steps, without, seconds):
    """(what is wrong, what was done, counts, and how far it came) of a child that runs the steps."""
    last = []
    outcome = children.run(run, seed, steps, without, seconds=seconds, progress=last.append)
    if outcome.fault:
        return f"{outcome.fault} in step {last[-1] if last else 'none'}\n{outcome.output[-3000:]}", last, {}
    return outcome.value


def shrunk(seed, steps, without, seconds):
    """The shortest failing sequence that dropping steps leads to: halves first, then one after the other."""
    kept = list(range(len(steps)))
    size = len(kept) // 2
    while size:
        start = 0
        while start < len(kept):
            fewer = kept[:start] + kept[start + size :]
            if outcome_of(seed, [steps[i] for i in fewer], without, seconds)[0]:
                kept = fewer
            else:
                start += size
        size //= 2
    return kept


def report(seed, steps, kept, arguments):
    wrong, said, _ = outcome_of(seed, [steps[i] for i in kept], arguments.without, arguments.limit)
    print(f"\nseed {seed} fails with {len(kept)} of {len(steps)} steps. Again: probe_changes.py --seeds {seed} "
          f"--steps {len(steps)} --keep {','.join(map(str, kept)) or 'none'}"
          + "".join(f" --without '{one}'" for one in arguments.without))
    print("\n".join("  " + words for words in said))
    print(wrong, flush=True)


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="0-", help="one seed, first-last, or first- (until stopped)")
    parser.add_argument("--steps", type=int, default=25, help="in a sequence")
    parser.add_argument("--keep", help="numbers of the steps to run, with commas; none: only the first look")
    parser.add_argument("--without", action="append", default=[], choices=SWITCHES, help="leave out these faults")
    parser.add_argument("--limit", type=int, default=60, help="seconds of the processor for a sequence")
    parser.add_argument("--no-shrink", action="store_true")
    arguments = parser.parse_args()
    arguments.first, arguments.last = children.seeds(arguments.seeds)
    return arguments


def main():
    arguments = parse()
    failed, total, begin = [], {}, time.monotonic()
    seed = arguments.first
    while seed <= arguments.last:
        steps = sequence(seed, arguments.steps, arguments.without)
        kept = list(range(len(steps)))
        if arguments.keep:
            kept = [] if arguments.keep == "none" else [int(i) for i in arguments.keep.split(",")]
        wrong, _, counts = outcome_of(seed, [steps[i] for i in kept], arguments.without, arguments.limit)
        for name, count in counts.items():
            total[name] = total.get(name, 0) + count
        if wrong:
            failed.append(seed)
            if not arguments.keep and not arguments.no_shrink:
                kept = shrunk(seed, steps, arguments.without, arguments.limit)
            report(seed, steps, kept, arguments)
        seed += 1
        if seed % 100 == 0:
            print(f"{seed - arguments.first} sequences, {total}, {len(failed)} failed, "
                  f"{time.monotonic() - begin:.0f} s", flush=True)
    print(f"{seed - arguments.first} sequences of {arguments.steps} steps, {total}, "
          f"{time.monotonic() - begin:.0f} s; failed: {failed or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
