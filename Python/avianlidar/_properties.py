# SPDX-License-Identifier: BSD-3-Clause
"""Properties of wrapped classes by name: `RaysPerBeam` of the C++ class is `rays_per_beam` in Python, as in newer VTK."""
from __future__ import annotations

import difflib
import functools
import re
import textwrap
from typing import Any, Callable, Dict, Mapping, Optional, TypeVar

from ._pipeline import text_of

F = TypeVar("F", bound=Callable[..., Any])


# Caches results by class. mypy does not accept a class as hashable here.
_once: Callable[[F], F] = functools.lru_cache(maxsize=None)  # type: ignore[assignment]


def snake(name: str) -> str:
    """`RaysPerBeam` -> `rays_per_beam`, `UTMZone` -> `utm_zone`."""
    name = re.sub(r"([A-Z]+)([A-Z][a-z])", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def _own_methods(wrapped: type) -> Dict[str, Any]:
    """Methods of this project's classes among the bases, without the methods of VTK's classes."""
    methods: Dict[str, Any] = {}
    for base in wrapped.__mro__:
        if base.__name__.startswith("vtkAvianLidar"):
            methods = {**vars(base), **methods}
    return methods


@_once
def property_names(wrapped: type) -> Mapping[str, str]:
    """{`rays_per_beam`: `RaysPerBeam`} for a wrapped class, in alphabetical order."""
    methods = _own_methods(wrapped)
    found = [m[3:] for m in methods if m.startswith("Set") and "Get" + m[3:] in methods]
    # A table is set as a whole.
    tables = {"ChannelElevation", "NumberOfChannelElevations"}
    # In Python an error is an exception; error data are for ParaView.
    names = {snake(name): name for name in sorted(found) if name not in (*tables, "ErrorsAsData")}
    if tables <= set(found):
        names["channel_elevations"] = "ChannelElevations"
    return names


@_once  # without the cache, each reading of a choice would make an object for each value
def choices(wrapped: type, name: str) -> Mapping[str, Any]:
    """{`RangeUnits`: 4} for a property that is a choice (`SetReturnModeToRangeUnits()`), else empty. A method that sets
    several properties (`SetPresetToAirport16()` of the beam source) has the value None."""
    start = f"Set{name}To"
    found = [method[len(start):] for method in _own_methods(wrapped) if method.startswith(start)]
    values: Dict[str, Any] = {}
    for choice in found:
        probe = wrapped()
        getattr(probe, start + choice)()
        values[choice] = getattr(probe, "Get" + name)() if hasattr(probe, "Get" + name) else None
    return dict(sorted(values.items(), key=lambda item: (item[1] is not None, item[1] or 0, item[0])))


# Names of properties that users expect but that follow from other properties.
FOLLOWS = {"maximum_elevation": "it follows from minimum_elevation + (number_of_channels - 1) * elevation_step: set these properties"}


def unknown(what: str, name: str, known) -> str:
    """Message about an unknown name: the nearest known name, or all known names."""
    name, known = str(name), list(known)  # NumPy's texts would show their type
    if snake(name) in FOLLOWS and "elevation_step" in known:
        return f"{what} {name!r} is not known; {FOLLOWS[snake(name)]}"
    near = difflib.get_close_matches(snake(name), [snake(k) for k in known], n=1)
    if near:
        hint = f"did you mean {next(k for k in known if snake(k) == near[0])!r}?"
    else:
        hint = f"expected one of {', '.join(known)}"
    return f"{what} {name!r} is not known; {hint}"


def choose(wrapped: type, name: str, value: str) -> str:
    """The choice of a property for a word. Case, blanks, `_` and `-` do not matter."""
    known = choices(wrapped, name)
    for choice in known:
        if re.sub(r"[\s_\-]", "", value).lower() == choice.replace("_", "").lower():
            return choice
    raise ValueError(unknown(snake(name), value, known))


def resolve(wrapped: type, name: str, owner: str) -> str:
    """The C++ name of a property given in C++ or snake case. TypeError names the nearest property."""
    names = property_names(wrapped)
    if name in names:
        return names[name]
    if name in names.values():
        return name
    raise TypeError(unknown(f"{owner}: property", name, names))


def in_snake_case(wrapped: type, values: Dict[str, Any], owner: str) -> Dict[str, Any]:
    """Values of properties with names in snake case; names that are not properties are kept. TypeError if a property is given
    twice."""
    here = {name: key for key, name in property_names(wrapped).items()}
    found: Dict[str, Any] = {}
    for name, value in values.items():
        key = here.get(name, name)
        if key in found:
            raise TypeError(f"{owner}: {key} is given twice, also as {next(k for k, n in here.items() if n == key)}")
        found[key] = value
    return found


def documentation(wrapped: type, name: str) -> str:
    """The description of a property in the C++ class: meaning, unit, default, range."""
    method = getattr(wrapped, "Set" + (name if name != "ChannelElevations" else "NumberOfChannelElevations"))
    paragraphs = [textwrap.fill(" ".join(p.split()), 110) for p in (method.__doc__ or "").split("\n\n")]
    words = [p for p in paragraphs if p and not re.match(r"Set\w+\(|C\+\+:", p)]
    known = choices(wrapped, name)
    return "\n\n".join(words[:1] + ([f"One of {', '.join(known)}."] if known else []) + words[1:])


def get_property(algorithm, name: str) -> Any:
    """The value of a property with its C++ name; the value of a choice is a word."""
    if name == "ChannelElevations":
        return tuple(algorithm.GetChannelElevation(i) for i in range(algorithm.GetNumberOfChannelElevations()))
    value = getattr(algorithm, "Get" + name)()
    words = [word for word, number in choices(type(algorithm), name).items() if number == value]
    return words[0] if words else value


def _kind(value) -> str:
    if isinstance(value, tuple):
        return f"{len(value)} numbers"
    return "an integer" if isinstance(value, int) else "a number" if isinstance(value, float) else "a text"


def set_property(algorithm, name: str, value: Any) -> None:
    """Sets a property with its C++ name to a value or to the word of a choice."""
    if hasattr(value, "tolist"):
        value = value.tolist()  # a NumPy scalar or array
    if name == "ChannelElevations":
        if not hasattr(value, "__len__") or isinstance(value, str):
            raise TypeError(f"channel_elevations are {value!r}, expected a list of numbers in degrees")
        for table in (type(algorithm)(), algorithm):  # wrong values are refused by the new object, before the algorithm changes
            table.SetNumberOfChannelElevations(len(value))
            for i, elevation in enumerate(value):
                table.SetChannelElevation(i, elevation)
    elif isinstance(getattr(algorithm, "Get" + name)(), bool):
        if value not in (False, True):  # 0 and 1 are accepted; VTK would accept anything, and read "off" as on
            raise TypeError(f"{snake(name)} is {value!r}, expected True or False")
        getattr(algorithm, "Set" + name)(bool(value))
    elif isinstance(value, str) and choices(type(algorithm), name):
        getattr(algorithm, f"Set{name}To{choose(type(algorithm), name, value)}")()
    else:
        try:
            getattr(algorithm, "Set" + name)(text_of(value) if isinstance(value, str) else value)
        except TypeError:
            raise TypeError(f"{snake(name)} is {value!r}, expected {_kind(getattr(algorithm, 'Get' + name)())}") from None


def set_properties(algorithm, owner: Optional[str] = None, **values: Any) -> None:
    """Sets properties by name. No property is set if one of the names is unknown."""
    owner = owner or algorithm.GetClassName()
    resolved = {resolve(type(algorithm), name, owner): value for name, value in values.items()}
    for name, value in resolved.items():
        set_property(algorithm, name, value)


class PropertyOwner:
    """Base of classes with a wrapped algorithm whose properties are attributes (see `wraps`)."""

    algorithm: Any

    def __getattr__(self, name: str) -> Any:  # called for names that were not found elsewhere
        if name.startswith("_") or name == "algorithm":
            raise AttributeError(name)
        if hasattr(type(self), name):  # a property whose getter failed: its own error is raised again
            return object.__getattribute__(self, name)
        raise AttributeError(unknown(f"{type(self).__name__}: property", name, property_names(type(self.algorithm))))

    def __setattr__(self, name: str, value: Any) -> None:
        if not hasattr(type(self), name) and name not in self.__annotations__ and not name.startswith("_"):
            self.__getattr__(name)
        object.__setattr__(self, name, value)

    def set(self, **properties: Any):
        """Sets several properties by name (`rays_per_beam` or `RaysPerBeam`), each in the unit that `help()` of the class
        gives. An unknown name is a TypeError that names the nearest property. Returns self."""
        set_properties(self.algorithm, type(self).__name__, **properties)
        return self

    def properties(self) -> Dict[str, Any]:
        """All properties by name, each in its unit."""
        names = property_names(type(self.algorithm))
        return {key: get_property(self.algorithm, name) for key, name in names.items()}


def wraps(wrapped: type):
    """Class decorator that makes the properties of a wrapped class attributes, with the descriptions of the wrapped class."""

    def decorate(cls):
        for key, name in property_names(wrapped).items():
            def getter(self, name=name):
                return get_property(self.algorithm, name)

            def setter(self, value, name=name):
                set_property(self.algorithm, name, value)

            setattr(cls, key, property(getter, setter, doc=documentation(wrapped, name)))
        return cls

    return decorate
