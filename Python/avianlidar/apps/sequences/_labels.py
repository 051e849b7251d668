# SPDX-License-Identifier: BSD-3-Clause
"""Classes of labelled sequences, and the configuration for programs that read SemanticKITTI."""
from __future__ import annotations

from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Tuple

import numpy as np

from ..._pipeline import Error
from ..inputs._json import packaged

BIRD = 99  # default label of birds
FIRST_OBJECT, FIRST_BIRD, LAST_ID = 1000, 10000, 65534  # ids of movers; labels hold id + 1 in 16 bits
# Classes of objects at rest, and the class of the same objects in motion.
MOVING = {10: 252, 18: 258, 20: 259}


class Class(NamedTuple):
    """A class of the labels."""
    name: str                      # name in SemanticKITTI
    here: str                      # meaning in a sequence
    color: Tuple[int, ...]         # blue, green, red


# Every class of a sequence, by its id in SemanticKITTI (Documentation/reference/formats.md).
# Classes to be found come first.
CLASSES = {int(label): Class(name, here, tuple(color))
           for label, (name, here, color) in packaged("sequences/classes.json").items()}


def classes_of(bird: int) -> Dict[int, Class]:
    """The classes if birds have the label `bird`, in the order of their learned numbers."""
    if bird != BIRD and bird in CLASSES and bird not in MOVING.values():
        raise Error(f"bird_class is {bird}, expected no label of a static class ({CLASSES[bird].name}), but 99, the "
                    "label of a moving class, or an unused label")
    classes = {0: CLASSES[0], bird: CLASSES.get(bird, CLASSES[BIRD])}
    if bird in MOVING.values():
        classes[bird] = classes[bird]._replace(here=f"birds, {classes[bird].here}")
    return {**classes, **{label: one for label, one in CLASSES.items() if label not in (0, BIRD, bird)}}


def relabel(labels: np.ndarray, bird: int) -> np.ndarray:
    """Labels of the KITTI writer with the class of birds, and with moving classes for moving objects."""
    classes, objects = labels & 0xffff, (labels >> 16).astype(np.int64) - 1
    under_way = (objects >= FIRST_OBJECT) & (objects < FIRST_BIRD)
    changed = classes.copy()
    for still, moving in MOVING.items():
        changed[under_way & (classes == still)] = moving
    changed[classes == BIRD] = bird
    return (labels & 0xffff0000) | changed


def configuration(bird: int, points: Mapping[int, int], sequences: Iterable[int]) -> str:
    """The configuration (YAML) with which SemanticKITTI's programs read, train on and score sequences.

    bird       label of birds
    points     number of points of each label
    sequences  numbers of the sequences
    """
    classes, total, numbers = classes_of(bird), max(sum(points.values()), 1), list(sequences)
    learned = {label: number for number, label in enumerate(classes)}  # each class is separate; 0 is not learned
    lines = ["# Labels of avian-lidar for programs that read SemanticKITTI's configuration: "
             "birds count as a class, and moving objects",
             "# have separate classes. Only 0 is left out of loss and score.", 'name: "avian-lidar"']
    known = sorted(classes.items())
    parts: Tuple[Tuple[str, List[Tuple[Any, Any]]], ...] = (
        ("labels", [(label, f'"{one.name}"  # {one.here}') for label, one in known]),
        ("color_map:  # blue, green, red", [(label, list(one.color)) for label, one in known]),
        ("content:  # share of all points", [(label, f"{points.get(label, 0) / total:.9f}") for label, _ in known]),
        ("learning_map", sorted(learned.items())),
        ("learning_map_inv", [(number, label) for label, number in learned.items()]),
        ("learning_ignore", [(number, number == 0) for number in learned.values()]),
        # Three of five sequences train, one validates and one tests. More sequences change no role.
        ("split:  # numbers of sequences", [
            (role, [number for number in numbers if number % 5 in rests])
            for role, rests in (("train", (0, 3, 4)), ("valid", (1,)), ("test", (2,)))]))
    for name, entries in parts:
        lines += [name if ":" in name else f"{name}:", *(f"  {key}: {value}" for key, value in entries)]
    return "\n".join(lines) + "\n"
