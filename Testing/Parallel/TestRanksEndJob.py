# SPDX-License-Identifier: BSD-3-Clause
"""A rank that has not even the memory to hear the others ends the job, with its message, rather than keep them waiting.
Needs FailingNew.cxx to be preloaded; passes by the message (see CMakeLists.txt)."""

from paralleltools import LAST, RANK, RANKS, blocks_of, failing_new, main, update
import echotools


def test_no_list_of_ranks():
    echo = echotools.scan(blocks_of(echotools.town(3, 12), lambda i: i % RANKS == RANK), NumberOfThreads=1)
    if RANK == LAST:
        size = 32 * RANKS  # bytes of a list of a std::string for each rank: that of the first agreement
        failing_new().failing_new_begin(1, size, size)
    update(echo)
    raise AssertionError("the ranks went on")


if __name__ == "__main__":
    main([test_no_list_of_ranks])
