# SPDX-License-Identifier: BSD-3-Clause
"""Pages of HTML that need no network, by templates of this package."""
from __future__ import annotations

import base64
import math
import pathlib
from typing import Any


def embedded(file: pathlib.Path) -> str:
    """A picture (PNG) as what a page has for its source."""
    return "data:image/png;base64," + base64.b64encode(file.read_bytes()).decode()


def render(template: str, **values: Any) -> bytes:
    """A page. @param template its file in this folder @param values by their names there; filters begin with `filter_`"""
    import jinja2
    environment = jinja2.Environment(loader=jinja2.FileSystemLoader(pathlib.Path(__file__).parent), autoescape=True,
                                     undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.globals["zip"] = zip
    environment.filters["number"] = lambda value, form: "–" if math.isnan(value) else form % value
    environment.filters.update({name[7:]: values.pop(name) for name in [*values] if name.startswith("filter_")})
    return environment.get_template(template).render(**values).encode()
