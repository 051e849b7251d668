# SPDX-License-Identifier: BSD-3-Clause
"""The look of pictures and pages: colours of classes and species, and units of energy."""

# Colour of each class. Each pair of colours is at least 14 apart in CIELAB, and at least 7 for eyes without the cones of
# long or of middle wavelengths.
CLASSES = {"grass": "#cfe3b4", "water": "#a9cfe8", "parking": "#c4c4cc", "road": "#909090", "apron": "#e4dccd",
           "taxiway": "#6b6b6b", "runway": "#3a3a3a", "vegetation": "#80b77c", "tree": "#2f6b3a",
           "terminal": "#db9c95", "hangar": "#b39ad0", "tower": "#f0a860", "mast": "#e3c94a", "pole": "#da78ba",
           "fence": "#101010", "structure": "#a08d74", "building": "#d2b594", "house": "#a8705a"}
GROUND = ("terrain", "ground", "grass", "water", "parking", "road", "apron", "taxiway", "runway")  # from below
LAND, BIRD, UNKNOWN = "#dfe6cf", "#e7298a", "#bbbbbb"
# ColorBrewer's Dark2, which differs from surfaces and from most echoes
SPECIES = ("#1b9e77", "#d95f02", "#7570b3", "#e7298a", "#66a61e", "#e6ab02", "#a6761d", "#666666")
SCALES = {"J": 1.0, "mJ": 1e3, "\u00b5J": 1e6, "nJ": 1e9, "pJ": 1e12, "fJ": 1e15}


def class_colour(word: str) -> str:
    """The colour of a class; land is light, and everything unknown is a building."""
    return LAND if word in ("terrain", "ground") else CLASSES.get(word, CLASSES["building"] if word else UNKNOWN)


def scale_of(most: float) -> tuple[str, float]:
    """The unit in which an energy (J) is at least 1, and the number of these units in a joule."""
    return next(((unit, scale) for unit, scale in SCALES.items() if most * scale >= 1), ("J", 1.0))
