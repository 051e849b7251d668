// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSamplers.h
 * @brief Strata of the beam and the estimator of its error, made once for every number of rays that
 * a scan uses.
 */
#ifndef avianlidar_BeamSamplers_h
#define avianlidar_BeamSamplers_h

#include "BeamRays.h"
#include "StandardError.h"

#include <cstdint>
#include <map>
#include <memory>

namespace avianlidar
{
struct BeamSampler
{
  StrataPartition strata;
  StandardErrorEstimator error;
  BeamSampler(Sampling sampling, std::uint32_t rays)
    : strata(rays)
    , error(sampling, rays, &strata)
  {
  }
};

/// One per thread.
class BeamSamplers
{
public:
  explicit BeamSamplers(Sampling sampling)
    : Method(sampling)
  {
  }

  /// For beams of so many rays. It stays where it is.
  BeamSampler& of(std::uint32_t rays)
  {
    auto& sampler = this->Samplers[rays];
    if (!sampler)
    {
      sampler = std::make_unique<BeamSampler>(this->Method, rays);
    }
    return *sampler;
  }

private:
  Sampling Method;
  std::map<std::uint32_t, std::unique_ptr<BeamSampler>> Samplers;
};
}

#endif
