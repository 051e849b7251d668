# SPDX-License-Identifier: BSD-3-Clause
"""Files that are written completely or not at all, and exclusive use of a folder by one run."""
from __future__ import annotations

import contextlib
import fcntl
import os
import pathlib
import stat
from typing import Any, Callable, Iterator

from ._pipeline import Error, signals_kept

LOCK = ".avianlidar.lock"  # name of the lock file in a folder during a run
PARTS = 16  # greatest number of processes that may write one file at the same time


def _hold(name: str, flags: int = 0, mode: int = 0o666) -> int:
    """Opens and locks a file, and returns its descriptor. `BlockingIOError` if another process holds the lock or the file is gone; `Error`
    where the file system has no locks. On such file systems a file that this call creates (O_EXCL) counts as locked."""
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
            raise BlockingIOError(f"{name} was replaced by another file")
        return handle
    except BaseException:
        os.close(handle)
        raise


@contextlib.contextmanager
def replacing(path: pathlib.Path) -> Iterator[str]:
    """A temporary name beside `path`, renamed to `path` at the end, when the content is on the disk. An exception leaves no file. A
    temporary file of a killed process is removed when the file is written again. The library's OutputFile.h does the same."""
    try:
        mode = path.stat().st_mode  # before links are followed, because links to open pipes lead to no name
    except FileNotFoundError:
        mode = 0
    if mode and not stat.S_ISREG(mode):
        raise FileExistsError(f"{path}: it exists and is not a regular file")
    path = path.resolve()  # a link is kept
    handle, name = None, ""
    for part in (f"{path}.avianpart{i}" for i in range(PARTS)):
        with contextlib.suppress(OSError, Error):  # a file of another writer
            abandoned = _hold(part)
            os.unlink(part)
            os.close(abandoned)
        if handle is None:
            with contextlib.suppress(FileExistsError, BlockingIOError):
                handle, name = _hold(part, os.O_CREAT | os.O_EXCL, stat.S_IMODE(mode or 0o666) | stat.S_IWUSR), part
    if handle is None:
        raise FileExistsError(f"{path} is being written by {PARTS} other processes")
    try:
        yield name
        if mode:
            os.chmod(name, stat.S_IMODE(mode))
        os.fsync(handle)
        os.replace(name, path)
    except BaseException as error:
        with contextlib.suppress(FileNotFoundError):
            os.unlink(name)
        if isinstance(error, OSError) and error.errno:  # errors of a full disk name no file
            raise OSError(error.errno, error.strerror, str(path)) from None
        raise
    finally:
        os.close(handle)


def synchronize(folder: pathlib.Path) -> None:
    """Writes the names in a folder to the disk."""
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def write_whole(path, content: bytes) -> None:
    """Writes a file. Afterwards the whole file is on the disk; until then, the old file is unchanged."""
    path = pathlib.Path(path)
    with replacing(path) as name:
        with open(name, "wb") as stream:
            stream.write(content)
    synchronize(path.resolve().parent)


@contextlib.contextmanager
def only_run(folder, ranks=None, goes_on: bool = True, known: Callable[[], Any] = lambda: None) -> Iterator[None]:
    """Reserves a folder for this run, and makes the folder if needed. `Error` if another run holds the folder. A killed run holds no
    folder. A folder that a failed run has made is removed, with its content unless `goes_on`.
    @param ranks ranks of this run: the first rank holds the folder for all, so no rank may leave before all are done
    @param goes_on whether the files of a failed run are kept
    @param known what the ranks must agree on before writing, see `Ranks.agree`"""
    folder = pathlib.Path(folder)
    if ranks is not None:
        ranks.agree(folder, known)
    name, new = folder / LOCK, [path for path in (folder, *folder.parents) if not os.path.lexists(path)]
    handle, failed = None, True
    problem: Exception = Error(f"{folder}: another run writes there; wait for its end, or choose another folder")
    try:
        if ranks is None or ranks.rank == 0:
            try:
                with signals_kept():  # so that new folders are recorded even at Ctrl+C
                    folder.mkdir(parents=True, exist_ok=True)
                    for flags in 3 * (os.O_CREAT | os.O_EXCL, 0):  # the run before may end just now
                        with contextlib.suppress(FileExistsError, FileNotFoundError, BlockingIOError):
                            handle = _hold(str(name), flags)
                            break
            except Error as error:
                problem = Error(f"{problem}; {error}")
            except OSError as error:  # the other ranks must hear of the error before it is raised
                problem = error
        has_it = handle is not None
        if not (ranks.first_says(has_it) if ranks else has_it):
            raise problem
        yield
        failed = False
    finally:
        if handle is not None:
            for path in sorted(folder.rglob("*"), reverse=True) if failed and folder in new else ():  # while the lock is held
                with contextlib.suppress(OSError):
                    if path.is_dir() and not path.is_symlink():
                        path.rmdir()
                    elif path != name and not goes_on:
                        path.unlink()
            with contextlib.suppress(FileNotFoundError):  # removed with its folder
                name.unlink()
            os.close(handle)
        for path in new if failed else ():
            with contextlib.suppress(OSError):
                path.rmdir()
