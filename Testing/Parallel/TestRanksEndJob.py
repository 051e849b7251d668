# SPDX-License-Identifier: BSD-3-Clause
"""A rank that has no memory for what another one sends ends the job, with its message, rather than keep the others
waiting. Needs FailingNew.cxx to be preloaded; passes by the message (see CMakeLists.txt)."""

from paralleltools import LAST, RANK, failing_new, main, update
import echotools


def test_no_memory_for_a_message():
    echo = echotools.scan(echotools.town(3, 12), NumberOfThreads=1)
    if RANK == LAST:
        echo.SetInputData(1, echotools.box((50, 0, 0), (5, 5, 5), "Metal"))
        failing_new().failing_new_begin(1, 2000, 2**40, True)  # bytes: VTK's text of a box is longer
    update(echo)
    raise AssertionError("the ranks went on")


if __name__ == "__main__":
    main([test_no_memory_for_a_message])
