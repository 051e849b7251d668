// SPDX-License-Identifier: BSD-3-Clause
#include "PulseLanes.h"

#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
AVIANLIDAR_MULTIVERSION PulseExtent placeAll(const double* lengths, const double* energies,
  double unitPathLength, double relativeWidth, double* begins, double* widths, double* firsts,
  double* lasts, std::size_t count)
{
  constexpr double none = std::numeric_limits<double>::infinity();
  double lowest = none;
  double highest = -none;
  double units = 0.0;
#pragma omp simd reduction(min : lowest) reduction(max : highest, units)
  for (std::size_t c = 0; c < count; ++c)
  {
    const double delay = lengths[c] / unitPathLength;
    const double begin = delay - 0.5 * relativeWidth;
    const double end = delay + 0.5 * relativeWidth;
    // The width after rounding, so that the shares still add up to 1.
    const double width = end - begin;
    const bool wide = width > 0.0;
    const double first = std::floor(wide ? begin : delay);
    const double last = wide ? std::floor(end) : first;
    begins[c] = begin;
    widths[c] = width;
    firsts[c] = first > 0.0 ? first : 0.0;
    lasts[c] = last;
    const bool counts = energies[c] > 0.0;
    const double low = counts ? firsts[c] : none;
    const double high = counts ? last : -none;
    const double span = counts ? last - firsts[c] : 0.0;
    lowest = low < lowest ? low : lowest;
    highest = high > highest ? high : highest;
    units = span > units ? span : units;
  }
  return { lowest, highest, units };
}

AVIANLIDAR_MULTIVERSION void halveAll(const PulseLanes& pulses, double lowest, double window,
  std::uint32_t* places, double* here, double* next)
{
  const PulseLanes p = pulses;
#pragma omp simd
  for (std::size_t c = 0; c < p.count; ++c)
  {
    const bool both = p.lasts[c] > p.firsts[c];
    const double ratio = (p.firsts[c] + 1.0 - p.begins[c]) / (both ? p.widths[c] : 1.0);
    const double share = both ? ratio : 1.0;
    here[c] = p.energies[c] * share;
    next[c] = p.energies[c] * (1.0 - share);
    // Contributions of no energy may lie anywhere.
    const double from = p.firsts[c] - lowest;
    const bool inside = (p.energies[c] > 0.0) & (from < window);
    places[c] = static_cast<std::uint32_t>(static_cast<std::int32_t>(inside ? from : window));
  }
}

AVIANLIDAR_MULTIVERSION void portionsOfAll(const double* energies, const double* begins,
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

AVIANLIDAR_MULTIVERSION void choosePortions(const double* energies, const std::uint32_t* places,
  const double* here, const double* next, double first, double last, double* portions,
  std::size_t count)
{
#pragma omp simd
  for (std::size_t c = 0; c < count; ++c)
  {
    const double place = static_cast<double>(static_cast<std::int32_t>(places[c]));
    const double one = (place >= first) & (place < last) ? here[c] : 0.0;
    const double two = (place + 1.0 >= first) & (place + 1.0 < last) ? next[c] : 0.0;
    portions[c] = (place >= first) & (place + 1.0 < last) ? energies[c] : one + two;
  }
}
}

PulseExtent placePulses(const double* lengths, const double* energies, double unitPathLength,
  double relativeWidth, double* begins, double* widths, double* firsts, double* lasts,
  std::size_t count)
{
  return placeAll(
    lengths, energies, unitPathLength, relativeWidth, begins, widths, firsts, lasts, count);
}

void halvePulses(const PulseLanes& pulses, double lowest, double window, std::uint32_t* places,
  double* here, double* next)
{
  halveAll(pulses, lowest, window, places, here, next);
}

void portionsOfPulses(const PulseLanes& pulses, double first, double last, double* portions)
{
  portionsOfAll(pulses.energies, pulses.begins, pulses.widths, pulses.firsts, pulses.lasts, first,
    last, portions, pulses.count);
}

void portionsOfHalves(const double* energies, const std::uint32_t* places, const double* here,
  const double* next, double first, double last, double* portions, std::size_t count)
{
  choosePortions(energies, places, here, next, first, last, portions, count);
}
}
