#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Persistence without learning: a point is a bird's unless an echo lay there in the scans before.

    /usr/bin/python3 Examples/filter_bench/persistence.py --sets build/bench/sets --out build/bench/predictions

The score is the share of the eight scans before without an echo within 1.5 m, in the point's beam or in one beside it. NumPy is all
that it needs.
"""
import filters


def scores_of(home, number):
    for name, frame, before in filters.frames(home, number):
        yield name, [1.0 - filters.of_history(frame, before)[:, 1] if before else [1.0] * len(frame.range)]


def main(argv=None):
    options = filters.arguments(__doc__.split("\n\n")[0]).parse_args(argv)
    filters.predict(options.sets, options.out, ["persistence"], scores_of)


if __name__ == "__main__":
    main()
