// SPDX-License-Identifier: BSD-3-Clause
#include "Drops.h"

#include "Distributions.h"
#include "Random.h"

#include <array>
#include <cmath>

namespace avianlidar
{
PulseShares::PulseShares(const ReceivedPulse& pulse)
  : Pulse(pulse)
  , Reach(static_cast<std::int64_t>(std::ceil(std::max(pulse.before(), pulse.after()))))
{
  const double width = pulse.width();
  // The share e of the next unit makes e (1 - e) equal to its mean over all places, w/6.
  const double part = std::min(1.0, width);
  const double end = 0.5 * part * (1.0 - std::sqrt(1.0 - 2.0 * part / 3.0)) - 0.5 * width;
  this->Place = end - std::floor(end);
}

void PulseShares::add(double energy, double place, double* units) const
{
  const double begin = place - this->Pulse.before() + static_cast<double>(this->Reach);
  const double end = begin + this->Pulse.width();
  if (!(end > begin))
  {
    units[this->Reach] += energy;
    return;
  }
  for (auto unit = static_cast<std::int64_t>(begin); unit <= 2 * this->Reach; ++unit)
  {
    const auto from = static_cast<double>(unit);
    if (this->Pulse.isRectangle())
    {
      units[unit] +=
        energy * std::max(0.0, std::min(end, from + 1.0) - std::max(begin, from)) / (end - begin);
      continue;
    }
    const double after = place + static_cast<double>(this->Reach);
    units[unit] += energy *
      (this->Pulse.shareBefore(from + 1.0 - after) - this->Pulse.shareBefore(from - after));
  }
}

namespace
{
constexpr std::uint64_t DrawsOfUnit = 256;

/// A gamma variate of mean 1, less 1, and an independent uniform number. @param shape 1 or more
/// @param draw gives pairs of uniform numbers
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
  double mean, double drops, const Medium& medium, const PulseShares& pulse, double* units)
{
  if (!(mean > 0.0 && drops > 0.0))
  {
    return;
  }
  const std::uint64_t first = DrawsOfUnit * number;
  const auto draw = [&](std::uint64_t k)
  { return uniformPair(seed, beam, first + k, RandomPurpose::Drops, revolution); };
  const double place = pulse.placeOfMany();
  if (drops > FewDrops)
  {
    const double shape = drops / medium.squareOfDrops;
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
    // Energy of the drop, or square of the leaf's cosine, over the mean.
    const double light = medium.squareOfDrops == SquareOfLeaves
      ? 3.0 * size * size
      : 0.5 * d * d * medium.light.efficiencyOf(-d);
    pulse.add(mean * light / drops, at, units);
  }
}
}

void addDropsBeyondMean(std::int32_t seed, std::uint64_t beam, std::uint64_t number,
  std::int32_t revolution, double mean, double drops, const Medium& medium,
  const PulseShares& pulse, double* units)
{
  const auto add = [&](std::int32_t scan, double share)
  { addDrops(seed, beam, number, scan, share * mean, share * drops, medium, pulse, units); };
  // Drops that are not renewed are the same in every scan.
  constexpr std::int32_t always = -1;
  add(revolution, medium.renewed);
  add(always, 1.0 - medium.renewed);
}
}
