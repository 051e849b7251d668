// SPDX-License-Identifier: BSD-3-Clause
#include "AirEcho.h"

#include "Noise.h"
#include "Random.h"
#include "RangeUnits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace avianlidar
{
namespace
{
constexpr std::uint64_t DrawsOfUnit = 256;
}

LidarView viewOf(const Sensor& sensor)
{
  return { SpeedOfLight / sensor.frequency,
    2.0 * std::asin(std::min(1.0, std::sqrt(sensor.solidAngle() / (4.0 * Pi)))) };
}

PulseShares::PulseShares(double width)
  : Width(width)
  , Reach(static_cast<std::int64_t>(std::ceil(0.5 * width)))
{
  // With a share e in the next unit, e (1 - e) is its mean over drops anywhere: w/6.
  const double part = std::min(1.0, width);
  const double end = 0.5 * part * (1.0 - std::sqrt(1.0 - 2.0 * part / 3.0)) - 0.5 * width;
  this->Place = end - std::floor(end);
}

void PulseShares::add(double energy, double place, double* units) const
{
  const double begin = place - 0.5 * this->Width + static_cast<double>(this->Reach);
  const double end = begin + this->Width;
  if (!(end > begin))
  {
    units[this->Reach] += energy;
    return;
  }
  for (auto unit = static_cast<std::int64_t>(begin); unit <= 2 * this->Reach; ++unit)
  {
    const auto from = static_cast<double>(unit);
    units[unit] +=
      energy * std::max(0.0, std::min(end, from + 1.0) - std::max(begin, from)) / (end - begin);
  }
}

SharedDrops::SharedDrops(const PulseShares& pulse)
  : Reach(pulse.reach())
{
  const auto count = static_cast<std::size_t>(2 * this->Reach + 1);
  this->Numbers.assign(count, -1);
  this->Shares.assign(count * count, 0.0);
}

AirEcho::AirEcho(const Sensor& sensor, const std::vector<Medium>& media, double attenuation)
  : SolidAngle(sensor.solidAngle())
  , UnitLength(sensor.rangeUnitLength())
  , Pulse(sensor.pulseWidth / sensor.samplingInterval)
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

void AirEcho::addBeyondMean(std::int32_t seed, std::uint64_t beam, std::int64_t unit,
  std::int32_t revolution, double open, double* units) const
{
  addDropsBeyondMean(seed, beam, static_cast<std::uint64_t>(unit), revolution,
    open * this->OfDrops * this->mean(unit), open * this->dropsIn(unit), Medium{}, this->Pulse,
    units);
}

namespace
{
/// A gamma variate of mean 1, less 1, and a uniform number that is independent of it: G. Marsaglia
/// and W. W. Tsang, ACM Trans. Math. Softw. 26, 2000. @param shape 1 or more @param draw pairs of
/// uniform numbers
template <class F>
std::array<double, 2> gammaBeyondMean(double shape, F draw)
{
  const double d = shape - 1.0 / 3.0;
  const double c = 1.0 / std::sqrt(9.0 * d);
  for (std::uint64_t k = 0;; k += 2)
  {
    const auto [radius, angle] = draw(k);
    const auto [u, other] = draw(k + 1);
    const double x = std::sqrt(-2.0 * std::log(radius)) * std::cos(2.0 * Pi * angle);
    const double v = std::pow(std::max(0.0, 1.0 + c * x), 3);
    if (v > 0.0 && std::log(u) < 0.5 * x * x + d * (1.0 - v + std::log(v)))
    {
      return { d * v / shape - 1.0, other };
    }
  }
}

/// Add the drops of one scan.
void addDrops(std::int32_t seed, std::uint64_t beam, std::uint64_t number, std::int32_t revolution,
  double mean, double drops, double square, const PulseShares& pulse, double* units)
{
  if (!(mean > 0.0 && drops > 0.0))
  {
    return;
  }
  const std::uint64_t first = DrawsOfUnit * number;
  const auto draw = [&](std::uint64_t k)
  { return uniformPair(seed, beam, first + k, RandomPurpose::Drops, revolution); };
  const double place = pulse.placeOfMany();
  if (drops > AirEcho::FewDrops)
  {
    const double shape = drops / square;
    const auto [beyond, where] = gammaBeyondMean(shape, draw);
    pulse.add(mean * beyond, where < 0.5 ? place : 1.0 - place, units);
    return;
  }
  pulse.add(-0.5 * mean, place, units);
  pulse.add(-0.5 * mean, 1.0 - place, units);
  const double u = draw(0)[0];
  const auto count = static_cast<std::uint64_t>(
    std::min<double>(DrawsOfUnit - 1, poissonQuantile(drops, u, 1.0 - u)));
  for (std::uint64_t k = 1; k <= count; ++k)
  {
    const auto [size, at] = draw(k);
    const double d = std::log(size);
    // The square of a diameter, or of a cosine, over its mean.
    const double light = square == SquareOfLeaves ? 3.0 * size * size : 0.5 * d * d;
    pulse.add(mean * light / drops, at, units);
  }
}
}

void addDropsBeyondMean(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double mean, double drops, const Medium& medium,
  const PulseShares& pulse, double* units)
{
  const auto add = [&](std::int32_t scan, double share)
  {
    addDrops(
      seed, beam, number, scan, share * mean, share * drops, medium.squareOfDrops, pulse, units);
  };
  // Those that stay are the same in every scan.
  constexpr std::int32_t always = -1;
  add(revolution, medium.renewed);
  add(always, 1.0 - medium.renewed);
}
}
