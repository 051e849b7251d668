# SPDX-License-Identifier: BSD-3-Clause
"""Properties of wrapped classes by name: `RaysPerBeam` in C++ is `rays_per_beam` in Python, as in newer VTK."""
import difflib
import functools
import re
import textwrap
from collections.abc import Mapping
from typing import Any

from ._pipeline import text_of

_once: Any = functools.cache  # mypy does not accept a class as a hashable argument of functools.cache

# Numbers of the pattern, with the numbers by which a sensor file may give them instead
PATTERN = {"number_of_channels": ("channel_elevations",),
           "minimum_elevation": ("channel_elevations", "prism_wedge_angles"),
           "elevation_step": ("channel_elevations", "prism_wedge_angles"), "azimuth_step": ("prism_wedge_angles",)}
# Other numbers that every answer depends on
DECISIVE = {"rotation_rate": (), "firing_interval": ("channel_firing_times",), "wavelength": ("frequency",),
            "half_beamwidth": (), "pulse_energy": (), "pulse_width": (), "sampling_interval": (), "range_gate": ()}


def snake(name: str) -> str:
    """`RaysPerBeam` -> `rays_per_beam`, `UTMZone` -> `utm_zone`."""
    name = re.sub(r"([A-Z]+)([A-Z][a-z])", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def _own_methods(wrapped: type) -> dict[str, Any]:
    """Methods of this project's classes among the bases, without the methods of VTK's classes."""
    methods: dict[str, Any] = {}
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
    values: dict[str, Any] = {}
    for choice in found:
        probe = wrapped()
        getattr(probe, start + choice)()
        values[choice] = getattr(probe, "Get" + name)() if hasattr(probe, "Get" + name) else None
    return dict(sorted(values.items(), key=lambda item: (item[1] is not None, item[1] or 0, item[0])))


def unknown(what: str, name: str, known) -> str:
    """Message about an unknown name: the nearest known name, or all known names."""
    name, known = str(name), list(known)  # NumPy's texts would show their type
    spellings = {snake(k): k for k in reversed(known)}
    near = difflib.get_close_matches(snake(name), spellings, n=1)
    hint = f"did you mean {spellings[near[0]]!r}?" if near else f"expected one of {', '.join(known)}"
    if snake(name) == "maximum_elevation" and "elevation_step" in known:
        hint = "it follows from minimum_elevation + (number_of_channels - 1) * elevation_step: set these properties"
    return f"{what} {name!r} is not known; {hint}"


def choose(wrapped: type, name: str, value: str) -> str:
    """The choice of a property for a word. Case, blanks, `_` and `-` do not matter."""
    known = {choice.replace("_", "").lower(): choice for choice in choices(wrapped, name)}
    word = re.sub(r"[\s_\-]", "", value).lower()
    if word not in known:
        raise ValueError(unknown(snake(name), value, known.values()))
    return known[word]


def in_snake_case(wrapped: type, values: dict[str, Any], owner: str) -> dict[str, Any]:
    """Values by names in snake case; other names than of properties are kept. TypeError for a property given twice."""
    here = {name: key for key, name in property_names(wrapped).items()}
    found: dict[str, Any] = {}
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
        for table in (type(algorithm)(), algorithm):  # the new object refuses wrong values before the algorithm changes
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
            kind = _kind(getattr(algorithm, "Get" + name)())
            raise TypeError(f"{snake(name)} is {value!r}, expected {kind}") from None


def set_properties(algorithm, owner: str | None = None, **values: Any) -> None:
    """Sets properties by their names in C++ or in snake case. No property is set if one of the names is unknown."""
    names = property_names(type(algorithm))
    for name in values:
        if name not in names and name not in names.values():
            raise TypeError(unknown(f"{owner or algorithm.GetClassName()}: property", name, names))
    for name, value in values.items():
        set_property(algorithm, names.get(name, name), value)


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
        """Sets several properties by name (`rays_per_beam` or `RaysPerBeam`), each in the unit that `help()` of the
        class gives. An unknown name is a TypeError that names the nearest property. Returns self."""
        set_properties(self.algorithm, type(self).__name__, **properties)
        return self

    def properties(self) -> dict[str, Any]:
        """All properties by name, each in its unit."""
        names = property_names(type(self.algorithm))
        return {key: get_property(self.algorithm, name) for key, name in names.items()}


def wraps(wrapped: type):
    """Class decorator that makes the properties of a wrapped class attributes, with the descriptions of that class."""

    def decorate(cls):
        for key, name in property_names(wrapped).items():
            setattr(cls, key, property(lambda self, name=name: get_property(self.algorithm, name),
                                       lambda self, value, name=name: set_property(self.algorithm, name, value),
                                       doc=documentation(wrapped, name)))
        return cls

    return decorate
