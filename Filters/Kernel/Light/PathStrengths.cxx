// SPDX-License-Identifier: BSD-3-Clause
#include "PathStrengths.h"

#include "DirectLight.h"
#include "EightSums.h"
#include "HiddenGlint.h"
#include "Multiversion.h"
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

namespace
{
/// Paths of some hits do not start with the energy of one of N equal rays.
bool weighed(const PrimaryHits& hits)
{
  return !hits.share.empty() || hits.pathStep > 1;
}
}

void glossesOf(const ScanSetup& setup, const PrimaryHits& hits, const DirectLight& light,
  std::vector<double>& glosses)
{
  const std::size_t count = hits.size();
  glosses.resize(count);
  if (setup.settings.reflectanceModel == ReflectanceModel::LambertBlinnPhong)
  {
    // f_s is ks at most, whatever the incidence.
    const double second = setup.sensor.receiverAperture > 0.0 ? 1.0 : setup.largestReflectance;
    for (std::size_t i = 0; i < count; ++i)
    {
      glosses[i] = light.ks[i] * second * SurelyAbove;
    }
  }
  else
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      glosses[i] = glossOf(setup, { light.kd[i], light.ks[i], light.kp[i] }, hits.cosine[i]);
    }
  }
  for (std::size_t i = 0; weighed(hits) && i < count; ++i)
  {
    glosses[i] *= hits.pathWeight(i);
  }
}

namespace
{
/// Partial sums.
struct StrengthSums
{
  double direct[SumLanes] = {};
  double budget[SumLanes] = {};
  double gloss[SumLanes] = {};
};

/// What the hits return, what else they can return, and what they reflect of `gloss` each.
AVIANLIDAR_MULTIVERSION void sumUp(const double* direct, const double* kd, const double* ks,
  const double* gloss, std::size_t count, StrengthSums& sums)
{
  constexpr std::size_t lanes = SumLanes;
  StrengthSums s;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
  {
#pragma omp simd
    for (std::size_t k = 0; k < lanes; ++k)
    {
      const double left = kd[i + k] + ks[i + k] - direct[i + k];
      s.direct[k] += direct[i + k];
      s.budget[k] += left > 0.0 ? left : 0.0;
      s.gloss[k] += gloss[i + k];
    }
  }
  for (std::size_t k = 0; i + k < count; ++k)
  {
    const double left = kd[i + k] + ks[i + k] - direct[i + k];
    s.direct[k] += direct[i + k];
    s.budget[k] += left > 0.0 ? left : 0.0;
    s.gloss[k] += gloss[i + k];
  }
  sums = s;
}

/// The same of hits with shares or of which some have a mirror path; connections are those of the N
/// equal rays.
void sumUpShares(const PrimaryHits& hits, const DirectLight& light,
  const std::vector<double>& glosses, PathStrengths& strengths)
{
  strengths.directSum = strengths.budgetSum = strengths.glossSum = 0.0;
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    const double weight = hits.weight(i);
    const double left = std::max(0.0, light.kd[i] + light.ks[i] - light.reflected[i]);
    strengths.directSum += weight * light.reflected[i];
    const double most = std::max(weight, hits.pathWeight(i));
    strengths.budgetSum += (hits.ray[i] < hits.rays ? std::max(1.0, most) : most) * left;
    strengths.glossSum += glosses[i];
  }
}
}

void PathStrengths::measure(
  const ScanSetup& setup, const PrimaryHits& hits, const DirectLight& light)
{
  this->direct = light.reflected;
  this->paths = KnownPaths();
  this->glint = hiddenGlintOf(setup, hits, light);
  this->nearest = std::numeric_limits<double>::infinity();
  for (const double range : hits.range)
  {
    this->nearest = range < this->nearest ? range : this->nearest;
  }
  if (weighed(hits))
  {
    std::vector<double> glosses;
    glossesOf(setup, hits, light, glosses);
    sumUpShares(hits, light, glosses, *this);
    return;
  }
  StrengthSums sums;
  if (setup.settings.reflectanceModel == ReflectanceModel::LambertBlinnPhong)
  {
    // All hits have the same factor to their ks (see glossOf()).
    sumUp(
      light.reflected.data(), light.kd.data(), light.ks.data(), light.ks.data(), hits.size(), sums);
    this->glossSum = totalOf(sums.gloss) * glossOf(setup, { 0.0, 1.0, 0.0 }, 1.0);
  }
  else
  {
    std::vector<double> gloss;
    glossesOf(setup, hits, light, gloss);
    sumUp(
      light.reflected.data(), light.kd.data(), light.ks.data(), gloss.data(), hits.size(), sums);
    this->glossSum = totalOf(sums.gloss);
  }
  this->directSum = totalOf(sums.direct);
  this->budgetSum = totalOf(sums.budget);
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
