# SPDX-License-Identifier: BSD-3-Clause
"""Tables as files (CSV)."""
from __future__ import annotations

import csv
import io
from typing import Any, Dict, Iterable, Iterator, List, Sequence

from ..._disk import write_whole
from ..._files import read_regular
from ..._pipeline import Error
from ..._writers import as_csv


def csv_rows(file, text: str, delimiter: str = ",") -> Iterator[List[str]]:
    """Rows of CSV. `Error` names the line in which a row begins that has a wrong quote, such as one that is not
    closed and would take the following rows into its cell."""
    rows, begin = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter, skipinitialspace=True, strict=True), 1
    try:
        for row in rows:
            yield row
            begin = rows.line_num + 1
    except csv.Error as error:
        raise Error(f"{file}: line {begin}: is not CSV ({error}), expected each quote to be closed") from None


def read_table(file, columns: Sequence[str] = (), expected: str = "") -> List[Dict[str, str]]:
    """Rows of CSV by the names of the columns. @param columns required @param expected what the file should be"""
    try:
        text = read_regular(file).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise Error(f"{file}: is not text in UTF-8 ({error})") from None
    rows = [row for row in csv_rows(file, text) if row]
    names = rows[0] if rows else []
    missing = [name for name in columns if name not in names]
    if missing:
        raise Error(f"{file}: has no column {missing[0]}, expected {expected}")
    return [{**dict.fromkeys(names, ""), **dict(zip(names, row))} for row in rows[1:]]


def write_table(file, rows: Sequence[Dict[str, Any]]) -> None:
    """Writes rows as CSV, with units in the header."""
    head = [[f"{name} [m]" if name in ("height_from", "height_to") else name for name in rows[0]]] if rows else []
    table = [[f"{value:.6g}" if isinstance(value, float) else value for value in row.values()] for row in rows]
    write_whole(file, as_csv(head + table, "\r\n"))


def texts(row: Iterable[Any]) -> List[Any]:
    """A row of CSV: numbers with six digits, nothing for None and nan."""
    def text(value: Any) -> Any:
        if value is None or value != value:
            return ""
        return f"{value:.6g}" if isinstance(value, float) else value
    return [text(value) for value in row]


