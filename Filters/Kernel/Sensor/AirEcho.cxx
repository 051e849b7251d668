// SPDX-License-Identifier: BSD-3-Clause
#include "AirEcho.h"

#include "Noise.h"
#include "Random.h"
#include "RangeUnits.h"

#include <boost/math/special_functions/gamma.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
constexpr std::uint64_t DrawsOfUnit = 256;
}

AirEcho::AirEcho(const Sensor& sensor, const std::vector<Medium>& media, double attenuation)
  : SolidAngle(sensor.solidAngle())
  , UnitLength(sensor.rangeUnitLength())
  , Nearest(sensor.minimumRange)
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
  const auto light = [&](double r)
  {
    return sensor.nearRangeShare(r) * std::min(sensor.receiverAperture / (r * r), 2.0 * Pi) *
      std::exp(-2.0 * attenuation * r);
  };
  const double count = std::min(
    MostUnits, static_cast<double>(unitsInsideGate(sensor.samplingInterval, sensor.rangeGate)));
  for (double unit = 0.0; unit < count; unit += 1.0)
  {
    const double from = std::max(unit * this->UnitLength, this->Nearest);
    const double to = (unit + 1.0) * this->UnitLength;
    const double energy =
      sensor.pulseEnergy * all * airIntegral(sensor, from, to, 2.0 * attenuation, light);
    if (!(energy > 0.0) && from < to)
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
  const double begin = this->UnitLength * static_cast<double>(unit);
  const double r = std::max(begin, this->Nearest);
  const double length = this->UnitLength - (r - begin);
  const double volume = this->SolidAngle * length * (r * r + r * length + length * length / 3.0);
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

double AirEcho::beyondMean(std::int32_t seed, std::uint64_t beam, std::int64_t unit,
  std::int32_t revolution, bool all, double open) const
{
  const double mean = open * this->OfDrops * this->mean(unit);
  const double drops = open * this->dropsIn(unit);
  if (!(mean > 0.0))
  {
    return 0.0;
  }
  const auto number = static_cast<std::uint64_t>(unit);
  if (!all && open == 1.0 && drops > FewDrops &&
    uniformPair(seed, beam, DrawsOfUnit * number, RandomPurpose::Drops, revolution)[0] <
      this->Quiet[static_cast<std::size_t>(unit)])
  {
    return -std::numeric_limits<double>::infinity();
  }
  return mean * dropsBeyondMean(seed, beam, number, revolution, drops, Medium{});
}

namespace
{
/// The drops of one scan.
double drawnDrops(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double drops, double square)
{
  const std::uint64_t first = DrawsOfUnit * number;
  const auto u = uniformPair(seed, beam, first, RandomPurpose::Drops, revolution);
  if (drops > AirEcho::FewDrops)
  {
    // Shape a, scale 1/a of the mean.
    const double shape = drops / square;
    return boost::math::gamma_p_inv(shape, u[0]) / shape - 1.0;
  }
  const auto count = static_cast<std::uint64_t>(
    std::min<double>(DrawsOfUnit - 1, poissonQuantile(drops, u[0], 1.0 - u[0])));
  double squares = 0.0; // of diameters, or of cosines, over their mean
  for (std::uint64_t k = 1; k <= count; ++k)
  {
    const double uniform = uniformPair(seed, beam, first + k, RandomPurpose::Drops, revolution)[0];
    const double d = std::log(uniform);
    squares += square == SquareOfLeaves ? 3.0 * uniform * uniform : 0.5 * d * d;
  }
  return squares / drops - 1.0;
}
}

double dropsBeyondMean(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double drops, const Medium& medium)
{
  const auto draw = [&](std::int32_t scan, double share)
  {
    return share > 0.0 && drops > 0.0
      ? share * drawnDrops(seed, beam, number, scan, share * drops, medium.squareOfDrops)
      : 0.0;
  };
  // Those that stay are the same in every scan.
  constexpr std::int32_t always = -1;
  const double renewed = draw(revolution, medium.renewed);
  return medium.renewed < 1.0 ? renewed + draw(always, 1.0 - medium.renewed) : renewed;
}
}
