// SPDX-License-Identifier: BSD-3-Clause
#include "PathStrengths.h"

#include "DirectLight.h"
#include "Propagation.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
double glossOf(const ScanSetup& setup, const Material& material, double cosIncidence)
{
  const double second = setup.sensor.receiverAperture > 0.0 ? 1.0 : setup.largestReflectance;
  return reflectanceBound(setup.settings.reflectanceModel, material, cosIncidence).specular *
    second * SurelyAbove;
}

void PathStrengths::measure(
  const ScanSetup& setup, const PrimaryHits& hits, const DirectLight& light)
{
  this->direct = light.reflected;
  this->directSum = 0.0;
  this->budgetSum = 0.0;
  this->glossSum = 0.0;
  this->nearest = std::numeric_limits<double>::infinity();
  this->paths = KnownPaths();
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    const Material material{ light.kd[i], light.ks[i], light.kp[i] };
    this->directSum += this->direct[i];
    this->budgetSum += std::max(0.0, material.kd + material.ks - this->direct[i]);
    this->glossSum += glossOf(setup, material, hits.cosine[i]);
    this->nearest = std::min(this->nearest, hits.range[i]);
  }
}

double PathStrengths::mostAir(double attenuation) const
{
  return transmission(attenuation, 2.0 * this->nearest) * SurelyAbove;
}

std::size_t PathStrengths::bytes() const
{
  return sizeof(PathStrengths) +
    sizeof(double) *
    (this->direct.capacity() + this->paths.length.capacity() + this->paths.strength.capacity()) +
    sizeof(KnownPaths::End) * this->paths.ends.capacity();
}
}
