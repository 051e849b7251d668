# SPDX-License-Identifier: BSD-3-Clause
"""Output of the command: lines, tables, and a progress bar on a terminal."""
import sys
from collections.abc import Iterable
from typing import Any

_shown: list[Any] = []  # the progress bar on the terminal


def bar(what: str, done: float, total: float) -> None:
    """Shows a progress bar on a terminal for each named work; writes nothing to a log."""
    if not _shown or _shown[0].desc != what:
        close_bar()
        if not sys.stderr.isatty():
            return
        from tqdm import tqdm
        _shown.append(tqdm(total=total, file=sys.stderr))
        _shown[0].desc = what
    _shown[0].update(done - _shown[0].n)


def close_bar(leave: bool = True) -> None:
    """Closes the progress bar. @param leave whether the bar is left on the terminal"""
    while _shown:
        last = _shown.pop()
        last.leave = leave
        last.close()


def tell(*lines: Any) -> None:
    """Prints lines to the output, below the progress bar."""
    close_bar()
    print(*lines, sep="\n")


def say(text: str) -> None:
    """Prints one line to the error stream, at the end of the work."""
    close_bar(leave=False)
    print(f"avianlidar: {' '.join(text.split())}", file=sys.stderr)


def warn(text: str) -> None:
    """Prints one line to the error stream, above a progress bar."""
    for shown in _shown:
        shown.clear()
    print(f"avianlidar: warning: {' '.join(text.split())}", file=sys.stderr)


def table(rows: Iterable[tuple[Any, ...]]) -> None:
    """Prints columns as wide as their words."""
    lines = [[str(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    tell(*("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines))
