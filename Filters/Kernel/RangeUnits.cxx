// SPDX-License-Identifier: BSD-3-Clause
#include "RangeUnits.h"

#include "Sensor.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace avianlidar
{
namespace
{
bool earlier(const Contribution& a, const Contribution& b)
{
  return std::tie(a.path, a.pathLength, a.energy) < std::tie(b.path, b.pathLength, b.energy);
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
  this->Contributions.clear();
  this->Entries.clear();
  this->Units.clear();
  this->Shares.clear();
  this->EnergyBeyondGate = 0.0;
}

void RangeUnitAccumulator::spread()
{
  const double gate = static_cast<double>(this->GateUnits);
  for (std::size_t c = 0; c < this->Contributions.size(); ++c)
  {
    const double energy = this->Contributions[c].energy;
    if (!(energy > 0.0))
    {
      continue;
    }
    const double delay = this->Contributions[c].pathLength / this->UnitPathLength;
    const double begin = delay - 0.5 * this->RelativeWidth;
    const double end = delay + 0.5 * this->RelativeWidth;
    // The width after rounding, so that the shares still add up to 1.
    const double width = end - begin;
    const double firstUnit = std::floor(width > 0.0 ? begin : delay);
    const double lastUnit = width > 0.0 ? std::floor(end) : firstUnit;
    double before = 0.0;
    for (double unit = std::max(0.0, firstUnit); unit <= lastUnit && unit < gate; unit += 1.0)
    {
      const double after = unit < lastUnit ? (unit + 1.0 - begin) / width : 1.0;
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
    // Far apart: a table of units would follow the range, not the hits.
    std::sort(this->Entries.begin(), this->Entries.end(),
      [](const Entry& a, const Entry& b)
      { return std::tie(a.unit, a.contribution) < std::tie(b.unit, b.contribution); });
    return;
  }
  this->Counts.assign(window + 1, 0);
  for (const Entry& entry : this->Entries)
  {
    ++this->Counts[static_cast<std::size_t>(entry.unit - lowest) + 1];
  }
  for (std::size_t u = 1; u <= window; ++u)
  {
    this->Counts[u] += this->Counts[u - 1];
  }
  this->Sorted.resize(this->Entries.size());
  for (const Entry& entry : this->Entries)
  {
    this->Sorted[this->Counts[static_cast<std::size_t>(entry.unit - lowest)]++] = entry;
  }
  this->Entries.swap(this->Sorted);
}

void RangeUnitAccumulator::accumulate()
{
  this->Entries.clear();
  this->Units.clear();
  this->Shares.clear();
  this->EnergyBeyondGate = 0.0;
  if (!std::is_sorted(this->Contributions.begin(), this->Contributions.end(), earlier))
  {
    std::sort(this->Contributions.begin(), this->Contributions.end(), earlier);
  }
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
      this->Units.push_back({ entry.unit, 0.0, this->Shares.size(), this->Shares.size() });
    }
    const Contribution& contribution = this->Contributions[entry.contribution];
    this->Shares.push_back({ entry.energy, contribution.pathLength, contribution.path });
    this->Units.back().energy += entry.energy;
    this->Units.back().last = this->Shares.size();
  }
}
}
