// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSampler.h
 * @brief Draws the rays of beams, from strata and patterns that are made once.
 *
 * Drawing stratified rays takes longer than tracing them. Beams of up to MostRaysOfAPattern rays
 * therefore share PatternsOfRays patterns: each beam has a random pattern, turned about the axis of
 * the beam by a random angle. Over patterns and angles, the rays of a beam are distributed as if
 * the rays were drawn only for this beam. Monte Carlo rays (the paper) are drawn for each beam.
 *
 * Source: none.
 * Valid: as BeamRays.h. Beams that share a pattern differ only by the turn, so these beams are not
 * independent. The comment of samplePattern() treats means over many beams.
 * Test: TestBeamRays.cxx.
 */
#ifndef avianlidar_BeamSampler_h
#define avianlidar_BeamSampler_h

#include "BeamRays.h"
#include "BeamShape.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
constexpr std::size_t PatternsOfRays = 64;
constexpr std::uint32_t MostRaysOfAPattern = 512;

/// Draws the rays of beams, for one sensor and one seed. Each thread needs its own object.
class BeamSampler
{
public:
  BeamSampler(const Sensor& sensor, Sampling sampling, std::uint32_t rays);
  BeamSampler(const BeamSampler&) = delete;
  BeamSampler& operator=(const BeamSampler&) = delete;

  /// Draws the rays of a beam.
  void draw(std::int32_t seed, std::uint64_t beam, BeamRays& rays);

  bool isStratified() const { return this->Method == Sampling::Stratified; }

  StrataPartition strata;

private:
  const BeamShape Shape;
  const Sampling Method;
  std::vector<BeamRays> Patterns; ///< patterns of rays; each pattern is empty until first needed
};
}

#endif
