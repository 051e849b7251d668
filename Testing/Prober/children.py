# SPDX-License-Identifier: BSD-3-Clause
"""Work in a child process with limits, so that a crash or a hang is an outcome like any other. The parent must not have
scanned: a child of a process whose threads have run is another test's subject."""

import faulthandler
import multiprocessing
import os
import resource
import signal
import sys
import tempfile
import time
import traceback

FORK = multiprocessing.get_context("fork")


def run(work, *arguments, seconds=60, memory=None):
    """(value of work(tell, *arguments) or None, what ended it otherwise, all that it told). `seconds`: of the
    processor, and twenty times as long by the clock. `memory`: of address space, bytes."""
    receive, send = FORK.Pipe(duplex=False)
    told, hung, until = [], False, time.monotonic() + 20 * seconds
    with tempfile.TemporaryFile() as words:
        child = FORK.Process(target=_child, args=(work, arguments, send, words, seconds, memory))
        child.start()
        send.close()
        try:
            while not hung:
                hung = not receive.poll(max(0, until - time.monotonic()))
                if not hung:
                    told.append(receive.recv())
        except EOFError:
            pass
        if hung:
            child.kill()
        child.join()
        words.seek(0)
        output = words.read().decode("utf-8", "replace").split("\nExtension modules:")[0][-2500:]
    if child.exitcode == 0:
        return told.pop(), "", told
    end = f"killed by {signal.Signals(-child.exitcode).name}" if child.exitcode < 0 else f"ended with {child.exitcode}"
    slow = hung or -child.exitcode in (signal.SIGXCPU, signal.SIGKILL)
    return None, (f"takes more than {seconds} s of the processor" if slow else end) + "\n" + output, told


def _child(work, arguments, send, words, seconds, memory):
    for stream in (1, 2):
        os.dup2(words.fileno(), stream)
    faulthandler.enable(words, all_threads=False)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
    if memory:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    try:
        send.send(work(send.send, *arguments))
    except BaseException:  # its end must not be the parent's
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)
    os._exit(0)


def seeds(text):
    """All of "7" or "3-9"; of "+100" so many from a free one, of "3-" and "+" all until they are stopped."""
    first, sign, last = text.partition("+" if text.startswith("+") else "-")
    begin = int(first or time.time_ns() % 10**9)
    return range(begin, begin + 1 if not sign else 2**62 if not last else begin + int(last) if sign == "+"
                 else int(last) + 1)
