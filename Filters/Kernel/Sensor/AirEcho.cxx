// SPDX-License-Identifier: BSD-3-Clause
#include "AirEcho.h"

#include "Noise.h"
#include "Random.h"
#include "RangeUnits.h"

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr double MostUnits = 1e6;

/// Panels of a rule grow by this, and none is longer than so many lengths of extinction, there and
/// back.
constexpr double Growth = 1.5;
constexpr double LongestPanel = 2.0;

/// Light that has been weakened so far is gone, as an exponent.
constexpr double NothingLeft = 700.0;

/// Integral over the ranges from one to another, m, of what the aperture gathers. @param reach m:
/// nearer, it gathers half of all
double gathered(const Sensor& sensor, double attenuation, double from, double to, double reach)
{
  const auto at = [&](double r)
  {
    return sensor.nearRangeShare(r) * std::min(sensor.receiverAperture / (r * r), 2.0 * Pi) *
      std::exp(-2.0 * attenuation * r);
  };
  const double longest = LongestPanel / std::max(1e-300, 2.0 * attenuation);
  double sum = 0.0;
  for (double begin = from; begin < to && 2.0 * attenuation * begin < NothingLeft;)
  {
    double end = begin < reach ? reach : Growth * begin;
    end = std::min({ end, begin + longest, to });
    sum += boost::math::quadrature::gauss<double, 10>::integrate(at, begin, end);
    begin = end;
  }
  return sum;
}
}

AirEcho::AirEcho(const Sensor& sensor, const std::vector<Medium>& media, double attenuation)
  : SolidAngle(sensor.solidAngle())
  , UnitLength(sensor.rangeUnitLength())
{
  double all = 0.0;
  for (const Medium& medium : media)
  {
    all += medium.backscatter();
    // Rain alone has drops that count.
    this->OfDrops += medium.drops > 0.0 ? medium.backscatter() : 0.0;
    this->Drops += medium.drops;
  }
  if (!(all > 0.0) || !(sensor.receiverAperture > 0.0))
  {
    return;
  }
  this->OfDrops /= all;
  const double reach = std::sqrt(sensor.receiverAperture / (2.0 * Pi));
  const double count = std::min(
    MostUnits, static_cast<double>(unitsInsideGate(sensor.samplingInterval, sensor.rangeGate)));
  for (double unit = 0.0; unit < count; unit += 1.0)
  {
    const double energy = sensor.pulseEnergy * all *
      gathered(
        sensor, attenuation, unit * this->UnitLength, (unit + 1.0) * this->UnitLength, reach);
    if (!(energy > 0.0))
    {
      break;
    }
    this->Means.push_back(energy);
  }
  this->Quiet.resize(this->Means.size(), 0.0);
}

/// Drops in a unit, on average.
double AirEcho::dropsIn(std::int64_t unit) const
{
  const double r = this->UnitLength * static_cast<double>(unit);
  const double volume = this->SolidAngle * this->UnitLength *
    (r * r + r * this->UnitLength + this->UnitLength * this->UnitLength / 3.0);
  return this->Drops * volume;
}

double AirEcho::variance(std::int64_t unit) const
{
  const double mean = this->OfDrops * this->mean(unit);
  return mean > 0.0 ? mean * mean * SquareOfDrops / this->dropsIn(unit) : 0.0;
}

void AirEcho::setLeast(std::int64_t unit, double least)
{
  const double mean = this->OfDrops * this->mean(unit);
  const double shape = this->dropsIn(unit) / SquareOfDrops;
  this->Quiet[static_cast<std::size_t>(unit)] =
    mean > 0.0 && least > -mean ? 1.0 - gammaTail(shape, shape * (1.0 + least / mean)) : 0.0;
}

double AirEcho::beyondMean(
  std::int32_t seed, std::uint64_t beam, std::int64_t unit, std::int32_t revolution, bool all) const
{
  const double mean = this->OfDrops * this->mean(unit);
  const double drops = this->dropsIn(unit);
  if (!(mean > 0.0))
  {
    return 0.0;
  }
  constexpr std::uint64_t draws = 256; // of a unit
  const auto first = draws * static_cast<std::uint64_t>(unit);
  const auto u = uniformPair(seed, beam, first, RandomPurpose::Drops, revolution);
  if (drops > FewDrops)
  {
    // Shape a, scale 1/a of the mean.
    const double shape = drops / SquareOfDrops;
    if (!all && u[0] < this->Quiet[static_cast<std::size_t>(unit)])
    {
      return -std::numeric_limits<double>::infinity();
    }
    return mean * (boost::math::gamma_p_inv(shape, u[0]) / shape - 1.0);
  }
  const auto number = static_cast<std::uint64_t>(
    std::min<double>(draws - 1, poissonQuantile(drops, u[0], 1.0 - u[0])));
  double squares = 0.0; // of diameters, over their mean
  for (std::uint64_t k = 1; k <= number; ++k)
  {
    const double d =
      std::log(uniformPair(seed, beam, first + k, RandomPurpose::Drops, revolution)[0]);
    squares += 0.5 * d * d;
  }
  return mean * (squares / drops - 1.0);
}
}
