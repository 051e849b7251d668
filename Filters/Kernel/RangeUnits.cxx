// SPDX-License-Identifier: BSD-3-Clause
#include "RangeUnits.h"

#include "Multiversion.h"
#include "Sensor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace avianlidar
{
namespace
{
/// After so many requests for shares a beam's contributions are sorted by their first units, so
/// that a request costs what it returns.
constexpr int RequestsBeforeSorting = 8;

/// Units between the nearest and the farthest for which a table of sums is kept; beyond, and for
/// pulses that meet more than two units, what goes where is sorted.
constexpr double LargestTable = 16384.0;

/// What the pulses of a beam have in common.
struct Extent
{
  double lowest;  ///< unit
  double highest; ///< unit
  double units;   ///< most that one pulse overlaps, less one
};

AVIANLIDAR_MULTIVERSION Extent placeAll(const double* lengths, const double* energies,
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

/// Energy of a pulse inside units [first, last).
AVIANLIDAR_ALWAYS_INLINE double portionOf(double energy, double begin, double width,
  double pulseFirst, double pulseLast, double first, double last)
{
  const double from = pulseFirst >= first ? 0.0 : (first - begin) / width;
  const double to = pulseLast < last ? 1.0 : (last - begin) / width;
  const double portion = energy * (to - from);
  const bool meets = (pulseFirst < last) & (pulseLast >= first) & (portion > 0.0);
  return meets ? portion : 0.0;
}

AVIANLIDAR_MULTIVERSION void portionsOfAll(const double* energies, const double* begins,
  const double* widths, const double* firsts, const double* lasts, double first, double last,
  double* portions, std::size_t count)
{
#pragma omp simd
  for (std::size_t c = 0; c < count; ++c)
  {
    portions[c] = portionOf(energies[c], begins[c], widths[c], firsts[c], lasts[c], first, last);
  }
}
}

std::int64_t unitsInsideGate(double samplingInterval, double rangeGate)
{
  // checkSensor() refuses more than MaximumGateUnits.
  const double units = std::ceil(2.0 * rangeGate / (SpeedOfLight * samplingInterval));
  return static_cast<std::int64_t>(std::clamp(units, 1.0, MaximumGateUnits));
}

RangeUnitAccumulator::RangeUnitAccumulator(
  double samplingInterval, double pulseWidth, double rangeGate)
  : UnitPathLength(SpeedOfLight * samplingInterval)
  , RelativeWidth(pulseWidth / samplingInterval)
  , GateUnits(unitsInsideGate(samplingInterval, rangeGate))
{
}

void RangeUnitAccumulator::clear()
{
  this->Lengths.clear();
  this->Energies.clear();
  this->Paths.clear();
  this->Units.clear();
  this->EnergyBeyondGate = 0.0;
  this->Requests = 0;
}

void RangeUnitAccumulator::add(const Contribution& contribution)
{
  this->Lengths.push_back(contribution.pathLength);
  this->Energies.push_back(contribution.energy);
  this->Paths.push_back(contribution.path);
}

void RangeUnitAccumulator::add(
  const double* ranges, const double* energies, const std::uint32_t* paths, std::size_t count)
{
  const std::size_t before = this->Lengths.size();
  this->Lengths.resize(before + count);
  for (std::size_t i = 0; i < count; ++i)
  {
    this->Lengths[before + i] = 2.0 * ranges[i];
  }
  this->Energies.insert(this->Energies.end(), energies, energies + count);
  this->Paths.insert(this->Paths.end(), paths, paths + count);
}

double RangeUnitAccumulator::lastUnitOf(double range) const
{
  return std::floor(2.0 * range / this->UnitPathLength + 0.5 * this->RelativeWidth);
}

void RangeUnitAccumulator::sortContributions()
{
  const auto before = [this](std::uint32_t a, std::uint32_t b)
  {
    return std::tie(this->Paths[a], this->Lengths[a], this->Energies[a]) <
      std::tie(this->Paths[b], this->Lengths[b], this->Energies[b]);
  };
  std::vector<std::uint32_t> order(this->Paths.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), before);
  const auto lengths = this->Lengths;
  const auto energies = this->Energies;
  const auto paths = this->Paths;
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    this->Lengths[i] = lengths[order[i]];
    this->Energies[i] = energies[order[i]];
    this->Paths[i] = paths[order[i]];
  }
}

void RangeUnitAccumulator::accumulate()
{
  this->Units.clear();
  this->EnergyBeyondGate = 0.0;
  this->Requests = 0;
  const auto unordered = std::adjacent_find(this->Paths.begin(), this->Paths.end(),
    [](std::uint32_t a, std::uint32_t b) { return a >= b; });
  if (unordered != this->Paths.end())
  {
    this->sortContributions();
  }
  const std::size_t count = this->Lengths.size();
  for (std::vector<double>* v : { &this->Begins, &this->Widths, &this->Firsts, &this->Lasts })
  {
    v->resize(count);
  }
  const Extent extent =
    placeAll(this->Lengths.data(), this->Energies.data(), this->UnitPathLength, this->RelativeWidth,
      this->Begins.data(), this->Widths.data(), this->Firsts.data(), this->Lasts.data(), count);
  if (!(extent.lowest <= extent.highest))
  {
    return;
  }
  const double end = std::min(extent.highest + 1.0, static_cast<double>(this->GateUnits));
  const double window = std::max(0.0, end - extent.lowest);
  const bool narrow = extent.units <= 1.0 && window <= LargestTable;
  narrow ? this->accumulateNarrow(extent.lowest, static_cast<std::size_t>(window))
         : this->accumulateWide();
}

/// Every pulse meets one or two units. @param window units from the lowest that are inside the gate
void RangeUnitAccumulator::accumulateNarrow(double lowest, std::size_t window)
{
  if (this->Sums.size() < window + 1)
  {
    this->Sums.resize(window + 1, 0.0);
    this->Counts.resize(window + 1, 0);
  }
  this->Touched.clear();
  const auto add = [&](double unit, double energy, bool any)
  {
    if (!(unit < static_cast<double>(window)))
    {
      this->EnergyBeyondGate += energy;
      return;
    }
    const auto u = static_cast<std::size_t>(unit);
    if (any && this->Counts[u]++ == 0)
    {
      this->Touched.push_back(static_cast<std::uint32_t>(u));
    }
    this->Sums[u] += energy;
  };
  for (std::size_t c = 0; c < this->Lengths.size(); ++c)
  {
    const double energy = this->Energies[c];
    if (!(energy > 0.0))
    {
      continue;
    }
    const double first = this->Firsts[c];
    if (this->Lasts[c] > first)
    {
      const double share = (first + 1.0 - this->Begins[c]) / this->Widths[c];
      add(first - lowest, energy * share, share > 0.0);
      add(first - lowest + 1.0, energy * (1.0 - share), share < 1.0);
    }
    else
    {
      add(first - lowest, energy, true);
    }
  }
  const auto take = [this, lowest](std::size_t u)
  {
    this->Units.push_back({ static_cast<std::int64_t>(lowest) + static_cast<std::int64_t>(u),
      this->Sums[u], this->Counts[u] });
    this->Sums[u] = 0.0;
    this->Counts[u] = 0;
  };
  if (window < 16 * this->Touched.size())
  {
    for (std::size_t u = 0; u < window; ++u)
    {
      if (this->Counts[u] > 0)
      {
        take(u);
      }
    }
    return;
  }
  std::sort(this->Touched.begin(), this->Touched.end());
  for (const std::uint32_t u : this->Touched)
  {
    take(u);
  }
}

void RangeUnitAccumulator::accumulateWide()
{
  this->spread();
  if (this->Entries.empty())
  {
    return;
  }
  this->sortEntries();
  for (const Entry& entry : this->Entries)
  {
    if (this->Units.empty() || this->Units.back().index != entry.unit)
    {
      this->Units.push_back({ entry.unit, 0.0, 0 });
    }
    this->Units.back().energy += entry.energy;
    ++this->Units.back().paths;
  }
}

void RangeUnitAccumulator::spread()
{
  const double gate = static_cast<double>(this->GateUnits);
  this->Entries.clear();
  for (std::size_t c = 0; c < this->Lengths.size(); ++c)
  {
    const double energy = this->Energies[c];
    if (!(energy > 0.0))
    {
      continue;
    }
    double before = 0.0;
    for (double unit = this->Firsts[c]; unit <= this->Lasts[c] && unit < gate; unit += 1.0)
    {
      const double after =
        unit < this->Lasts[c] ? (unit + 1.0 - this->Begins[c]) / this->Widths[c] : 1.0;
      if (after > before)
      {
        this->Entries.push_back({ static_cast<std::int64_t>(unit), static_cast<std::uint32_t>(c),
          energy * (after - before) });
      }
      before = after;
    }
    this->EnergyBeyondGate += energy * (1.0 - before);
  }
}

void RangeUnitAccumulator::sortEntries()
{
  const auto extremes = std::minmax_element(this->Entries.begin(), this->Entries.end(),
    [](const Entry& a, const Entry& b) { return a.unit < b.unit; });
  const std::int64_t lowest = extremes.first->unit;
  const std::uint64_t window = static_cast<std::uint64_t>(extremes.second->unit - lowest) + 1;
  if (window > 8 * this->Entries.size() + 1024)
  {
    std::sort(this->Entries.begin(), this->Entries.end(),
      [](const Entry& a, const Entry& b)
      { return std::tie(a.unit, a.contribution) < std::tie(b.unit, b.contribution); });
    return;
  }
  std::vector<std::uint32_t>& begins = this->Starts;
  begins.assign(window + 1, 0);
  for (const Entry& entry : this->Entries)
  {
    ++begins[static_cast<std::size_t>(entry.unit - lowest) + 1];
  }
  for (std::size_t u = 1; u <= window; ++u)
  {
    begins[u] += begins[u - 1];
  }
  this->Sorted.resize(this->Entries.size());
  for (const Entry& entry : this->Entries)
  {
    this->Sorted[begins[static_cast<std::size_t>(entry.unit - lowest)]++] = entry;
  }
  this->Entries.swap(this->Sorted);
}

void RangeUnitAccumulator::sharesOf(
  std::int64_t first, std::int64_t last, std::vector<RangeShare>& shares)
{
  shares.clear();
  const double from = static_cast<double>(first);
  const double to = static_cast<double>(last);
  const auto append = [&](std::uint32_t c, double energy) {
    shares.push_back({ energy, this->Lengths[c], this->Paths[c], c });
  };
  if (++this->Requests <= RequestsBeforeSorting)
  {
    const std::size_t count = this->Lengths.size();
    this->Portions.resize(count);
    portionsOfAll(this->Energies.data(), this->Begins.data(), this->Widths.data(),
      this->Firsts.data(), this->Lasts.data(), from, to, this->Portions.data(), count);
    for (std::size_t c = 0; c < count; ++c)
    {
      if (this->Portions[c] > 0.0)
      {
        append(static_cast<std::uint32_t>(c), this->Portions[c]);
      }
    }
    return;
  }
  const auto byFirst = [this](std::uint32_t a, std::uint32_t b)
  { return std::tie(this->Firsts[a], a) < std::tie(this->Firsts[b], b); };
  if (this->Requests == RequestsBeforeSorting + 1)
  {
    this->ByFirst.resize(this->Lengths.size());
    std::iota(this->ByFirst.begin(), this->ByFirst.end(), 0u);
    std::sort(this->ByFirst.begin(), this->ByFirst.end(), byFirst);
  }
  // No pulse overlaps more than RelativeWidth + 2 units.
  const auto firstBelow = [this](std::uint32_t c, double unit) { return this->Firsts[c] < unit; };
  const auto begin = std::lower_bound(this->ByFirst.begin(), this->ByFirst.end(),
    from - std::ceil(this->RelativeWidth) - 2.0, firstBelow);
  const auto end = std::lower_bound(begin, this->ByFirst.end(), to, firstBelow);
  for (auto c = begin; c != end; ++c)
  {
    const double portion = portionOf(this->Energies[*c], this->Begins[*c], this->Widths[*c],
      this->Firsts[*c], this->Lasts[*c], from, to);
    if (portion > 0.0)
    {
      append(*c, portion);
    }
  }
  std::sort(shares.begin(), shares.end(),
    [](const RangeShare& a, const RangeShare& b) { return a.contribution < b.contribution; });
}
}
