// SPDX-License-Identifier: BSD-3-Clause
#include "RangeShares.h"

#include "Multiversion.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace avianlidar
{
namespace
{
/// Number of requests for shares after which the contributions of a beam are sorted by their first
/// units, so that a request costs what it returns. Without sorting, a scan of ground in ReturnMode
/// RangeUnits, where a beam reaches hundreds of units, takes twenty times as long.
constexpr int RequestsBeforeSorting = 8;

/// Energy of a rectangular pulse inside units [first, last).
AVIANLIDAR_ALWAYS_INLINE double portionOfPulse(double energy, double begin, double width,
  double pulseFirst, double pulseLast, double first, double last)
{
  const double from = pulseFirst >= first ? 0.0 : (first - begin) / width;
  const double to = pulseLast < last ? 1.0 : (last - begin) / width;
  const bool meets = (pulseFirst < last) & (pulseLast >= first);
  return meets ? energy * (to - from) : 0.0;
}

/// portionOfPulse() of many pulses.
AVIANLIDAR_MULTIVERSION void portionsOfPulses(const double* energies, const double* begins,
  const double* widths, const double* firsts, const double* lasts, double first, double last,
  double* portions, std::size_t count)
{
#pragma omp simd
  for (std::size_t c = 0; c < count; ++c)
  {
    portions[c] =
      portionOfPulse(energies[c], begins[c], widths[c], firsts[c], lasts[c], first, last);
  }
}
}

void ShareFinder::begin(const RangeUnitAccumulator& units)
{
  this->Units = &units;
  this->Requests = 0;
}

RangeShares ShareFinder::sharesOf(std::int64_t first, std::int64_t last)
{
  if (this->Requests == 0 || first != this->ShareFirst || last != this->ShareLast)
  {
    this->ShareFirst = first;
    this->ShareLast = last;
    this->findShares(static_cast<double>(first), static_cast<double>(last));
  }
  return { this->Portions.data(), this->Sharers.data(), this->ShareCount };
}

void ShareFinder::findShares(double first, double last)
{
  const RangeUnitAccumulator::Pulses pulses = this->Units->pulses();
  const std::size_t count = pulses.energies.size();
  this->Portions.resize(count);
  this->Sharers.resize(count);
  this->ShareCount = 0;
  const auto add = [&](std::uint32_t c, double portion)
  {
    this->Portions[this->ShareCount] = portion;
    this->Sharers[this->ShareCount] = c;
    this->ShareCount += portion > 0.0;
  };
  const auto portionOf = [&](std::size_t c)
  {
    if (pulses.shape.isRectangle())
    {
      return portionOfPulse(pulses.energies[c], pulses.begins[c], pulses.widths[c],
        pulses.firsts[c], pulses.lasts[c], first, last);
    }
    const auto shareTo = [&](double unit)
    { return pulses.shape.shareOf((unit - pulses.begins[c]) / pulses.widths[c]); };
    const double from = pulses.firsts[c] >= first ? 0.0 : shareTo(first);
    const double to = pulses.lasts[c] < last ? 1.0 : shareTo(last);
    const bool meets = pulses.firsts[c] < last && pulses.lasts[c] >= first;
    return meets ? pulses.energies[c] * (to - from) : 0.0;
  };
  if (++this->Requests <= RequestsBeforeSorting)
  {
    if (pulses.shape.isRectangle())
    {
      portionsOfPulses(pulses.energies.data(), pulses.begins.data(), pulses.widths.data(),
        pulses.firsts.data(), pulses.lasts.data(), first, last, this->Portions.data(), count);
    }
    for (std::size_t c = 0; c < count; ++c)
    {
      add(static_cast<std::uint32_t>(c),
        pulses.shape.isRectangle() ? this->Portions[c] : portionOf(c));
    }
    return;
  }
  for (const std::uint32_t c : this->contributionsNear(first, last))
  {
    add(c, portionOf(c));
  }
}

/// All contributions that may have a share in units [first, last), in the order of their numbers.
const std::vector<std::uint32_t>& ShareFinder::contributionsNear(double first, double last)
{
  const RangeUnitAccumulator::Pulses pulses = this->Units->pulses();
  const std::vector<double>& firsts = pulses.firsts;
  if (this->Requests == RequestsBeforeSorting + 1)
  {
    this->ByFirst.resize(firsts.size());
    std::iota(this->ByFirst.begin(), this->ByFirst.end(), 0u);
    std::sort(this->ByFirst.begin(), this->ByFirst.end(),
      [&](std::uint32_t a, std::uint32_t b)
      { return std::tie(firsts[a], a) < std::tie(firsts[b], b); });
  }
  // No pulse overlaps more than their width + 2 units.
  const auto isBelow = [&](std::uint32_t c, double unit) { return firsts[c] < unit; };
  const auto begin = std::lower_bound(this->ByFirst.begin(), this->ByFirst.end(),
    first - std::ceil(pulses.shape.width()) - 2.0, isBelow);
  this->Near.assign(begin, std::lower_bound(begin, this->ByFirst.end(), last, isBelow));
  std::sort(this->Near.begin(), this->Near.end());
  return this->Near;
}
}
