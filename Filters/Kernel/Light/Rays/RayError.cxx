// SPDX-License-Identifier: BSD-3-Clause
#include "RayError.h"

#include "SecondaryReflection.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
void RayError::gather(const BeamSamples& samples, const std::vector<SecondaryPath>& paths,
  const RangeShares& shares, const TargetRays& targets, std::size_t nodes)
{
  const std::size_t direct = nodes == NoNodes ? samples.size() : nodes;
  this->Rays = &this->Samplers.of(samples.rays).error;
  this->Energies.assign(samples.extraRays, 0.0);
  const auto add = [&](std::size_t sample, double energy)
  {
    const std::uint32_t ray = samples.ray[sample];
    if (ray < samples.rays)
    {
      this->Rays->add(ray, energy);
    }
    else
    {
      this->Energies[ray - samples.rays] += energy;
    }
  };
  this->Rays->begin(shares.which ? 0
                                 : std::count_if(samples.ray.begin(), samples.ray.end(),
                                     [&](std::uint32_t ray) { return ray < samples.rays; }));
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t contribution = shares.contribution(s);
    if (contribution < direct)
    {
      if (nodes == NoNodes)
      {
        add(contribution, shares.energies[s]);
      }
      continue;
    }
    // A connection depends on both its rays.
    const SecondaryPath& path = paths[contribution - direct];
    add(path.one, shares.energies[s]);
    if (path.two != NoSample)
    {
      add(path.two, shares.energies[s]);
    }
  }
  this->Targets.clear();
  const double* energies = this->Energies.data();
  for (std::size_t k = 0; samples.extraRays > 0 && k < targets.size(); ++k)
  {
    this->Targets.push_back(std::sqrt(varianceOfPairs(energies, targets[k])));
    energies += targets[k];
  }
}

double RayError::ofRays(bool filled, double glint) const
{
  const double least = filled ? this->Rays->smallest() : 0.0;
  return this->Rays->estimate({ least, this->Rays->largest(), glint });
}

double RayError::total(bool filled, double glint) const
{
  const double rays = this->ofRays(filled, glint);
  if (this->Targets.empty())
  {
    return rays;
  }
  double variance = rays * rays;
  for (const double error : this->Targets)
  {
    variance += error * error;
  }
  return std::sqrt(variance);
}
}
