# SPDX-License-Identifier: BSD-3-Clause
"""Files made wrong: bytes, words, numbers and lines; and values of a JSON document. Each mutation draws what it does
from r."""

import copy
import re
import struct

EXTREMES = [str(x).encode() for x in (0, -1, 1, 2**31, -(2**31), 2**32 - 1, 2**63, 2**64 - 1, 10**15, 65536, 255, 1e30,
                                      1e154, 1e308, "1e309", 5e-324, "nan", "inf", 0.5, "", "1.5.5", "0x10", "x",
                                      "9" * 400)]
PATTERNS = [struct.pack(kind, x) for kind, values in (("<I", (0, 2**31 - 1, 2**31, 2**32 - 1, 10**8)),
                                                      ("<Q", (2**63, 2**64 - 1, 2**60)),
                                                      ("<f", (float("nan"), -3e38)), ("<d", (float("inf"), 5e-324)))
            for x in values]
ODD = [None, True, 0, -1, 0.5, 100.0001, 1e-300, 1e18, -1e308, 2**31, 2**63, "", "x", "12", "a\0b", "../..", "\ud800",
       "none.json", "town.geojson", "runway", [], {}, [None], [1], [[]], ["x"], [0, 0, 0], [4, 3, 2, 1],
       [[0, 0], [1, 1]], {"a": 1}, {"preset": "VLP-16"}, {"preset": 5}]


def _part(data, r):
    begin = r.randrange(len(data) + 1)
    return begin, min(len(data), begin + r.choice((1, 2, 4, 8, 16, 64, 256, 4096)))


def flip(data, r):
    data = bytearray(data)
    for _ in range(r.choice((1, 1, 1, 2, 8, 64)) if data else 0):
        data[r.randrange(len(data))] ^= 1 << r.randrange(8)
    return bytes(data)


def cut(data, r):
    return data[: r.randrange(len(data) + 1)]


def repeat(data, r):
    """A part is removed, or there twice or a thousand times."""
    begin, end = _part(data, r)
    return data[:begin] + data[begin:end] * r.choice((0, 0, 2, 2, 10, 1000)) + data[end:]


def put(data, r):
    """Another part of the file, or other bytes, in the place of some or between them."""
    begin, end = _part(data, r)
    new = r.choice((data[begin:end], r.choice(PATTERNS), r.choice(PATTERNS), r.randbytes(r.choice((1, 4, 100))),
                    b"\xe9", b'"', b"[" * 100))
    to = r.randrange(len(data) + 1)
    return data[:to] + new + data[to + len(new) * r.randint(0, 1) :]


def number(data, r):
    for _ in range(r.choice((1, 1, 1, 2, 3))):
        found = list(re.finditer(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?", data))
        if found:
            one = r.choice(found)
            data = data[: one.start()] + r.choice(EXTREMES) + data[one.end() :]
    return data


def mutated(data, r):
    for _ in range(r.choice((1, 1, 1, 2, 3, 5))):
        data = r.choice((flip, flip, cut, repeat, repeat, put, put, put, number, number, number))(data, r)
    return data[: 1 << 20]


def _nodes(value):
    """(what holds it, its key) of all values below."""
    inside = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in list(inside):
        yield value, key
        yield from _nodes(part)


def changed(document, r):
    """A copy in which some values are others, missing, repeated, scaled, or from elsewhere."""
    document = copy.deepcopy(document)
    for _ in range(r.choice((1, 1, 1, 2, 3))):
        everywhere = list(_nodes(document)) or [([None], 0)]
        (holder, key), (other, place), kind = r.choice(everywhere), r.choice(everywhere), r.randrange(8)
        new = copy.deepcopy(r.choice(ODD) if kind else other[place])
        if kind == 1:
            del holder[key]
        elif kind == 2 and isinstance(holder, list):
            holder += [copy.deepcopy(holder[key])] * r.choice((1, 2, 100))
        elif kind == 2:
            holder[str(place)] = new
        elif kind == 3 and isinstance(holder[key], (int, float)):
            holder[key] *= r.choice((-1, 0, 1e-3, 1e3, 1e9, 1.0000001))
        else:
            holder[key] = new
    return document
