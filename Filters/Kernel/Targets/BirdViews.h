// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BirdViews.h
 * @brief Silhouettes of a flying bird, by heading, wing phase and elevation of the line of sight.
 *
 * Each wing phase has BirdHeadings headings, evenly spaced over a turn. The phases are evenly
 * spaced over a wingbeat. Headings are shifted from phase to phase, so that all poses differ in
 * heading. A heading counts from the line of sight, clockwise as seen from above.
 *
 * Source: none.
 * Differs: the bird has no bank and no pitch.
 * Valid: as in Silhouette.h, for a bird that is seen from afar. The mean of detection probabilities
 * over these poses lies within 0.02 of the mean over all poses.
 * Test: TestBirdViews.cxx.
 */
#ifndef avianlidar_BirdViews_h
#define avianlidar_BirdViews_h

#include "Bird.h"
#include "DetectionLaw.h"

#include <cstddef>

namespace avianlidar
{
constexpr std::size_t BirdHeadings = 16; ///< number of headings of a flapping bird
constexpr std::size_t BirdPhases = 5;
constexpr std::size_t GlidingHeadings =
  BirdHeadings * BirdPhases; ///< number of headings of a gliding bird, which has one phase

/// Views of a bird. @param meanArea area that serves as the unit of areas, m^2
TargetViews birdViews(const BirdShape& shape, bool gliding, double meanArea);

/// Mean effective area of a bird in flight over all headings and wing phases, m^2, seen at an
/// elevation of 3 degrees. NaN if a length of the shape is NaN.
double meanEffectiveArea(const BirdShape& shape, bool gliding);
}

#endif
