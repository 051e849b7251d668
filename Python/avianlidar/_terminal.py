# SPDX-License-Identifier: BSD-3-Clause
"""Output of the command: lines, tables, a progress bar on a terminal, and lines on long work in a log."""
import contextlib
import os
import re
import signal
import sys
import time
from collections.abc import Iterable, Iterator
from typing import Any

INTERVAL = 30.0  # seconds between lines on long work
# Control characters, which a terminal would obey, marks of text direction, which disorder a line, and bytes of names
# that are not UTF-8, which cannot be printed.
_CONTROLS = re.compile("[\x00-\x09\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
_names: list[str] = []  # names with line feeds that the user has given; the line feeds of messages are spaces
_shown: list[Any] = []  # the progress bar on the terminal
_work: dict[str, Any] = {}  # the work that runs: its name, start (s), share at the start and completed share


def shown(text: Any) -> str:
    """A text with escapes in place of control characters, as \\x1b. Only line feeds remain, outside names of files."""
    def escape(found: re.Match[str]) -> str:
        code = ord(found[0])
        code -= 0xDC00 if 0xDC80 <= code < 0xDD00 else 0  # Python's form of a byte
        return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"
    text = str(text)
    for name in _names:
        text = text.replace(name, name.replace("\n", "\\x0a"))
    return _CONTROLS.sub(escape, text)


def names_given(words: Iterable[str]) -> None:
    """Remembers names of files, because a line feed in them is not the end of a line."""
    _names[:] = sorted({part for word in words for part in word.split("/") if "\n" in part}, key=len, reverse=True)


def _in_line(text: str) -> str:
    # No file has a name of more than 255 characters.
    short = re.sub(r"[^\s/]{256,}", lambda name: f"{name[0][:100]}...{name[0][-50:]}", shown(text))
    return " ".join(short.split())


def bar(what: str, done: float, total: float) -> None:
    """Shows the progress of a named work: a bar on a terminal; in a log, lines of `alive`."""
    share = done / total if total else 1.0
    if _work.get("what") != what or share < _work["share"]:
        _work.update(what=what, start=time.monotonic(), first=share)
    _work["share"] = share
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


def in_time(seconds: float) -> str:
    """A time in words."""
    minutes = round(seconds / 60.0)
    return f"{round(seconds)} s" if seconds < 99.5 else f"{minutes} min" if minutes < 100 else f"{minutes / 60.0:.1f} h"


def _say_alive() -> None:
    """Prints one line on the work that runs, unless a bar shows this work."""
    if _shown:
        return
    spent, share, first = time.monotonic() - _work["start"], _work["share"], _work["first"]
    text = f"running for {in_time(spent)}" if spent >= 1.0 else "running"
    if first < share < 1.0:
        text = f"{100.0 * share:.0f} %, about {in_time(spent * (1.0 - share) / (share - first))} left"
    # In one piece, because the next signal may come before the end of this one.
    os.write(2, f"avianlidar: {_in_line(_work['what'])}: {text}\n".encode())


@contextlib.contextmanager
def alive(verb: str) -> Iterator[None]:
    """Prints a line on long work every INTERVAL. A timer's signal interrupts the work in Python, also where VTK reports
    progress."""
    _work.update(what=verb, start=time.monotonic(), first=0.0, share=0.0)
    before = signal.signal(signal.SIGALRM, lambda *_: _say_alive())
    signal.siginterrupt(signal.SIGALRM, False)
    signal.setitimer(signal.ITIMER_REAL, INTERVAL, INTERVAL)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def tell(*lines: Any) -> None:
    """Prints lines to the output, below the progress bar."""
    close_bar()
    if lines:
        print(*map(shown, lines), sep="\n")


def say(text: str) -> None:
    """Prints one line to the error stream, at the end of the work."""
    close_bar(leave=False)
    print(f"avianlidar: {_in_line(text)}", file=sys.stderr)


def warn(text: str) -> None:
    """Prints one line to the error stream, above a progress bar."""
    for one in _shown:
        one.clear()
    print(f"avianlidar: warning: {_in_line(text)}", file=sys.stderr)


def table(rows: Iterable[tuple[Any, ...]]) -> None:
    """Prints columns as wide as their words."""
    lines = [[shown(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*lines)]
    tell(*("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines))
