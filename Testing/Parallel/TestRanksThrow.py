# SPDX-License-Identifier: BSD-3-Clause
"""An exception on one rank between exchanges is an error on all, wherever it is thrown; the next execution is good."""

import ctypes
import os

from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

from paralleltools import LAST, exchange, main
import echotools

LIBRARY = ctypes.CDLL(os.environ["AVIANLIDAR_THROWING_RANK"])
LIBRARY.throwing_rank_filter.restype = ctypes.c_void_p
LIBRARY.throwing_rank_update.argtypes = (ctypes.c_int, ctypes.c_int, ctypes.c_bool)


def test_exceptions_are_errors_of_all():
    filter_ = vtkAlgorithm(f"Addr={LIBRARY.throwing_rank_filter():#x}")
    messages = echotools.Messages(filter_)
    assert LIBRARY.throwing_rank_update(-1, 0, False) == 1 and not messages.errors
    for who in {0, LAST}:
        for where in range(5):
            for anything, words in ((False, "A planted error"), (True, "An unknown exception was thrown")):
                messages.errors.clear()
                went = exchange(str(LIBRARY.throwing_rank_update(who, where, anything)))
                assert set(went) == {"0"}, (who, where, went)
                heard = exchange("\n".join(messages.errors))
                assert words in heard[who] and words in heard[0], (who, where, heard)
                assert who == 0 or f"Rank {who}: " in heard[0], (who, where, heard)
                messages.errors.clear()
                assert LIBRARY.throwing_rank_update(-1, 0, False) == 1 and not messages.errors, (who, where)


if __name__ == "__main__":
    main([test_exceptions_are_errors_of_all])
