# SPDX-License-Identifier: BSD-3-Clause
"""Runs VTK algorithms with Python's conventions: exceptions, Python warnings, and Ctrl-C stops a run."""
import contextlib
import os
import re
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterator
from typing import Any

from vtkmodules.vtkCommonCore import vtkObject

Progress = Callable[[float, str], Any]


class Error(RuntimeError):
    """An error that a VTK class has reported, with the words of the class."""


def words_of(error: BaseException) -> str:
    """The message of an exception: with the name of a file, without quotation marks around a key."""
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error.args[0] if isinstance(error, KeyError) and error.args else error) or type(error).__name__


def upstream(algorithm, found: list[Any] | None = None) -> list[Any]:
    """The algorithm and all algorithms that it depends on, sources first."""
    found = [] if found is None else found
    if algorithm is not None and algorithm not in found:
        for port in range(algorithm.GetNumberOfInputPorts()):
            for i in range(algorithm.GetNumberOfInputConnections(port)):
                upstream(algorithm.GetInputAlgorithm(port, i), found)
        found.append(algorithm)
    return found


def text_of(value: str) -> str:
    """A text that VTK can take. ValueError for a NUL, which cuts it, and if it is not UTF-8, which ends the process."""
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is not a text")
    try:
        value.encode()
    except UnicodeEncodeError:
        raise ValueError(f"the text {value!r} is not in UTF-8") from None
    if "\0" in value:
        raise ValueError(f"the text {value!r} holds a NUL")
    return value


def file_name(file) -> Any:
    """The name of a file as bytes. ValueError for a name with a NUL, at which VTK would cut the name."""
    name = os.fsencode(file)
    if b"\0" in name:
        raise ValueError(f"the file name {os.fspath(file)!r} holds a NUL")
    return name


def plain(message: str) -> str:
    """The text of VTK's error or warning, without source line and address."""
    message = re.sub(r"^\s*(ERROR|Warning): In .*\n", "", message)
    return re.sub(r"^(\w+) \((?:0x)?[0-9a-fA-F]+\): ", r"\1: ", message).strip()


@contextlib.contextmanager
def signals_kept() -> Iterator[list[BaseException]]:
    """Keeps in a list the exceptions that signal handlers raise in the main thread while the block runs, and raises the
    first at the end. If a handler raises while the old handlers are restored, some handlers of this function may
    remain; these call the old handlers."""
    kept: list[BaseException] = []
    handlers: dict[int, Any] = {}
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
            if signal.getsignal(number) is handle:  # a handler that was set meanwhile is kept
                signal.signal(number, handler)
    if kept:
        raise kept[0]


def callers_level() -> int:
    """The number of frames between the caller and the call that entered the package, for the position of a warning."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back and (frame.f_globals.get("__package__") or "").partition(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    return level


class Updates:
    """Brings an algorithm up to date repeatedly, and observes the algorithm and its sources from enter to exit.

    VTK never frees an observer from Python, and searches all observers at each removal. A loop of thousands of updates
    must therefore not add new observers each time.
    """

    def __init__(self, algorithm, progress: Progress | None = None):
        self._algorithm, self._progress = algorithm, progress
        self._observers = contextlib.ExitStack()
        self._errors: list[str] = []
        self._warnings: list[str] = []
        self._failures: list[str] = []  # messages of executives
        self._unfinished: list[Any] = []  # algorithms that failed or were stopped
        self._stops: list[BaseException] = []  # exceptions of the caller's progress or of a signal's handler

    def __enter__(self) -> "Updates":
        with contextlib.ExitStack() as observers:  # removes them after an exception
            for one in upstream(self._algorithm):
                for caller, event, heard in ((one, "ErrorEvent", self._heard), (one, "WarningEvent", self._heard),
                                             (one, "ProgressEvent", self._advanced),
                                             (one.GetExecutive(), "ErrorEvent", self._heard)):
                    observers.callback(caller.RemoveObserver, caller.AddObserver(event, heard))
            self._observers = observers.pop_all()
        return self

    def __exit__(self, *_) -> None:
        self._observers.close()

    def _heard(self, caller, event, message):
        # VTK passes None for a text that cannot be decoded.
        text = f"{caller.GetClassName()}: a message that is not UTF-8" if message is None else plain(message)
        if caller.IsA("vtkExecutive"):  # mostly repeats the algorithm's own message
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
        # An exception must not leave an observer: VTK would print it, and would end the process at a KeyboardInterrupt.
        if self._progress and not self._stops:
            try:
                self._progress(caller.GetProgress(), caller.GetClassName())
            except BaseException as stop:  # noqa: B902
                self._stops.append(stop)
        if self._stops:
            caller.SetAbortExecute(True)
            self._unfinished.append(caller)

    def __call__(self, run: Callable[[], Any] | None = None) -> Any:
        """Updates the algorithm; see `update`."""
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
                    one.Modified()  # otherwise the empty output would count as up to date
        for text in self._warnings:
            warnings.warn(text, RuntimeWarning, stacklevel=callers_level())
        if self._errors or self._failures:
            raise Error("\n".join(self._errors or self._failures))
        return result


def is_current(algorithm) -> bool:
    """Whether the algorithm has run since the last change of the algorithm or of any source."""
    executive = algorithm.GetExecutive()
    executive.UpdatePipelineMTime()
    data = algorithm.GetOutputDataObject(0)
    return data.GetUpdateTime() >= executive.GetPipelineMTime() and not data.GetDataReleased()


def update(algorithm, progress: Progress | None = None, run: Callable[[], Any] | None = None) -> Any:
    """Brings an algorithm up to date, with all algorithms that it depends on. Returns the result of `run`.

    `run` executes the algorithm (default: like `algorithm.Update`). `progress` is called with the completed share (0 to
    1) and the name of the running class; an exception of `progress` ends the run and is passed on. Errors are raised as
    `Error`, and warnings are passed to `warnings.warn`. An exception of a signal's handler in the main thread, such as
    KeyboardInterrupt at Ctrl-C, ends the run between two blocks of work and is passed on. An algorithm that failed or
    was stopped starts afresh at the next update.
    """
    with Updates(algorithm, progress) as once:
        return once(run)
