# SPDX-License-Identifier: BSD-3-Clause
"""The look of pictures and pages: colours of classes and species, and units of energy (look.json). ParaView's macros
use the same file."""
import json
import pathlib
from collections.abc import Iterable

from . import vtkAvianLidar as _wrapped

_LOOK = json.loads(pathlib.Path(__file__).with_name("look.json").read_text(encoding="utf-8"))
# Colour of each class. Each pair of colours is at least 14 apart in CIELAB, and at least 7 for eyes without the cones of
# long or of middle wavelengths.
CLASSES: dict[str, str] = _LOOK["classes"]
GROUND: tuple[str, ...] = tuple(_LOOK["ground"])  # classes on the ground, from below
SPECIES: tuple[str, ...] = tuple(_LOOK["species"])  # by Okabe and Ito, and a brown: at least 17 apart in CIELAB for all eyes
UNKNOWN: str = _LOOK["unknown"]


def class_colour(word: str) -> str:
    """The colour of a class: land is light, and the class of an unknown solid counts as a building."""
    if word in GROUND[:2]:
        return _LOOK["land"]
    return {**CLASSES, **_LOOK["points"]}.get(word, CLASSES["building"] if word else UNKNOWN)


def scale_of(most: float) -> tuple[str, float]:
    """The unit in which an energy (J) is at least 1, else the smallest, and the number of these units in a joule."""
    units = _LOOK["units_of_energy"]
    return next(((unit, scale) for unit, scale in units.items() if most * scale >= 1), [*units.items()][-1])


def on_surfaces(colour: str) -> str:
    """A darker colour, for points on surfaces of this colour."""
    return "#" + "".join(f"{int(0.55 * int(colour[i:i + 2], 16)):02x}" for i in (1, 3, 5))


def species_colours(names: Iterable[str]) -> dict[str, str]:
    """The colour of each species, in the order of the built-in species, and of others in the order of their names."""
    known = _wrapped.vtkAvianLidarBirdSource().GetKnownSpecies().splitlines()
    order = [*known, *sorted({*names} - {*known})]
    return {name: SPECIES[number % len(SPECIES)] for number, name in enumerate(order)}
