# SPDX-License-Identifier: BSD-3-Clause
"""A rank whose memory is used up, so that not even the message of it can be made, ends the job all the same. Needs
FailingNew.cxx to be preloaded; passes by what is written then (see CMakeLists.txt)."""

from paralleltools import LAST, RANK, RANKS, blocks_of, failing_new, main, update
import echotools


def test_no_memory_for_anything():
    echo = echotools.scan(blocks_of(echotools.town(3, 12), lambda i: i % RANKS == RANK), NumberOfThreads=1)
    if RANK == LAST:
        failing_new().failing_new_begin(-1, 256, 2**40, False, 0)
    update(echo)
    raise AssertionError("the ranks went on")


if __name__ == "__main__":
    main([test_no_memory_for_anything])
