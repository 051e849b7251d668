# SPDX-License-Identifier: BSD-3-Clause
"""Writes the table of Documentation/reference/arrays.md with names, units, places and meanings of arrays, from the
declarations in Filters/Private/Arrays/vtkAvianLidarNames.h.

    arrays_page.py

In this header a comment `// Where.` is above each group, and a comment `/// meaning` is above each name."""
import pathlib
import re

SOURCE = pathlib.Path(__file__).resolve().parents[1]
HEADER = SOURCE / "Filters" / "Private" / "Arrays" / "vtkAvianLidarNames.h"
PAGE = SOURCE / "Documentation" / "reference" / "arrays.md"
BEGIN, END = "<!-- table: arrays -->\n", "<!-- end -->"


def rows():
    """[(name, unit, where, meaning)] in the order of the header."""
    found, where, meaning = [], "", []
    for line in HEADER.read_text(encoding="utf-8").partition("struct Name\n")[2].splitlines():
        declared = re.fullmatch(r'constexpr Name \w+\{ "(\w+)", "([^"]*)"(?:, "[^"]*")? \};', line)
        if declared:
            if not (where and meaning):
                raise ValueError(f"{HEADER.name}: {declared[1]} needs a group and a meaning")
            found.append((*declared.groups(), where, " ".join(meaning)))
            meaning = []
        elif line.startswith("/// "):
            meaning.append(line[4:])
        elif line.startswith("// "):
            where = line[3:].rstrip(".")
    return found


def table():
    lines, group = [], None
    for name, unit, where, meaning in rows():
        if where != group:
            lines += [*[""] * (group is not None), f"## {where}", "", "|name|unit|meaning|", "|---|---|---|"]
        group = where
        lines.append(f"|`{name}`|{unit or '–'}|{meaning.replace(' * ', ' · ')}|")
    return "\n".join(lines) + "\n"


def with_table(page):
    """The text of the page with the current table. @param page text of the page"""
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    return before + begin + table() + end + after


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
