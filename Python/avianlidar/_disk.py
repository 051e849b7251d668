# SPDX-License-Identifier: BSD-3-Clause
"""Files that are written as a whole or not at all, and one run in a folder."""
from __future__ import annotations

import contextlib
import fcntl
import os
import pathlib
import stat
from typing import Any, Callable, Iterator

from ._pipeline import Error, signals_kept

LOCK = ".avianlidar.lock"  # in a folder while a run writes there
PARTS = 16  # so many may write one file at the same time


def _hold(name: str, flags: int = 0, mode: int = 0o666) -> int:
    """Open a file and lock it: its descriptor. `BlockingIOError` if another process has it or it is gone, `Error` where the file system
    has no locks. There a file that is made here (O_EXCL) counts as locked."""
    handle = os.open(name, flags | os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK, mode)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise
        except OSError:
            if not flags & os.O_EXCL:
                raise Error(f"files here have no locks: if no other run is there, remove {name}") from None
        locked = os.fstat(handle)
        if not locked.st_nlink or not os.path.samestat(locked, os.lstat(name)):
            raise BlockingIOError(f"{name} is another file now")
        return handle
    except BaseException:
        os.close(handle)
        raise


@contextlib.contextmanager
def replacing(path: pathlib.Path) -> Iterator[str]:
    """A name beside `path` that takes its place at the end, once all is on the disk; nothing is left if something goes wrong,
    and what a killed process leaves goes when the file is written again: as in the library's OutputFile.h."""
    try:
        mode = path.stat().st_mode  # before links are followed: those to open pipes lead to no name
    except FileNotFoundError:
        mode = 0
    if mode and not stat.S_ISREG(mode):
        raise FileExistsError(f"{path}: it exists and is not a regular file")
    path = path.resolve()  # a link stays a link
    handle, name = None, ""
    for part in (f"{path}.avianpart{i}" for i in range(PARTS)):
        with contextlib.suppress(OSError, Error):  # another writer's
            abandoned = _hold(part)
            os.unlink(part)
            os.close(abandoned)
        if handle is None:
            with contextlib.suppress(FileExistsError, BlockingIOError):
                handle, name = _hold(part, os.O_CREAT | os.O_EXCL, stat.S_IMODE(mode or 0o666) | stat.S_IWUSR), part
    if handle is None:
        raise FileExistsError(f"{path} is being written by {PARTS} others")
    try:
        yield name
        if mode:
            os.chmod(name, stat.S_IMODE(mode))
        os.fsync(handle)
        os.replace(name, path)
    except BaseException as error:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(name)
        if isinstance(error, OSError) and error.errno:  # of a full disk, which names no file
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise
    finally:
        os.close(handle)


def synchronize(folder: pathlib.Path) -> None:
    """Names in the folder are on the disk."""
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def write_whole(path, content: bytes) -> None:
    """After this the file is there, whole, whatever happens then; before, it was as it had been."""
    path = pathlib.Path(path)
    with replacing(path) as name:
        with open(name, "wb") as stream:
            stream.write(content)
    synchronize(path.resolve().parent)


@contextlib.contextmanager
def only_run(folder, ranks=None, goes_on: bool = True, known: Callable[[], Any] = lambda: None) -> Iterator[None]:
    """The folder, which is made, is of this run alone: `Error` where another one has it. A run that was killed has none. A folder
    that a failed run has made goes again, with what is in it unless the next run goes on with that.
    @param ranks of this run: the first has the folder for all, so none must leave before the others are done
    @param goes_on whether what a failed run has left stays
    @param known what ranks must agree on before anything is written, see `Ranks.agree`"""
    folder = pathlib.Path(folder)
    if ranks is not None:
        ranks.agree(folder, known)
    name, new = folder / LOCK, [path for path in (folder, *folder.parents) if not os.path.lexists(path)]
    handle, failed = None, True
    problem: Exception = Error(f"{folder}: another run writes there; wait for its end, or choose another folder")
    try:
        if ranks is None or ranks.rank == 0:
            try:
                with signals_kept():  # so that what was made is known when Ctrl+C comes
                    folder.mkdir(parents=True, exist_ok=True)
                    for flags in 3 * (os.O_CREAT | os.O_EXCL, 0):  # the run before may end just now
                        with contextlib.suppress(FileExistsError, FileNotFoundError, BlockingIOError):
                            handle = _hold(str(name), flags)
                            break
            except Error as error:
                problem = Error(f"{problem}; {error}")
            except OSError as error:  # the others are to know before it is said
                problem = error
        has_it = handle is not None
        if not (ranks.first_says(has_it) if ranks else has_it):
            raise problem
        yield
        failed = False
    finally:
        if handle is not None:
            for path in sorted(folder.rglob("*"), reverse=True) if failed and folder in new else ():  # while it is locked
                with contextlib.suppress(OSError):
                    if path.is_dir() and not path.is_symlink():
                        path.rmdir()
                    elif path != name and not goes_on:
                        path.unlink()
            with contextlib.suppress(FileNotFoundError):  # with its folder
                name.unlink()
            os.close(handle)
        for path in new if failed else ():
            with contextlib.suppress(OSError):
                path.rmdir()
