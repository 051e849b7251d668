// SPDX-License-Identifier: BSD-3-Clause
#include "BeamNoise.h"

#include "Distributions.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Share of units with a common deviate, below CommonDeviate, among the units without a false
/// alarm. Among all units, P(z < 3) = 0.99865.
constexpr double CommonShare = 0.9986;

/// Uniform random numbers that belong to a unit or to another index.
std::array<double, 2> draw(const NoiseKey& key, std::int64_t unit, RandomPurpose purpose)
{
  return uniformPair(key.seed, key.beam, static_cast<std::uint64_t>(unit), purpose, key.revolution);
}
}

double rangeDeviate(const NoiseKey& key, std::int64_t unit)
{
  const double u = draw(key, unit, RandomPurpose::RangeNoise)[0];
  return normalDeviate(u, 1.0 - u);
}

double placeOfNoise(const NoiseKey& key, std::int64_t unit)
{
  // BeamNoise::energy() uses the first number of the pair.
  return draw(key, unit, RandomPurpose::Noise)[1];
}

void BeamNoise::begin(const NoisePlan& plan, const NoiseKey& key)
{
  this->Plan = plan;
  this->Key = key;
  this->Alarms.clear();
  this->RareBegin = -1;
  if (!plan.active || !(plan.alarmProbability > 0.0))
  {
    return;
  }
  // ln(1 - p) from the smaller of the two probabilities.
  const double logQuiet = plan.alarmProbability > 0.5 ? std::log(plan.quietProbability)
                                                      : std::log1p(-plan.alarmProbability);
  this->forEachInGaps(logQuiet, plan.firstUnit, plan.gateUnits, RandomPurpose::FalseAlarms,
    [&](std::int64_t unit) { this->Alarms.push_back(unit); });
}

/// Calls f(unit) for units drawn independently. The number of units between two of them is
/// geometric, floor(ln u/ln(1 - p)).
template <class F>
void BeamNoise::forEachInGaps(
  double logOthers, std::int64_t begin, std::int64_t end, RandomPurpose purpose, F f) const
{
  for (std::int64_t number = begin; begin < end; ++number)
  {
    const double gap = std::floor(std::log(draw(this->Key, number, purpose)[0]) / logOthers);
    if (!(gap < static_cast<double>(end - begin)))
    {
      return;
    }
    begin += static_cast<std::int64_t>(gap);
    f(begin);
    ++begin;
  }
}

bool BeamNoise::isRare(std::int64_t unit)
{
  const std::int64_t begin = unit - unit % UnitsOfBlock;
  if (begin != this->RareBegin)
  {
    static const double logCommon = std::log(CommonShare);
    this->RareBegin = begin;
    this->Rare.reset();
    this->forEachInGaps(logCommon, begin, begin + UnitsOfBlock, RandomPurpose::RareNoise,
      [&](std::int64_t one) { this->Rare.set(static_cast<std::size_t>(one - begin)); });
  }
  return this->Rare.test(static_cast<std::size_t>(unit - begin)) && !this->isAlarm(unit);
}

/// Photons of a unit. @param u uniform in (0, 1) @param alarm true if the photons alone exceed Qlow
double BeamNoise::photons(double u, bool alarm) const
{
  const NoisePlan& plan = this->Plan;
  if (alarm)
  {
    const double q = (1.0 - u) * plan.alarmProbability;
    return std::max(plan.alarmPhotons + 1.0,
      poissonQuantile(plan.meanPhotons, plan.quietProbability + u * plan.alarmProbability, q));
  }
  const double q = plan.alarmProbability + (1.0 - u) * plan.quietProbability;
  return std::min(
    plan.alarmPhotons, poissonQuantile(plan.meanPhotons, u * plan.quietProbability, q));
}

double BeamNoise::energy(std::int64_t unit, double light)
{
  const NoisePlan& plan = this->Plan;
  if (!plan.active || unit < plan.firstUnit || unit >= plan.gateUnits)
  {
    return 0.0;
  }
  const double u = draw(this->Key, unit, RandomPurpose::Noise)[0];
  const bool alarm = this->isAlarm(unit);
  if (!plan.gaussian)
  {
    return this->photons(u, alarm) * plan.photonEnergy;
  }
  const double deviation = std::sqrt(plan.darkVariance + plan.varianceOfEnergy * light);
  if (alarm)
  {
    const double above = (1.0 - u) * plan.alarmProbability;
    return deviation * normalDeviate(plan.quietProbability + u * plan.alarmProbability, above);
  }
  // Shares of the deviates that raise no alarm.
  const bool rare = this->isRare(unit);
  const double below = rare ? CommonShare + (1.0 - CommonShare) * u : CommonShare * u;
  const double rest =
    rare ? (1.0 - CommonShare) * (1.0 - u) : (1.0 - CommonShare) + CommonShare * (1.0 - u);
  return deviation *
    normalDeviate(
      below * plan.quietProbability, plan.alarmProbability + rest * plan.quietProbability);
}
}
