// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file DrawnRays.h
 * @brief The rays of some beams, each drawn when it is first needed.
 *
 * Most beams need no rays, and drawing rays costs more than a descent of the tree.
 *
 * Source: none.
 * Valid: the rays of a beam depend only on its id, the sampler and the seed.
 * Test: TestScan.cxx, TestScanAgain.cxx.
 */
#ifndef avianlidar_DrawnRays_h
#define avianlidar_DrawnRays_h

#include "BeamSampler.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Each thread needs its own object.
class DrawnRays
{
public:
  /// Rays that the sampler draws. The sampler must outlive the object.
  DrawnRays(BeamSampler& sampler, std::int32_t seed)
    : Sampler(&sampler)
    , Seed(seed)
  {
  }

  /// Given rays, which must outlive the object. @param rays rays of beam 0, 1, ...
  explicit DrawnRays(const BeamRays* rays)
    : Given(rays)
  {
  }

  /// Begin the beams [begin, end). @param ids ids of all beams; must outlive the use of the object
  void begin(const std::vector<std::uint64_t>& ids, std::size_t begin, std::size_t end)
  {
    this->Ids = &ids;
    this->First = begin;
    this->Rays.resize(std::max(this->Rays.size(), end - begin));
    for (std::size_t k = 0; k < end - begin; ++k)
    {
      this->Rays[k].resize(0);
    }
  }

  /// Rays of a beam, valid until begin().
  const BeamRays& of(std::size_t beam)
  {
    if (this->Given)
    {
      return this->Given[beam];
    }
    BeamRays& rays = this->Rays[beam - this->First];
    if (rays.size() == 0)
    {
      this->Sampler->draw(this->Seed, (*this->Ids)[beam], rays);
    }
    return rays;
  }

  /// True if the rays of a beam are drawn.
  bool has(std::size_t beam) const { return this->Rays[beam - this->First].size() > 0; }

  /// Strata of the drawn rays of every beam; null for Monte Carlo and for given rays.
  const StrataPartition* strata() const
  {
    return this->Sampler && this->Sampler->isStratified() ? &this->Sampler->strata : nullptr;
  }

private:
  BeamSampler* const Sampler = nullptr;
  const std::int32_t Seed = 0;
  const BeamRays* const Given = nullptr;
  const std::vector<std::uint64_t>* Ids = nullptr;
  std::size_t First = 0;
  std::vector<BeamRays> Rays;
};
}

#endif
