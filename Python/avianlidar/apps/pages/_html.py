# SPDX-License-Identifier: BSD-3-Clause
"""Pages of HTML that need no internet."""
from __future__ import annotations

import base64
import math
import pathlib
from typing import Any


def embedded(file: pathlib.Path) -> str:
    """A picture (PNG) as a source in a page."""
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


def render(template: str, **values: Any) -> bytes:
    """A page of HTML. @param template file with its package @param values by name; filters begin with `filter_`"""
    import jinja2
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(pathlib.Path(__file__).parents[1]), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.globals["zip"] = zip
    environment.filters["number"] = lambda value, form: "–" if math.isnan(value) else form % value
    for name in list(values):
        if name.startswith("filter_"):
            environment.filters[name.removeprefix("filter_")] = values.pop(name)
    return environment.get_template(template).render(**values).encode()
