# SPDX-License-Identifier: BSD-3-Clause
"""Files made wrong: each mutation draws what it does from its own numbers."""

import random
import re
import struct

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_]{3,}")
EXTREMES = [b"0", b"-0", b"-1", b"1", b"2147483647", b"2147483648", b"-2147483648", b"4294967295", b"4294967296",
            b"9223372036854775807", b"9223372036854775808", b"-9223372036854775808", b"18446744073709551615", b"99999999",
            b"1000000000000000", b"1152921504606846976", b"65535", b"65536", b"255", b"256", b"1e30", b"1e31", b"1e154",
            b"1e308", b"1e309", b"-1e308", b"5e-324", b"nan", b"inf", b"-inf", b"0.5", b"", b"1.5.5", b"0x10", b"x",
            b"9" * 400, b"0." + b"9" * 400]
PATTERNS = [struct.pack("<I", n) for n in (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x10000, 0xFFFF, 100000000)]
PATTERNS += [struct.pack("<Q", n) for n in (2**63 - 1, 2**63, 2**64 - 1, 2**60, 10**15)]
PATTERNS += [struct.pack("<f", x) for x in (float("nan"), float("inf"), -3e38, 1e-45)]
PATTERNS += [struct.pack("<d", x) for x in (float("nan"), float("inf"), -1e308, 5e-324)]


def _flip(data, r):
    data = bytearray(data)
    for _ in range(r.choice((1, 1, 1, 2, 8, 64)) if data else 0):
        data[r.randrange(len(data))] ^= 1 << r.randrange(8)
    return bytes(data)


def _cut(data, r):
    return data[: r.randrange(len(data) + 1)]


def _part(data, r):
    begin = r.randrange(len(data) + 1)
    return begin, min(len(data), begin + r.choice((1, 2, 4, 8, 16, 64, 256, 4096)))


def _remove(data, r):
    begin, end = _part(data, r)
    return data[:begin] + data[end:]


def _duplicate(data, r):
    begin, end = _part(data, r)
    times = r.choice((1, 1, 2, 10, 1000))
    return data[:end] + data[begin:end] * times + data[end:]


def _splice(data, r):
    begin, end = _part(data, r)
    to = r.randrange(len(data) + 1)
    return data[:to] + data[begin:end] + data[to + (end - begin) * r.randint(0, 1) :]


def _bytes(data, r):
    to = r.randrange(len(data) + 1)
    size = r.choice((1, 2, 4, 100))
    new = r.choice((bytes(r.randrange(256) for _ in range(size)), b"\0" * size, b"\xe9", b"\n", b'"', b"[" * size, b"{\"a\":" * size))
    return data[:to] + new + data[to + len(new) * r.randint(0, 1) :]


def _number(data, r):
    found = list(NUMBER.finditer(data))
    for _ in range(r.choice((1, 1, 1, 2, 3))):
        if found:
            one = r.choice(found)
            data = data[: one.start()] + r.choice(EXTREMES) + data[one.end() :]
            found = list(NUMBER.finditer(data))
    return data


def _binary_number(data, r):
    new = r.choice(PATTERNS)
    to = r.randrange(0, max(1, len(data)), r.choice((1, 2, 4)))
    return data[:to] + new + data[to + len(new) :]


def _swap_words(data, r):
    found = [one for one in WORD.finditer(data)]
    if len(found) < 2:
        return data
    a, b = sorted(r.sample(found, 2), key=lambda one: one.start())
    return data[: a.start()] + b.group() + data[a.end() : b.start()] + a.group() + data[b.end() :]


def _lines(data, r):
    lines = data.split(b"\n")
    i, j = r.randrange(len(lines)), r.randrange(len(lines))
    lines[i], lines[j] = lines[j], lines[i] if r.random() < 0.5 else lines[j]
    return b"\n".join(lines)


MUTATIONS = (_flip, _flip, _cut, _remove, _duplicate, _splice, _bytes, _number, _number, _number, _binary_number,
             _binary_number, _swap_words, _lines)


def drawn(r):
    """Some mutations: (which, its own seed)."""
    return [(r.randrange(len(MUTATIONS)), r.randrange(2**32)) for _ in range(r.choice((1, 1, 1, 2, 3, 5)))]


def applied(data, mutations):
    for which, seed in mutations:
        data = MUTATIONS[which](data, random.Random(seed))
    return data[: 1 << 20]
