# SPDX-License-Identifier: BSD-3-Clause
"""Lists and plurals in sentences."""
from __future__ import annotations

import re
from typing import Sequence

IRREGULAR = {"goose": "geese", "grouse": "grouse", "titmouse": "titmice"}  # plurals of birds, by the end of a name


def listed(words: Sequence[str]) -> str:
    """a, b and c."""
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))


def counted(number: int, noun: str) -> str:
    """A number and a noun, as in "1 track" and "2 tracks"."""
    return f"{number} {noun if number == 1 else plural(noun)}"


def plural(species: str) -> str:
    """Several birds of a species, as in "Canada geese"; "targets" without a species."""
    species = species or "target"
    for one, several in IRREGULAR.items():
        if species.lower().endswith(one):
            return species[:-len(one)] + several
    if re.search("[^aeiou]y$", species):
        return f"{species[:-1]}ies"
    return f"{species}{'es' if re.search('(s|x|z|ch|sh)$', species) else 's'}"
