# SPDX-License-Identifier: BSD-3-Clause
"""JSON files of the user's, with errors that name what is wrong."""
from __future__ import annotations

import json
import pathlib
from typing import Any

from ._disk import read_regular
from ._pipeline import Error


def load_json(file) -> Any:
    """What a file holds, also compressed by gzip; `Error` says what is wrong with it."""
    try:
        return json.loads(read_regular(file))
    except ValueError as error:
        raise Error(f"{file}: is no JSON ({error})") from None


def check_json(document: Any, schema: str, what: str) -> None:
    """`Error` names the property that does not fit. @param schema a file of this package @param what the document's name"""
    import jsonschema
    rules = load_json(pathlib.Path(__file__).with_name(schema))
    wrong = jsonschema.exceptions.best_match(jsonschema.Draft202012Validator(rules).iter_errors(document))
    if wrong:
        raise Error(f"{what}: {wrong.json_path.removeprefix('$.')}: {wrong.message}")
