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
from typing import Any, Callable, List, Optional

from vtkmodules.vtkCommonCore import vtkCommand, vtkObject

Progress = Callable[[float, str], Any]


class Error(RuntimeError):
    """What a VTK class reported as an error, in its own words."""


def upstream(algorithm) -> List[Any]:
    """The algorithm and all that it depends on, sources first."""
    found: List[Any] = []

    def visit(one):
        if one is None or one in found:
            return
        for port in range(one.GetNumberOfInputPorts()):
            for i in range(one.GetNumberOfInputConnections(port)):
                visit(one.GetInputAlgorithm(port, i))
        found.append(one)

    visit(algorithm)
    return found


def text_of(value: str) -> str:
    """A text that VTK takes as it is: ValueError where it would end it (at NUL) or the process (no UTF-8)."""
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is no text")
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


class _Listener:
    """What a chain of algorithms says while it runs, and the wish to stop it."""

    def __init__(self, progress: Optional[Progress]):
        self.errors: List[str] = []
        self.warnings: List[str] = []
        self.failures: List[str] = []  # said by executives, mostly of what the algorithms said already
        self.running = True
        self.failure: Optional[BaseException] = None  # raised by the caller's progress or by a signal's handler
        self.unfinished: List[Any] = []  # what failed or was stopped
        self._progress = progress
        self._tags: List[Any] = []

    def listen_to(self, algorithms):
        for algorithm in algorithms:
            self._observe(algorithm, vtkCommand.ErrorEvent, self._text(self.errors, self.unfinished))
            self._observe(algorithm, vtkCommand.WarningEvent, self._text(self.warnings, []))
            self._observe(algorithm, vtkCommand.ProgressEvent, self._advanced)
            self._observe(algorithm.GetExecutive(), vtkCommand.ErrorEvent, self._failed)

    def begin(self):
        """Forget what was said before."""
        for said in (self.errors, self.warnings, self.failures, self.unfinished):
            said.clear()
        self.running, self.failure = True, None

    def remove(self):
        for caller, tag in self._tags:
            caller.RemoveObserver(tag)

    def guarded(self, handler):
        """A signal's handler that keeps what is raised while VTK works: it would leave an observer, and be printed."""

        def handle(number, frame):
            if not self.running:
                handler(number, frame)
                return
            try:
                handler(number, frame)
            except BaseException as failure:  # noqa: B902
                self.failure = self.failure or failure

        return handle

    def _observe(self, caller, event, heard):
        self._tags.append((caller, caller.AddObserver(event, heard)))

    @staticmethod
    def _text(texts: List[str], callers: List[Any]):
        def heard(caller, _, message):
            # VTK decodes the text, and brings none where that fails.
            texts.append(f"{caller.GetClassName()}: a message that is not UTF-8" if message is None else plain(message))
            callers.append(caller)

        setattr(heard, "CallDataType", "string0")  # how VTK is told what the event brings
        return heard

    def fail(self, algorithm, text: str = ""):
        why = "without a message" if vtkObject.GetGlobalWarningDisplay() else \
            "and VTK's messages are off: vtkObject.GlobalWarningDisplayOn() shows why"
        self.failures.append(text or f"{algorithm.GetClassName()}: failed, {why}")
        self.unfinished.append(algorithm)

    def _failed(self, caller, _, message):
        algorithm, text = caller.GetAlgorithm(), plain(message or "").partition("\n")[0]
        if "returned failure for request" in text:
            text = ""
        self.fail(algorithm, text)

    setattr(_failed, "CallDataType", "string0")

    def _advanced(self, caller, _):
        # An exception must not leave an observer: VTK would print it, and end the process at a KeyboardInterrupt.
        if self._progress and not self.failure:
            try:
                self._progress(caller.GetProgress(), caller.GetClassName())
            except BaseException as failure:  # noqa: B902
                self.failure = failure
        if self.failure:
            caller.SetAbortExecute(True)
            self.unfinished.append(caller)


@contextlib.contextmanager
def _signals(listener: _Listener):
    """Handlers of signals, which Python calls in the main thread, are guarded by the listener. One that raises while
    they are given back may leave some behind: those pass on all that they get."""
    with contextlib.ExitStack() as stack:
        if threading.current_thread() is threading.main_thread():
            for number in signal.valid_signals():
                handler = signal.getsignal(number)
                if callable(handler):
                    ours = listener.guarded(handler)
                    stack.callback(lambda number=number, ours=ours, handler=handler:  # who set another one keeps it
                                   signal.getsignal(number) is ours and signal.signal(number, handler))
                    signal.signal(number, ours)
        try:
            yield
        finally:
            listener.running = False


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
        self._algorithm, self._listener = algorithm, _Listener(progress)

    def __enter__(self) -> "Updates":
        try:
            self._listener.listen_to(upstream(self._algorithm))
        except BaseException:
            self._listener.remove()
            raise
        return self

    def __exit__(self, *_) -> None:
        self._listener.remove()

    def __call__(self, run: Optional[Callable[[], Any]] = None) -> Any:
        """As `update`."""
        algorithm, listener = self._algorithm, self._listener
        listener.begin()
        with _signals(listener):
            try:
                port = 0 if algorithm.GetNumberOfOutputPorts() else -1
                result = run() if run else algorithm.GetExecutive().Update(port)
                if not run and result == 0 and not listener.failures:
                    listener.fail(algorithm)
            finally:
                for one in listener.unfinished:
                    one.SetAbortExecute(False)
                    one.Modified()  # else its empty output would count as up to date
        if listener.failure:
            raise listener.failure
        for text in listener.warnings:
            warnings.warn(text, RuntimeWarning, stacklevel=callers_level())
        if listener.errors or listener.failures:
            raise Error("\n".join(listener.errors or listener.failures))
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
