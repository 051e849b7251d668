// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSamplers.h
 * @brief Strata of the beam, patterns of rays, and the estimator of the standard error, made once
 * for each number of rays that a scan uses.
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
#ifndef avianlidar_BeamSamplers_h
#define avianlidar_BeamSamplers_h

#include "BeamRays.h"
#include "PacketOrder.h"
#include "StandardError.h"

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace avianlidar
{
constexpr std::size_t PatternsOfRays = 64;
constexpr std::uint32_t MostRaysOfAPattern = 512;

/// Draws the rays of beams of one number of rays. One per thread.
class BeamSampler
{
public:
  BeamSampler(Sampling sampling, std::uint32_t rays);

  /// The rays of a beam. @param purpose Rays or Pilot
  void draw(const Sensor& sensor, std::int32_t seed, std::uint64_t beam, RandomPurpose purpose,
    BeamRays& rays);

  StrataPartition strata;
  StandardErrorEstimator error;

private:
  Sampling Method;
  std::vector<BeamRays> Patterns; ///< empty until one is needed
};

/// The samplers of all numbers of rays. One per thread, for one sensor and seed.
class BeamSamplers
{
public:
  explicit BeamSamplers(Sampling sampling)
    : Method(sampling)
  {
  }

  /// The sampler for beams of `rays` rays; its address stays valid.
  BeamSampler& of(std::uint32_t rays)
  {
    if (rays != this->LastRays)
    {
      auto& sampler = this->Samplers[rays];
      if (!sampler)
      {
        sampler = std::make_unique<BeamSampler>(this->Method, rays);
      }
      this->LastRays = rays;
      this->Last = sampler.get();
    }
    return *this->Last;
  }

  PacketOrder order; ///< of rays in packets

private:
  Sampling Method;
  std::map<std::uint32_t, std::unique_ptr<BeamSampler>> Samplers;
  std::uint32_t LastRays = 0; ///< of `Last`; 0: none
  BeamSampler* Last = nullptr;
};
}

#endif
