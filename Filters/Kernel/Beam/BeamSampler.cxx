// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSampler.h"

#include <algorithm>

namespace avianlidar
{
BeamSampler::BeamSampler(const Sensor& sensor, Sampling sampling, std::uint32_t rays)
  : strata(rays)
  , Shape(sensor)
  , Method(sampling)
{
}

void BeamSampler::draw(std::int32_t seed, std::uint64_t beam, BeamRays& rays)
{
  const std::size_t count = this->strata.numberOfRays();
  if (this->Method == Sampling::MonteCarlo || count > MostRaysOfAPattern)
  {
    sampleBeam(seed, beam, count, this->Shape.profile(), this->Method, &this->strata, rays);
    return this->Shape.fit(rays);
  }
  const auto u = uniformPair(seed, beam, 0, RandomPurpose::Turns);
  const auto number = static_cast<std::size_t>(u[0] * PatternsOfRays);
  this->Patterns.resize(PatternsOfRays);
  BeamRays& pattern = this->Patterns[std::min(number, PatternsOfRays - 1)];
  if (pattern.size() == 0)
  {
    samplePattern(seed, number, PatternsOfRays, this->Shape.profile(), this->strata, pattern);
  }
  turnRays(pattern, u[1], rays);
  this->Shape.fit(rays);
}
}
