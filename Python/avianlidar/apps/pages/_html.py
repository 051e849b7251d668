# SPDX-License-Identifier: BSD-3-Clause
"""Pages of HTML that need no internet."""
from __future__ import annotations

import pathlib
from typing import Any, Dict, List, NamedTuple

MOST_WORDS = 25  # of the sentence on a first page


class Number(NamedTuple):
    """A number of a first page, with its name, and with its meaning and error in words."""

    value: str
    name: str
    words: str


class First(NamedTuple):
    """The first page. A step has a head, words and a command, which may be empty."""

    question: str
    sentence: str
    picture: Dict[str, Any]
    numbers: List[Number]
    steps: List[Dict[str, str]]
    assumed: List[str]
    interactive: str = ""  # address of a page in three dimensions


def short_enough(*sentences: str) -> str:
    """The first sentence that has at most MOST_WORDS words, else the last, cut."""
    found = next((one for one in sentences if len(one.split()) <= MOST_WORDS), None)
    return found or " ".join([*sentences[-1].split()[:MOST_WORDS - 1], "…"])


def render(template: str, **values: Any) -> bytes:
    """A page of HTML. @param template file with its package @param values by name"""
    import jinja2
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(pathlib.Path(__file__).parents[1]), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    return environment.get_template(template).render(**values).encode()
