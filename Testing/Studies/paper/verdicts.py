# SPDX-License-Identifier: BSD-3-Clause
"""Checks Documentation/evidence/paper.md against the generated tables: verdicts that follow from measured figures, numbers of findings
that name a table, and the counts of verdicts at the head. The exit code is 1 if a finding has numbers that are no longer measured.

    Testing/Studies/run.py verdicts            writes verdicts and counts into the page
    Testing/Studies/run.py verdicts --check    changes nothing; exit code 1 if something differs
"""
import argparse
import collections
import functools
import pathlib
import re
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "Documentation"))
import page_tables  # noqa: E402

PAGE = page_tables.DOCUMENTATION / "evidence" / "paper.md"
VERDICTS = ("same", "in part", "corrected", "contradicted", "not reproducible")

# How the claim of a row begins: the table and how the claims begin there whose verdicts decide, after | their peers.
MEASURED = {
    "Abstract, Sec. 5.1, Sec. 7: the simulation": ("paper11", "all three are faster"),
    "Fig. 9: building time": ("paper9", "building takes time in proportion"),
    "Fig. 9: total time": ("paper9", "so does the total"),
    "Fig. 9: with SBV": ("paper9", "with SBV", "and grows much faster"),
    "Fig. 9: with the same volume": ("paper9", "with the same volume"),
    "Sec. 5.1: so the k-D tree": ("paper9", "AABB with the k-D tree is the best"),
    "Fig. 10: with few triangles the proposed method takes longer than loops with one": ("paper10", "with few triangles | facet loop, one"),
    "Fig. 10: with few triangles the proposed method takes longer than loops with two": (
        "paper10", "with few triangles | facet loop |", "with few triangles | per ray"),
    "Fig. 10: its time grows at a lower rate than that of loops": ("paper10", "its time grows | facet loop"),
    "Fig. 10: its time grows at a lower rate than that of single rays": ("paper10", "its time grows | per ray"),
    "Fig. 10: so its advantage over loops": ("paper10", "so its advantage | facet loop"),
    "Fig. 10: so its advantage over single rays": ("paper10", "so its advantage | per ray"),
    "Sec. 5.1: in complex environments": ("paper10", "in complex scenes"),
    "Sec. 6, Sec. 7: with many surfaces": ("paper10", "with 100,000 triangles"),
    "Fig. 11, Abstract, Contributions 1 and 2": (
        "paper11", "the beam constraint alone", "the light-energy constraint alone", "Qlow/N: the light-energy", "the batch alone"),
    "Fig. 11: with few triangles": ("paper11", "with few triangles batch"),
    "Fig. 11: with many triangles": ("paper11", "with many the beam constraint"),
    "Fig. 11: beam constraint and batch together": ("paper11", "beam + batch"),
    "Fig. 11: light-energy constraint and batch together": ("paper11", "energy + batch", "Qlow/N: energy + batch"),
    "Fig. 11: both constraints together": ("paper11", "beam + energy", "Qlow/N: beam + energy"),
    "Fig. 11: the best pair": ("paper11", "the best pair", "Qlow/N: the best pair"),
    "Fig. 11: all three": ("paper11", "all three are the fastest", "Qlow/N: all three are the fastest"),
    "Sec. 6: without loss of resolution": ("paper11", "the three do not compromise"),
    "Sec. 1, Sec. 3.4, Sec. 6: the constraints avoid": ("paper11", "the light-energy constraint alone", "Qlow/N: the light-energy")}

# Numbers that a finding may take only from its tables: shares of cases, decimals, thousands, percentages and times.
NUMBER = re.compile(r"\d+ of \d+|\d[\d,]*\.\d+|\d+(?:,\d{3})+|\d+(?= (?:%|ms|s)(?!\w))")


def rows_of(page):
    """The rows of claims: number, claim, verdict, finding, what shows it."""
    return [line.strip("| ").split(" | ") for line in page.splitlines() if re.match(r"\| \d+ \| ", line)]


def word_of(verdict):
    return next((word for word in VERDICTS if verdict.replace("*", "").startswith(word)), None)


@functools.cache
def table(name):
    """The rows of a generated table as lists of cells; empty if no page has the table."""
    return page_tables.rows(name) if page_tables.places(name) else []


def measured(name, *beginnings):
    """The verdict of several rows of a table: what all of them say, else in part."""
    def begins(row, beginning):
        return all(cell.startswith(start) for cell, start in zip((row[0], f"{row[1]} |"), beginning.split(" | ", 1)))

    words = {beginning: {word_of(row[-1]) for row in table(name) if begins(row, beginning)} for beginning in beginnings}
    if not all(words.values()):
        raise ValueError(f"table {name} has no claims that begin with {[b for b, found in words.items() if not found]}")
    every = set().union(*words.values())
    return every.pop() if len(every) == 1 else "in part"


def stale(row):
    """Numbers of a finding that stand in none of the tables beside it."""
    tables = [table(name) for name in re.findall(r"\[([\w-]+)\]\(", row[4])]
    known = {number for found in tables for line in found for cell in line for number in NUMBER.findall(cell)}
    return sorted(set(NUMBER.findall(row[3])) - known) if any(tables) else []


def differences(page):
    """(row, its verdict, numbers that its tables do not have) of wrong rows."""
    rows = rows_of(page)
    for claim in MEASURED:
        if sum(row[1].startswith(claim) for row in rows) != 1:
            raise ValueError(f"'{claim}' has to begin one claim of {PAGE.name}")
    words = [next((measured(*where) for claim, where in MEASURED.items() if row[1].startswith(claim)), row[2]) for row in rows]
    return [(row, word, stale(row)) for row, word in zip(rows, words) if word != row[2] or stale(row)]


def counts(page):
    found = collections.Counter(row[2] for row in rows_of(page))
    return {**found, "all": sum(found.values())}


def brought(page):
    """The page with the verdicts that follow from the tables and with the right counts."""
    for row, word, _ in differences(page):
        page = page.replace(" | ".join(row[:3]) + " | ", " | ".join((*row[:2], word)) + " | ")
    for word, number in counts(page).items():
        page = re.sub(rf"(?m)^(\| {word} \| )\d+( \|)", rf"\g<1>{number}\2", page, count=1)
    return page


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--check", action="store_true", help="change nothing; exit code 1 if something differs")
    options = parser.parse_args(argv)
    try:
        page = PAGE.read_text(encoding="utf-8")
        new, wrong = brought(page), differences(page)
    except (OSError, ValueError) as error:
        print(f"verdicts.py: {error!r}, expected the page and its tables", file=sys.stderr)
        return 2
    for row, word, numbers in wrong:
        print(f"{row[0]}, {row[1]}: {word}; was: {row[2]}" + (f"; no longer measured: {', '.join(numbers)}" if numbers else ""))
    print(", ".join(f"{word} {number}" for word, number in counts(new).items()))
    if not options.check:
        PAGE.write_text(new, encoding="utf-8")
    return 1 if any(numbers for *_, numbers in wrong) or (options.check and new != page) else 0
