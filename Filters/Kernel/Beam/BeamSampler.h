// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSampler.h
 * @brief Strata of the beam, patterns of rays, and the estimator of the standard error, made once
 * for a number of rays.
 *
 * Drawing stratified rays takes longer than tracing them. So beams of up to MostRaysOfAPattern
 * rays share PatternsOfRays patterns: each beam has one of them, turned about its axis by an angle
 * of its own, both at random. Over patterns and angles the rays of a beam are distributed as if
 * drawn for it alone; beams of one pattern differ by the turn. Monte Carlo rays (the paper) are
 * drawn for each beam.
 *
 * Source: none.
 * Valid: as BeamRays.h. Beams that share a pattern are not independent; over all patterns a ray
 * comes once into each part of its cell's range of radii, so means over many beams have next to no
 * error of the patterns.
 * Test: TestBeamRays.cxx.
 */
#ifndef avianlidar_BeamSampler_h
#define avianlidar_BeamSampler_h

#include "BeamRays.h"
#include "BeamShape.h"
#include "StandardError.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
constexpr std::size_t PatternsOfRays = 64;
constexpr std::uint32_t MostRaysOfAPattern = 512;

/// Draws the rays of beams. One per thread, for one sensor and seed.
class BeamSampler
{
public:
  BeamSampler(const Sensor& sensor, Sampling sampling, std::uint32_t rays);
  BeamSampler(const BeamSampler&) = delete;
  BeamSampler& operator=(const BeamSampler&) = delete;

  /// The rays of a beam.
  void draw(std::int32_t seed, std::uint64_t beam, BeamRays& rays);

  StrataPartition strata;
  StandardErrorEstimator error;

private:
  const BeamShape Shape;
  const Sampling Method;
  std::vector<BeamRays> Patterns; ///< empty until one is needed
};
}

#endif
