# SPDX-License-Identifier: BSD-3-Clause
"""Siting of lidars at an airport: runways and places around runways, candidates, the coverage of each candidate, and
the best site or network of sites.

>>> from avianlidar import siting
>>> runway = siting.Runway("18L/36R", (0.0, 1700.0), (0.0, -1700.0), 57.6)
>>> points, regions = siting.strips_and_approaches([runway], 1000)
>>> points.shape, sorted(regions), len(regions["approaches"])
((1000, 3), ['approaches', 'strips'], 500)
"""
from .apps.coverage._looks import SAME_BIRDS, look, require_memory, value_of_same_birds
from .apps.coverage._networks import (Network, exchange, exhaustive, greedy, rank_correlation, search, value_of,
                                      values_of, weights_of)
from .apps.places._candidates import MOST_CANDIDATES, SAME_PLACE, candidates, ground_of, is_near, lattice
from .apps.places._geojson import read_outlines, read_runways, to_enu, to_geodetic, with_other_heights, write_sites
from .apps.places._regions import (APPROACH_HALF_WIDTH, APPROACH_HEIGHT, APPROACH_LENGTH, APPROACH_LOWEST,
                                   SPREADS, STRIP_HALF_WIDTH, STRIP_HEIGHTS, WINDS, Runway, by_kind, end_names,
                                   places_by_region, region_heights, region_names, region_outlines, rounded,
                                   runway_outline, strips_and_approaches, wind)

__all__ = [name for name in dir() if not name.startswith("_")]
