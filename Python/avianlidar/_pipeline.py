# SPDX-License-Identifier: BSD-3-Clause
"""Runs VTK algorithms the way Python expects: errors are exceptions, warnings are warnings, Ctrl-C stops."""
from __future__ import annotations

import contextlib
import os
import re
import signal
import sys
import threading
import warnings
from typing import Any, Callable, Dict, Iterator, List, Optional

from vtkmodules.vtkCommonCore import vtkObject

Progress = Callable[[float, str], Any]


class Error(RuntimeError):
    """What a VTK class reported as an error, in its own words."""


def words_of(error: BaseException) -> str:
    """What an exception says: of files their names, of keys no quotes."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error.args[0] if isinstance(error, KeyError) and error.args else error) or type(error).__name__


def upstream(algorithm, found: Optional[List[Any]] = None) -> List[Any]:
    """The algorithm and all that it depends on, sources first."""
    found = [] if found is None else found
    if algorithm is not None and algorithm not in found:
        for port in range(algorithm.GetNumberOfInputPorts()):
            for i in range(algorithm.GetNumberOfInputConnections(port)):
                upstream(algorithm.GetInputAlgorithm(port, i), found)
        found.append(algorithm)
    return found


def text_of(value: str) -> str:
    """A text that VTK takes as it is: ValueError where it would end it (at NUL) or the process (no UTF-8)."""
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is not a text")
    value.encode()
    if "\0" in value:
        raise ValueError(f"the text {value!r} holds a NUL")
    return value


def file_name(file) -> Any:
    """A file's name as bytes, whatever they are; ValueError for a NUL, where VTK would end it."""
    name = os.fsencode(file)
    if b"\0" in name:
        raise ValueError(f"the file name {os.fspath(file)!r} holds a NUL")
    return name


def plain(message: str) -> str:
    """VTK's text of an error or a warning without source line and address."""
    message = re.sub(r"^\s*(ERROR|Warning): In .*\n", "", message)
    return re.sub(r"^(\w+) \((?:0x)?[0-9a-fA-F]+\): ", r"\1: ", message).strip()


@contextlib.contextmanager
def signals_kept() -> Iterator[List[BaseException]]:
    """What handlers of signals raise in the main thread while the block runs is kept in a list, and the first is raised
    at the end. A handler that raises while they are given back may leave some behind: those pass on what they get."""
    kept: List[BaseException] = []
    handlers: Dict[int, Any] = {}
    inside = True

    def handle(number, frame):
        try:
            handlers[number](number, frame)
        except BaseException as failure:  # noqa: B902
            if not inside:
                raise
            kept.append(failure)

    if threading.current_thread() is threading.main_thread():
        known = {number: signal.getsignal(number) for number in signal.valid_signals()}
        handlers.update((number, handler) for number, handler in known.items() if callable(handler))
    try:
        for number in handlers:
            signal.signal(number, handle)
        yield kept
    finally:
        inside = False
        for number, handler in handlers.items():
            if signal.getsignal(number) is handle:  # who set another one keeps it
                signal.signal(number, handler)
    if kept:
        raise kept[0]


def callers_level() -> int:
    """How many frames above the one that asks the package was entered: where a warning belongs."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back and (frame.f_globals.get("__package__") or "").partition(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    return level


class Updates:
    """Brings an algorithm up to date again and again, and hears it and all that it depends on from enter to exit.

    VTK never forgets an observer from Python and looks through all that there ever were whenever one is removed: who
    updates thousands of times must not add new ones each time.
    """

    def __init__(self, algorithm, progress: Optional[Progress] = None):
        self._algorithm, self._progress = algorithm, progress
        self._tags: List[Any] = []
        self._errors: List[str] = []
        self._warnings: List[str] = []
        self._failures: List[str] = []  # of executives
        self._unfinished: List[Any] = []  # what failed or was stopped
        self._stops: List[BaseException] = []  # of the caller's progress or a signal's handler

    def __enter__(self) -> "Updates":
        try:
            for one in upstream(self._algorithm):
                for event in ("ErrorEvent", "WarningEvent"):
                    self._observe(one, event, self._heard)
                self._observe(one, "ProgressEvent", self._advanced)
                self._observe(one.GetExecutive(), "ErrorEvent", self._heard)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_) -> None:
        for caller, tag in self._tags:
            caller.RemoveObserver(tag)

    def _observe(self, caller, event, heard):
        self._tags.append((caller, caller.AddObserver(event, heard)))

    def _heard(self, caller, event, message):
        # VTK decodes the text, and brings none where that fails.
        text = f"{caller.GetClassName()}: a message that is not UTF-8" if message is None else plain(message)
        if caller.IsA("vtkExecutive"):  # mostly of what the algorithm said already
            first = text.partition("\n")[0]
            self._fail(caller.GetAlgorithm(), "" if "returned failure for request" in first else first)
        elif event == "WarningEvent":
            self._warnings.append(text)
        else:
            self._errors.append(text)
            self._unfinished.append(caller)

    setattr(_heard, "CallDataType", "string0")  # VTK's way to declare the event's data

    def _fail(self, algorithm, text: str = ""):
        why = "without a message" if vtkObject.GetGlobalWarningDisplay() else \
            "and VTK's messages are off: vtkObject.GlobalWarningDisplayOn() shows why"
        self._failures.append(text or f"{algorithm.GetClassName()}: failed, {why}")
        self._unfinished.append(algorithm)

    def _advanced(self, caller, _):
        # An exception must not leave an observer: VTK would print it, and end the process at a KeyboardInterrupt.
        if self._progress and not self._stops:
            try:
                self._progress(caller.GetProgress(), caller.GetClassName())
            except BaseException as stop:  # noqa: B902
                self._stops.append(stop)
        if self._stops:
            caller.SetAbortExecute(True)
            self._unfinished.append(caller)

    def __call__(self, run: Optional[Callable[[], Any]] = None) -> Any:
        """As `update`."""
        for said in (self._errors, self._warnings, self._failures, self._unfinished):
            said.clear()
        algorithm = self._algorithm
        with signals_kept() as self._stops:
            try:
                port = 0 if algorithm.GetNumberOfOutputPorts() else -1
                result = run() if run else algorithm.GetExecutive().Update(port)
                if not run and result == 0 and not self._failures:
                    self._fail(algorithm)
            finally:
                for one in self._unfinished:
                    one.SetAbortExecute(False)
                    one.Modified()  # else its empty output would count as up to date
        for text in self._warnings:
            warnings.warn(text, RuntimeWarning, stacklevel=callers_level())
        if self._errors or self._failures:
            raise Error("\n".join(self._errors or self._failures))
        return result


def is_current(algorithm) -> bool:
    """Whether the algorithm has run since it, or anything that it depends on, was changed."""
    executive = algorithm.GetExecutive()
    executive.UpdatePipelineMTime()
    data = algorithm.GetOutputDataObject(0)
    return data.GetUpdateTime() >= executive.GetPipelineMTime() and not data.GetDataReleased()


def update(algorithm, progress: Optional[Progress] = None, run: Optional[Callable[[], Any]] = None) -> Any:
    """Bring an algorithm up to date, with all that it depends on; returns what `run` returns.

    `run` does it (default: as `algorithm.Update` does). `progress` is called with the share done (0 to 1) and the name
    of the class at work; an exception that it raises ends the run and is passed on. Errors are raised as `Error`,
    warnings are passed to `warnings.warn`. What the handler of a signal raises in the main thread, as KeyboardInterrupt
    at Ctrl-C, ends the run between two blocks of work and is passed on. What failed or was stopped starts afresh the
    next time.
    """
    with Updates(algorithm, progress) as once:
        return once(run)
