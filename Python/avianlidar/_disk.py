# SPDX-License-Identifier: BSD-3-Clause
"""Files that are written completely or not at all, and exclusive use of a folder by one run."""
from __future__ import annotations

import contextlib
import fcntl
import os
import pathlib
import stat
from typing import Any, BinaryIO, Callable, Iterator

from ._pipeline import Error, signals_kept

LOCK = ".avianlidar.lock"  # name of the lock file in a folder during a run
NEW = os.O_CREAT | os.O_EXCL


def _hold(name, flags: int = 0, mode: int = 0o666) -> BinaryIO:
    """Opens and locks a file. `BlockingIOError` if another process holds the lock or has renamed or removed the file;
    `Error` if the file system has no locks. On such file systems a file that this call makes (NEW) counts as locked."""
    with contextlib.ExitStack() as unless_held:
        file = unless_held.enter_context(open(os.open(name, flags | os.O_RDWR | os.O_NOFOLLOW, mode), "r+b"))
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise
        except OSError:
            if flags != NEW:
                raise Error(f"files here have no locks: if no other run is there, remove {name}") from None
        if not os.path.lexists(name) or not os.path.samestat(os.fstat(file.fileno()), os.lstat(name)):
            raise BlockingIOError(f"{name} was replaced by another file")
        unless_held.pop_all()
    return file


@contextlib.contextmanager
def replacing(path: pathlib.Path) -> Iterator[str]:
    """A temporary name beside `path`, renamed to `path` at the end, when the content is on the disk. An exception
    leaves no file. The temporary file of a killed process is removed at the next writing. OutputFile.h does the
    same."""
    try:
        mode = path.stat().st_mode  # before links are followed, because links to open pipes lead to no name
    except FileNotFoundError:
        mode = 0
    if mode and not stat.S_ISREG(mode):
        raise FileExistsError(f"{path}: it exists and is not a regular file")
    given, path = path, path.resolve()  # a link is kept
    file, name, most = None, "", 16
    for part in (f"{path}.avianpart{i}" for i in range(most)):
        with contextlib.suppress(OSError, Error), _hold(part):  # an error if another process writes the part
            os.unlink(part)
        try:
            if not file:
                file, name = _hold(part, NEW, stat.S_IMODE(mode or 0o666) | stat.S_IWUSR), part
        except (FileExistsError, BlockingIOError):
            pass
        except OSError as error:  # names the part
            raise OSError(error.errno, error.strerror, str(given)) from None
    if not file:
        raise FileExistsError(f"{path} is being written by {most} other processes")
    with file:
        try:
            yield name
            if mode:
                os.chmod(name, stat.S_IMODE(mode))
            os.fsync(file)
            os.replace(name, path)
        except BaseException as error:
            with contextlib.suppress(FileNotFoundError):
                os.unlink(name)
            if isinstance(error, OSError) and error.errno:  # errors of a full disk name no file
                raise OSError(error.errno, error.strerror, str(path)) from None
            raise
    synchronize(path.parent)


def synchronize(folder: pathlib.Path) -> None:
    """Writes the names in a folder to the disk."""
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def write_whole(path, content: bytes) -> None:
    """Writes a file, which is on the disk afterwards. Until then, the old file is unchanged."""
    with replacing(pathlib.Path(path)) as name:
        pathlib.Path(name).write_bytes(content)


@contextlib.contextmanager
def only_run(folder, ranks=None, goes_on: bool = True, known: Callable[[], Any] = lambda: None) -> Iterator[None]:
    """Reserves a folder for this run, and makes the folder if needed. `Error` if another run holds the folder. A killed
    run holds no folder. A folder that a failed run has made is removed, with its content unless `goes_on`.
    @param ranks ranks of this run: the first rank holds the folder for all, so no rank may leave before all are done
    @param goes_on whether the files of a failed run are kept
    @param known what the ranks must agree on before writing, see `Ranks.agree`"""
    folder = pathlib.Path(folder)
    if ranks is not None:
        ranks.agree(folder, known)
    lock, new = folder / LOCK, [path for path in (folder, *folder.parents) if not os.path.lexists(path)]
    file, failed = None, True
    problem: Exception = Error(f"{folder}: another run writes there; wait for its end, or choose another folder")
    try:
        if ranks is None or ranks.rank == 0:
            try:
                with signals_kept():  # so that new folders are recorded even at Ctrl+C
                    folder.mkdir(parents=True, exist_ok=True)
                    for flags in 3 * (NEW, 0):  # the run before may end just now
                        with contextlib.suppress(FileExistsError, FileNotFoundError, BlockingIOError):
                            file = file or _hold(lock, flags)
            except (Error, OSError) as error:  # the other ranks must hear of the error before it is raised
                problem = Error(f"{problem}; {error}") if isinstance(error, Error) else error
        if not (ranks.first_says(bool(file)) if ranks else file):
            raise problem
        yield
        failed = False
    finally:
        if file:
            for path in sorted(folder.rglob("*"), reverse=True) if failed and new else ():
                with contextlib.suppress(OSError):
                    if path.is_dir() and not path.is_symlink():
                        path.rmdir()
                    elif path != lock and not goes_on:
                        path.unlink()
            lock.unlink(missing_ok=True)  # while it is locked
            file.close()
        for path in new if failed else ():
            with contextlib.suppress(OSError):
                path.rmdir()
