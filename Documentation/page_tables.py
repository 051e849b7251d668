# SPDX-License-Identifier: BSD-3-Clause
"""Tables that runs make for these pages. A table stands between <!-- table: NAME --> and <!-- end --> of a page or, where it
is long, in evidence/tables/NAME.csv."""
import csv
import io
import pathlib
import re

DOCUMENTATION = pathlib.Path(__file__).resolve().parent


def cells_of(markdown):
    """The rows of a table in Markdown as lists of plain words, its head first."""
    rows = [[re.sub(r"[*`]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", cell)).strip() for cell in line.strip().strip("|").split("|")]
            for line in markdown.splitlines() if line.startswith("|")]
    return [row for row in rows if not all(re.fullmatch(r":?-+:?", cell) for cell in row)]


def as_csv(markdown):
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(cells_of(markdown))
    return text.getvalue()


def block(name):
    return re.compile(rf"(<!-- table: {re.escape(name)} -->\n)(.*?)(<!-- end -->)", re.S)


def places(name):
    """The files that have the table."""
    file = DOCUMENTATION / "evidence" / "tables" / f"{name}.csv"
    return [page for page in sorted(DOCUMENTATION.rglob("*.md")) if block(name).search(page.read_text(encoding="utf-8"))] + [file] * file.exists()


def put(name, markdown):
    """Write a table wherever it stands. @return those files"""
    for place in places(name):
        old = place.read_text(encoding="utf-8")
        new = as_csv(markdown) if place.suffix == ".csv" else block(name).sub(lambda found: found[1] + markdown + found[3], old)
        if new != old:
            place.write_text(new, encoding="utf-8")
    return places(name)


def rows(name):
    """The rows of a table, its head first, as lists of plain words."""
    found = places(name)
    if not found:
        raise KeyError(f"Documentation has no table {name}")
    text = found[0].read_text(encoding="utf-8")
    return list(csv.reader(io.StringIO(text))) if found[0].suffix == ".csv" else cells_of(block(name).search(text)[2])
