# SPDX-License-Identifier: BSD-3-Clause
"""JSON files of the user, with errors that name the wrong part."""
from __future__ import annotations

import contextlib
import functools
import json
import math
import pathlib
from typing import Any, Dict, Iterator, List, Tuple

from ..._files import read_regular
from ..._pipeline import Error, words_of
from ..._properties import unknown

# kinds of files, by a key that other kinds do not have
KINDS = {"objects": "a scene", "number_of_scans": "a scenario", "siting": "a plan", "coverage": "a plan"}
SCHEMAS = {"coverage.schema.json": "a plan", "scenario.schema.json": "a scenario"}
MOST = 64 << 20  # bytes of compressed JSON after decompression; as Python objects they take 1 GB
LONGEST = 400  # characters of a schema's message, which may quote a whole list


def _finite(text: str) -> float:
    value = float(text)  # also refuses NaN and Infinity, which are not JSON
    if not math.isfinite(value):
        raise ValueError(f"{text[:40]} is not a finite number")
    return value


def _integer(text: str) -> int:
    _finite(text)  # refuses integers of more than 308 digits
    return int(text)


def _unique(pairs: List[Tuple[str, Any]]) -> Dict[str, Any]:
    names = [name for name, _ in pairs]
    if len({*names}) < len(names):
        raise ValueError(f"the key {max(names, key=names.count)!r} is there twice")
    return dict(pairs)


def load_json(file) -> Any:
    """The content of a JSON file, which may be compressed by gzip; `Error` names the problem. Numbers are finite."""
    try:
        return json.loads(read_regular(file, MOST), object_pairs_hook=_unique, parse_constant=_finite,
                          parse_float=_finite, parse_int=_integer)
    except RecursionError:
        raise Error(f"{file}: is not JSON that can be read: nested too deeply") from None
    except ValueError as error:
        raise Error(f"{file}: is not JSON ({error})") from None


@functools.lru_cache(maxsize=None)
def packaged(name: str) -> Any:
    """The content of a JSON file of the applications, such as `places/airport.json`."""
    return load_json(pathlib.Path(__file__).parents[1] / name)


def _words_of(wrong: Any) -> str:
    """The message of an error of a schema, with the nearest known word for a misspelt key or word."""
    if wrong.validator == "additionalProperties" and isinstance(wrong.validator_value, bool):
        known = wrong.schema["properties"]
        return unknown("", next(name for name in wrong.instance if name not in known), known).strip()
    if wrong.validator == "enum" and all(isinstance(one, str) for one in (wrong.instance, *wrong.validator_value)):
        return unknown("", wrong.instance, wrong.validator_value).strip()
    return str(wrong.message)


def check_json(document: Any, schema: str, what: str) -> None:
    """`Error` names the property that does not fit a schema of this package. @param what the document's name"""
    import jsonschema
    found = list(jsonschema.Draft202012Validator(packaged(f"inputs/{schema}")).iter_errors(document))
    # An unknown key may be a misspelt required key.
    wrong = next((one for one in found if one.validator == "additionalProperties" and not one.path),
                 jsonschema.exceptions.best_match(found))
    if wrong:
        words = _words_of(wrong)
        if len(words) > LONGEST:
            words = f"{words[:LONGEST // 2]} ... {words[-LONGEST // 2:]}"
        if wrong.validator == "not":
            words = "is not to be given here"
        if wrong.validator == "required" and not wrong.path:
            expected = SCHEMAS.get(schema, "another file")
            words += next((f": this is {kind}, expected {expected}" for key, kind in KINDS.items()
                           if key in document and expected != kind), "")
        raise Error(": ".join(filter(None, (what, wrong.json_path.removeprefix("$").removeprefix("."), words))))


@contextlib.contextmanager
def naming(what: str) -> Iterator[None]:
    """Turns an exception inside into an `Error` that begins with `what`: a file and its member, as in
    `my.coverage.json: siting.spacing`. @param what is also put before errors that name another file"""
    try:
        yield
    except (RuntimeError, OSError, ValueError, TypeError, LookupError, ArithmeticError, MemoryError) as error:
        raise Error(f"{what}: {words_of(error)}") from None
