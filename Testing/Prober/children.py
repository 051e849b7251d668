# SPDX-License-Identifier: BSD-3-Clause
"""Work in a child process with limits, so that whatever happens to it is an outcome. The parent must not have scanned:
a child of a process whose threads have run is another test's subject."""

import faulthandler
import os
import pickle
import resource
import select
import signal
import sys
import tempfile
import time
import traceback


class Outcome:
    """What became of a child: `value` if it ended well, else `fault` says what ended it, in words."""

    def __init__(self, value=None, fault="", output=""):
        self.value = value
        self.fault = fault
        self.output = output


def run(work, *arguments, seconds=60, memory=None, progress=None):
    """work(*arguments) in a child. `seconds`: of the processor, and twenty times as long by the clock. `memory`: of
    address space, bytes. `progress`: called with each object that the work hands to its first argument `tell`."""
    receive, send = os.pipe()
    with tempfile.TemporaryFile() as words:
        sys.stdout.flush()
        child = os.fork()
        if child == 0:
            os.close(receive)
            _child(work, arguments, send, words, seconds, memory)
        os.close(send)
        messages, hung = _listen(receive, time.monotonic() + 20 * seconds, progress)
        os.close(receive)
        if hung:
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        words.seek(0)
        output = words.read().decode("utf-8", "replace").split("\nExtension modules:")[0]
    if hung:
        return Outcome(fault=f"hangs: no end after {20 * seconds} s", output=output)
    if os.WIFSIGNALED(status):
        number = os.WTERMSIG(status)
        if number in (signal.SIGXCPU, signal.SIGKILL):
            return Outcome(fault=f"takes more than {seconds} s of the processor", output=output)
        return Outcome(fault=f"killed by {signal.Signals(number).name}", output=output)
    if not messages or messages[-1][0] != "done":
        return Outcome(fault=f"ended with {os.WEXITSTATUS(status)} and without a result", output=output)
    return Outcome(value=messages[-1][1], output=output)


def _child(work, arguments, send, words, seconds, memory):
    code = 1
    try:
        os.dup2(words.fileno(), 1)
        os.dup2(words.fileno(), 2)
        faulthandler.enable(words, all_threads=False)
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
        if memory:
            resource.setrlimit(resource.RLIMIT_AS, (memory, memory))

        def tell(what, kind="told"):
            data = pickle.dumps((kind, what))
            os.write(send, len(data).to_bytes(8, "little") + data)

        tell(work(tell, *arguments), "done")
        code = 0
    except BaseException:  # its end must not be the parent's
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(code)


def _listen(receive, until, progress):
    """All messages until the child closes its end, and whether that took too long."""
    data, messages = b"", []
    while True:
        left = until - time.monotonic()
        if left <= 0 or not select.select([receive], [], [], left)[0]:
            return messages, True
        more = os.read(receive, 1 << 16)
        if not more:
            return messages, False
        data += more
        while len(data) >= 8 and len(data) >= 8 + int.from_bytes(data[:8], "little"):
            size = int.from_bytes(data[:8], "little")
            messages.append(pickle.loads(data[8 : 8 + size]))
            data = data[8 + size :]
            if progress and messages[-1][0] == "told":
                progress(messages[-1][1])


def seeds(text):
    """The first and the last of "7", "3-9" or "3-", which goes on until it is stopped."""
    first, _, last = text.partition("-")
    return int(first), (int(last) if last else 2**62) if "-" in text else int(first)
