# SPDX-License-Identifier: BSD-3-Clause
"""Plans of coverage and scenarios made wrong, and the files that they name: each is taken as a whole, or refused before the work
in words that name the file and its member; never a traceback, a signal or a hang. See README.md."""

import argparse
import json
import os
import random
import re
import shutil
import sys
import tempfile
import time
import traceback
import warnings

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "Python"))

import children  # noqa: E402
import mutations  # noqa: E402
import plans  # noqa: E402
from avianlidar import Error, Sequence  # noqa: E402
from avianlidar.apps._maps import read_plan  # noqa: E402
from avianlidar.apps._report import Report  # noqa: E402

BATCH = 40  # documents to a child
OPENED = ("lattice.coverage.json", "points.coverage.json", "town.scenario.json")
MEMBERS = ("description|scene|sensor|compare_with|coverage|weather|year|metar|mix|regions|heights|extent|spacing|runways|places|seed|siting|scan|"
           "number_of_scans|scans_per_sequence|near_clutter_distance|birds|objects")
OF_THE_FILE = ("is no JSON", "its compression", "Additional properties are not allowed", "is a required property", "is not of type 'object'")
SMALL = 2e5  # values that the work may make
NO_WORK = 8  # of so many good documents the work of one is done


def mutated(seed):
    """The opened file of a seed, and {name: content} of all."""
    r = random.Random(seed)
    opened, files, documents = r.choice(OPENED), plans.files(), plans.documents()
    others = ("town.lidarscene.json", "town.geojson", *(() if "scenario" in opened else ("points.csv", "year.txt") if "points" in opened else ("taken.geojson",)))
    name = opened if r.random() < 0.6 else r.choice(others)
    if name in documents and r.random() < 0.8:
        files[name] = json.dumps(plans.changed(documents[name], r.randrange(2**32))).encode()
    else:
        files[name] = mutations.applied(files[name], mutations.drawn(r))
    return opened, files


def check(file):
    """What a file asks for, checked, and how many values its work would make."""
    if file.endswith(".scenario.json"):
        sequence = Sequence(file, threads=1)
        beams = sequence.sensor.beams.number_of_points * int(sequence.scenario.get("scan", {}).get("rays_per_beam", 500))
        return sequence, sequence.scans * beams
    report = Report(read_plan(file), threads=1)
    first = report.plans[0]
    x0, x1, y0, y1 = first.extent
    values = sum(plan.sensor.beams.number_of_points for plan in report.plans) + 10 * first.count
    values += len(report.plans) * len(first.heights) * (x1 - x0 + first.spacing) * (y1 - y0 + first.spacing) / first.spacing ** 2
    values += sum(runway.axis()[1] for runway in first.runways)
    for sites in report.sites:
        draws = 1 + 3 * int(sites.options.get("draws", 10))
        values += draws * len(sites.positions) * (first.count + 1000) * len(sites.mix)
    return report, values


def work(asked, folder):
    """All that is left to do."""
    if isinstance(asked, Sequence):
        for number in range(len(asked)):
            for k, _, species in asked.frames(number):
                asked.truth(k, species)
        return
    for plan in asked.plans:
        plan.write(os.path.join(folder, "maps"))
    for sites in asked.sites:
        changes = list(sites.look().changes())
        sites.gain()
        sites.robustness(changes)


def judge(opened, error):
    """What is wrong with an error, or nothing."""
    if not isinstance(error, Error):
        return "".join(traceback.format_exception(error))
    words = str(error).partition(f"{opened}: ")[2]
    if not words:
        return f"an error that does not name the file: {error}"
    if not re.match(rf"({MEMBERS})\b", words) and not any(of in words for of in OF_THE_FILE):
        return f"an error that does not name the member: {error}"
    return ""


def look_at(seed, folder, every):
    """What is wrong with what becomes of a seed, or nothing; and what became of it."""
    opened, files = mutated(seed)
    for name, content in files.items():
        with open(os.path.join(folder, name), "wb") as file:
            file.write(content)
    try:
        asked, values = check(os.path.join(folder, opened))
    except Exception as error:  # noqa: B902
        return judge(opened, error), "refused"
    if values > SMALL or (seed % NO_WORK and not every):
        return "", "good"
    try:
        work(asked, folder)
    except Exception as error:  # noqa: B902
        return f"only the work finds an error:\n{''.join(traceback.format_exception(error))}", "done"
    return "", "done"


def run(tell, seeds, folder, every):
    warnings.simplefilter("ignore")
    kinds = {}
    for seed in seeds:
        tell(seed)
        wrong, kind = look_at(seed, folder, every)
        kinds[kind] = kinds.get(kind, 0) + 1
        if wrong:
            return seed, wrong, kinds
    return None, "", kinds


def outcome_of(seeds, options):
    """(the first seed that fails or None, what is wrong, counts)"""
    last = [seeds[0]]
    folder = tempfile.mkdtemp(prefix="probe-plans-")
    try:
        outcome = children.run(run, seeds, folder, options.work, seconds=options.limit, memory=options.memory << 20, progress=last.append)
    finally:
        shutil.rmtree(folder)
    return (last[-1], f"{outcome.fault}\n{outcome.output[-2500:]}", {}) if outcome.fault else outcome.value


def show(seed, wrong, keep):
    opened, files = mutated(seed)
    print(f"\nseed {seed}: {opened}\n{wrong.strip()}", flush=True)
    if keep:
        folder = os.path.join(keep, str(seed))
        os.makedirs(folder, exist_ok=True)
        for name, content in files.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(content)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", default="0-", help="one seed, first-last, or first- (until stopped)")
    parser.add_argument("--memory", type=int, default=4096, help="MiB of address space")
    parser.add_argument("--limit", type=int, default=60, help=f"seconds of the processor for {BATCH} documents, and for one")
    parser.add_argument("--work", action="store_true", help="do the work of all that are good and small, not of every eighth")
    parser.add_argument("--keep", help="folder for the files that fail")
    options = parser.parse_args()
    seed, last = children.seeds(options.seeds)
    first, failed, total, begin = seed, [], {}, time.monotonic()
    while seed <= last:
        end = min(seed + BATCH, last + 1)
        number, wrong, kinds = outcome_of(list(range(seed, end)), options)
        for kind, count in kinds.items():
            total[kind] = total.get(kind, 0) + count
        if number is not None:
            alone = outcome_of([number], options)[1]
            if alone or not wrong.startswith("takes more"):
                failed.append(number)
                show(number, alone or f"only after others: {wrong}", options.keep)
        seed = end if number is None else number + 1
    print(f"{seed - first} documents, {total}, {time.monotonic() - begin:.0f} s; failed: {failed or 'none'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
