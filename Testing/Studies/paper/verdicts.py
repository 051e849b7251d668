# SPDX-License-Identifier: BSD-3-Clause
"""The verdicts of Documentation/paper.md that follow from measured figures, and the counts of verdicts at its head. Verdicts
are taken from the tables of Documentation/results/paper-figures.md, which Testing/Benchmarks/report.py makes of a run of the
benchmarks. Says which reasons have to be read again; the exit code is 1 if a row has numbers that are no longer measured.

    Testing/Studies/run.py verdicts                              writes verdicts and counts into the page
    Testing/Studies/run.py verdicts --times build/paper/times.csv   and how long each part of run.sh took
    Testing/Studies/run.py verdicts --check                      changes nothing; exit code 1 if something differs
"""
import argparse
import collections
import csv
import pathlib
import re
import sys

DOCUMENTATION = pathlib.Path(__file__).resolve().parents[3] / "Documentation"
PAGE, FIGURES = DOCUMENTATION / "paper.md", DOCUMENTATION / "results" / "paper-figures.md"
VERDICTS = ("same", "in part", "corrected", "contradicted", "not reproducible")

# The claim of a row of paper.md as it begins, the table of paper-figures.md, the claims of its rows as they begin, and other rows
# whose numbers it may name.
LOSS = ("paper11", ("the three do not compromise",))
MEASURED = (
    ("Abstract: beam and light-energy constraint", "paper11", ("the beam constraint alone", "the light-energy constraint alone"), LOSS),
    ("Abstract: collision detection by beams", "paper11", ("the batch alone",)),
    ("Abstract: the simulation is significantly faster", "paper11", ("all three are faster",)),
    ("Contribution 1:", "paper11", ("the beam constraint alone", "the light-energy constraint alone")),
    ("Contribution 2:", "paper11", ("the batch alone",)),
    ("Fig. 9: building and total time", "paper9", ("building takes time in proportion", "so does the total")),
    ("Fig. 9: with SBV", "paper9", ("with SBV", "and grows much faster")),
    ("Fig. 9: with the same volume", "paper9", ("with the same volume",)),
    ("Fig. 10: with few triangles", "paper10", ("with few triangles",)),
    ("Fig. 10: its time grows", "paper10", ("its time grows",)),
    ("Fig. 10: so its advantage", "paper10", ("so its advantage",)),
    ("Sec. 5.1: in complex environments", "paper10", ("in complex scenes",)),
    ("Fig. 11: each alone", "paper11", ("the beam constraint alone", "the light-energy constraint alone", "the batch alone")),
    ("Fig. 11: any two", "paper11", ("beam + energy", "beam + batch", "energy + batch")),
    ("Fig. 11: the best pair", "paper11", ("the best pair",)),
    ("Fig. 11: with few triangles", "paper11", ("with few triangles batch",)),
    ("Fig. 11: with many triangles", "paper11", ("with many",)),
    ("Fig. 11: all three are the fastest", "paper11", ("all three are the fastest",)),
    ("Sec. 3.4: this avoids extensive tracing", "paper11", ("the light-energy constraint alone",), LOSS, ("rays11", ("",))),
    ("Sec. 6: efficiency rises without loss", "paper11", ("the three do not compromise",)),
    ("Sec. 5.1: so the approach", "paper11", ("all three are faster",)),
    ("Sec. 6: superior to BRDF and Phong", "paper10", ("with 100,000 triangles",)),
    ("Sec. 7: superior overall performance", "paper11", ("all three are faster",)),
    ("Sec. 7: faster than other methods", "paper10", ("in complex scenes", "with 100,000 triangles")))

# Rows whose verdict is not about the measurement: their ratios and times with two decimals stand in a table.
QUOTED = (("Sec. 5.2: 83 ms", "section5"), ("Sec. 5.3: 16 channels", "section5"), ("Sec. 5.3: 32 channels", "section5"))


def rows_of(text):
    """The rows of the tables of claims, each as its cells."""
    claims = text.split("## Abstract", 1)[1].split("## How this page is kept", 1)[0]
    rows = [line.removeprefix("| ").removesuffix(" |").split(" | ") for line in claims.splitlines() if line.startswith("| ")]
    return [row for row in rows if row[0] != "paper"]


def word_of(verdict):
    return next((word for word in VERDICTS if verdict.replace("*", "").startswith(word)), None)


def measured(figures, table, beginnings=("",)):
    """What was measured about some claims: the rows of the table, without claims all of them."""
    lines = figures.split(f"<!-- table: {table} -->\n", 1)[1].split("<!-- end -->", 1)[0].splitlines()[2:]
    return [line for line in lines for beginning in beginnings if line.startswith(f"| {beginning}")]


def overall(lines):
    """The verdict of several rows: what all of them say, else in part."""
    words = {word_of(line.strip("| ").split(" | ")[-1]) for line in lines}
    return words.pop() if len(words) == 1 else "in part"


def numbers(text):
    """What a row may not say otherwise than the measurement: shares of cases, and numbers with two decimals."""
    return set(re.findall(r"\d+ of \d+(?= (?:cases|scenes|spheres))|\d+\.\d\d(?!\d)", text))


def row_of(rows, claim, lines):
    """The one row that begins so, if something was measured about it."""
    mine = [row for row in rows if row[0].startswith(claim)]
    if len(mine) != 1 or not lines:
        raise ValueError(f"'{claim}' begins {len(mine)} rows of {PAGE.name} and has {len(lines)} in {FIGURES.name}, "
                         "expected 1 and at least 1")
    return mine[0]


def differences(page, figures):
    """(row, verdict that follows from the measurement, what the row says that the measurement does not) of wrong rows."""
    found, rows = [], rows_of(page)
    for claim, table, beginnings, *others in MEASURED:
        lines = measured(figures, table, beginnings)
        row = row_of(rows, claim, lines)
        named = [line for other in others for line in measured(figures, *other)]
        found.append((row, overall(lines), numbers(" ".join((row[1], row[4]))) - numbers(" ".join((*lines, *named)))))
    for claim, table in QUOTED:
        lines = measured(figures, table)
        row = row_of(rows, claim, lines)
        found.append((row, word_of(row[4]), set(re.findall(r"\d+\.\d\d", row[1])) - set(re.findall(r"\d+\.\d\d", " ".join(lines)))))
    return [(row, word, sorted(stale)) for row, word, stale in found if word != word_of(row[4]) or stale]


def counts(page):
    found = collections.Counter(word_of(row[4]) for row in rows_of(page))
    return {**{word: found[word] for word in VERDICTS}, "all": sum(found.values())}


def with_counts(page):
    """The page with the right numbers at its head."""
    for word, number in counts(page).items():
        page = re.sub(rf"(?m)^(\| {word} \| )\d+( \|)", rf"\g<1>{number}\2", page, count=1)
    return page


def brought(page, figures):
    """The page with the verdicts that follow from the measurements and with the right counts, and differences() before."""
    wrong = differences(page, figures)
    for row, word, _ in wrong:
        if word != word_of(row[4]):
            reason = row[4].split(": ", 1)[-1] if ": " in row[4] else "see where it is shown"
            page = page.replace(f"| {' | '.join(row)} |", f"| {' | '.join(row[:4])} | {word}: {reason} |")
    return with_counts(page), wrong


def with_times(page, file):
    """The page with the seconds of a run of run.sh, in minutes."""
    with open(file, encoding="utf-8") as lines:
        parts = {row["part"]: int(row["seconds"]) for row in csv.DictReader(lines)}
    if "all" not in parts:
        raise ValueError(f"{file} has no line 'all': the run has not ended")
    rows = [f"| {part} | {seconds / 60:.1f} |" for part, seconds in parts.items()]
    table = "\n".join(["| part | minutes |", "|---|---:|", *rows])
    page, count = re.subn(r"(?s)(<!-- table: times -->\n).*?(\n<!-- end -->)", lambda found: found[1] + table + found[2], page)
    if count != 1:
        raise ValueError(f"{PAGE.name} has {count} tables of times, expected 1")
    return page


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--check", action="store_true", help="change nothing; exit code 1 if something differs")
    parser.add_argument("--times", type=pathlib.Path, help="times.csv of a run of run.sh, for the page")
    options = parser.parse_args(argv)
    page = PAGE.read_text(encoding="utf-8")
    try:
        new, wrong = brought(page, FIGURES.read_text(encoding="utf-8"))
        new = with_times(new, options.times) if options.times else new
    except (OSError, KeyError, ValueError) as error:
        print(f"verdicts.py: {error!r}, expected the page, its tables and the times.csv of run.sh", file=sys.stderr)
        return 2
    for row, word, stale in wrong:
        print(f"{row[0]}: {word}; was: {row[4]}" + (f"; no longer measured: {', '.join(stale)}" if stale else ""))
    print(", ".join(f"{word} {number}" for word, number in counts(new).items()))
    if not options.check:
        PAGE.write_text(new, encoding="utf-8")
    return 1 if any(stale for *_, stale in wrong) or (options.check and new != page) else 0
