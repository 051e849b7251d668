// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BirdViews.h
 * @brief What a bird in flight shows from all sides: silhouettes by heading, wing phase and
 * elevation of the line of sight.
 *
 * Poses are BirdHeadings headings, evenly over a whole turn, for each of some wing phases, evenly
 * over the beat; phase by phase they are shifted, so that all of them have different headings. A
 * heading counts from the line of sight, clockwise from above.
 *
 * Source: none.
 * Differs: no bank, no pitch.
 * Valid: see Silhouette.h; seen from afar. The mean of probabilities over these poses lies within
 * 0.02 of that over all.
 * Test: TestBirdViews.cxx.
 */
#ifndef avianlidar_BirdViews_h
#define avianlidar_BirdViews_h

#include "Bird.h"
#include "DetectionLaw.h"

#include <cstddef>

namespace avianlidar
{
constexpr std::size_t BirdHeadings = 16; ///< of a flapping bird
constexpr std::size_t BirdPhases = 5;
constexpr std::size_t GlidingHeadings = BirdHeadings * BirdPhases;

/// Views of a bird. @param meanArea to which areas are relative, m^2
TargetViews birdViews(const BirdShape& shape, bool gliding, double meanArea);

/// Mean effective area, m^2, of a bird in flight, seen from the side at 3 degrees of elevation:
/// heading and wing phase uniform. NaN if one of its lengths is not known.
double meanEffectiveArea(const BirdShape& shape, bool gliding);
}

#endif
