// SPDX-License-Identifier: BSD-3-Clause
#include "RangeUnits.h"

#include "Multiversion.h"
#include "Sensor.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
/// Number of units of the table.
constexpr double TableUnits = 16384.0;

/// First and last unit that pulses with energy meet. The last is below the first if no pulse has
/// energy.
struct PulseExtent
{
  double lowest;
  double highest;
};

/// Place `count` pulses by the lengths of their paths. @param unitPathLength length of path of a
/// unit, m @param before, after extent of a pulse around its delay, units @param heads gets the
/// part of each pulse in its first unit
AVIANLIDAR_MULTIVERSION PulseExtent placePulses(const double* lengths, const double* energies,
  double unitPathLength, double before, double after, double* begins, double* widths,
  double* firsts, double* lasts, double* heads, std::size_t count)
{
  double lowest = Infinity;
  double highest = -Infinity;
#pragma omp simd reduction(min : lowest) reduction(max : highest)
  for (std::size_t c = 0; c < count; ++c)
  {
    const double delay = lengths[c] / unitPathLength;
    const double begin = delay - before;
    const double end = delay + after;
    // The width is taken after rounding, so that the shares still add up to 1.
    const double width = end - begin;
    const bool wide = width > 0.0;
    const double first = std::floor(wide ? begin : delay);
    const double last = wide ? std::floor(end) : first;
    begins[c] = begin;
    widths[c] = width;
    firsts[c] = first > 0.0 ? first : 0.0;
    lasts[c] = last;
    const bool both = last > firsts[c];
    const double head = (firsts[c] + 1.0 - begin) / (both ? width : 1.0);
    heads[c] = both ? head : 1.0;
    const bool counts = energies[c] > 0.0;
    const double low = counts ? firsts[c] : Infinity;
    const double high = counts ? last : -Infinity;
    lowest = low < lowest ? low : lowest;
    highest = high > highest ? high : highest;
  }
  return { lowest, highest };
}
}

RangeUnitAccumulator::RangeUnitAccumulator(
  double samplingInterval, double pulseWidth, double rangeGate, double minimumRange)
  : UnitPathLength(SpeedOfLight * samplingInterval)
  , Pulse(pulseWidth / samplingInterval)
  , GateUnits(unitsInsideGate(samplingInterval, rangeGate))
  , LeastLength(2.0 * minimumRange)
  , MostLength(2.0 * rangeGate)
{
}

RangeUnitAccumulator::RangeUnitAccumulator(const Sensor& sensor, double parts)
  : RangeUnitAccumulator(
      sensor.samplingInterval / parts, 0.0, sensor.rangeGate, sensor.minimumRange)
{
  this->Pulse = ReceivedPulse(sensor, sensor.samplingInterval / parts);
  this->GateUnits =
    static_cast<std::int64_t>(parts) * unitsInsideGate(sensor.samplingInterval, sensor.rangeGate);
}

void RangeUnitAccumulator::clear()
{
  this->Lengths.clear();
  this->Energies.clear();
  this->Units.clear();
  this->EnergyBeforeGate = 0.0;
  this->EnergyBeyondGate = 0.0;
  this->LateEnergy = 0.0;
}

/// The energy of a path, or 0 if its range lies outside the gate.
double RangeUnitAccumulator::recorded(double length, double energy)
{
  const bool isEarly = length < this->LeastLength;
  const bool isLate = length > this->MostLength;
  this->EnergyBeforeGate += isEarly ? energy : 0.0;
  this->LateEnergy += isLate ? energy : 0.0;
  return isEarly || isLate ? 0.0 : energy;
}

void RangeUnitAccumulator::add(const Contribution& contribution)
{
  this->Lengths.push_back(contribution.pathLength);
  this->Energies.push_back(this->recorded(contribution.pathLength, contribution.energy));
}

void RangeUnitAccumulator::add(const double* ranges, const double* energies, std::size_t count)
{
  const std::size_t before = this->Lengths.size();
  this->Lengths.resize(before + count);
  this->Energies.resize(before + count);
  bool outside = false;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double length = 2.0 * ranges[i];
    this->Lengths[before + i] = length;
    outside |= (length < this->LeastLength) | (length > this->MostLength);
  }
  std::copy_n(energies, count, this->Energies.begin() + static_cast<std::ptrdiff_t>(before));
  for (std::size_t i = before; outside && i < before + count; ++i)
  {
    this->Energies[i] = this->recorded(this->Lengths[i], this->Energies[i]);
  }
}

double RangeUnitAccumulator::lastUnitOf(double range) const
{
  return std::floor(2.0 * range / this->UnitPathLength + this->Pulse.after());
}

double RangeUnitAccumulator::mostAround(std::size_t number) const
{
  auto unit = std::lower_bound(this->Units.begin(), this->Units.end(), this->Firsts[number],
    [](const RangeUnit& one, double index) { return static_cast<double>(one.index) < index; });
  double most = 0.0;
  for (; unit != this->Units.end() && unit->index <= this->Lasts[number]; ++unit)
  {
    most = std::max(most, unit->energy);
  }
  return most;
}

/// Add what pulses put into units [from, to). @return the next unit that a pulse meets, or infinity
template <bool IsRectangle>
double RangeUnitAccumulator::addWindow(double from, double to)
{
  const auto window = static_cast<std::size_t>(to - from);
  this->Table.resize(std::max(this->Table.size(), window));
  this->Marks.resize((this->Table.size() + 63) / 64, 0);
  double next = Infinity;
  for (std::size_t c = 0; c < this->Lengths.size(); ++c)
  {
    const double first = this->Firsts[c];
    const double last = this->Lasts[c];
    const auto shareUpTo = [&](double unit)
    {
      const double part = (unit - this->Begins[c]) / this->Widths[c];
      return IsRectangle ? part : this->Pulse.shareOf(part);
    };
    if (!(this->Energies[c] > 0.0) || last < from)
    {
      continue;
    }
    if (last >= to)
    {
      next = std::min(next, std::max(first, to));
    }
    if (first >= to)
    {
      continue;
    }
    double unit = std::max(first, from);
    double before = unit > first ? shareUpTo(unit) : 0.0;
    auto place = static_cast<std::size_t>(static_cast<std::int64_t>(unit - from));
    for (; unit <= last && place < window; unit += 1.0, ++place)
    {
      const double after = !(unit < last) ? 1.0
        : unit > first                    ? shareUpTo(unit + 1.0)
                                          : this->Heads[c]; // portion of the first unit
      const bool hasShare = after > before;
      this->Table[place].energy += hasShare ? this->Energies[c] * (after - before) : 0.0;
      this->Table[place].paths += hasShare;
      this->Marks[place / 64] |= std::uint64_t{ hasShare } << (place % 64);
      before = after;
    }
  }
  for (std::size_t word = 0; 64 * word < window; ++word)
  {
    for (std::uint64_t left = this->Marks[word]; left != 0; left &= left - 1)
    {
      const std::size_t place = 64 * word + static_cast<std::size_t>(__builtin_ctzll(left));
      RangeUnit& sum = this->Table[place];
      this->Units.push_back({ static_cast<std::int64_t>(from) + static_cast<std::int64_t>(place),
        sum.energy, sum.paths });
      sum = RangeUnit();
    }
    this->Marks[word] = 0;
  }
  return next;
}

void RangeUnitAccumulator::accumulate()
{
  this->Units.clear();
  this->EnergyBeyondGate = this->LateEnergy;
  const std::size_t count = this->Lengths.size();
  for (std::vector<double>* v :
    { &this->Begins, &this->Widths, &this->Firsts, &this->Lasts, &this->Heads })
  {
    v->resize(count);
  }
  const PulseExtent extent = placePulses(this->Lengths.data(), this->Energies.data(),
    this->UnitPathLength, this->Pulse.before(), this->Pulse.after(), this->Begins.data(),
    this->Widths.data(), this->Firsts.data(), this->Lasts.data(), this->Heads.data(), count);
  if (!this->Pulse.isRectangle())
  {
    std::transform(this->Heads.begin(), this->Heads.end(), this->Heads.begin(),
      [this](double part) { return this->Pulse.shareOf(part); });
  }
  const double gate = static_cast<double>(this->GateUnits);
  for (std::size_t c = 0; extent.highest >= gate && c < count; ++c)
  {
    if (this->Energies[c] > 0.0 && this->Lasts[c] >= gate)
    {
      const double inside = this->Firsts[c] < gate
        ? this->Pulse.shareOf((gate - this->Begins[c]) / this->Widths[c])
        : 0.0;
      this->EnergyBeyondGate += this->Energies[c] * (1.0 - inside);
    }
  }
  const double end = std::min(extent.highest + 1.0, gate);
  for (double from = extent.lowest; from < end;)
  {
    const double to = std::min(from + TableUnits, end);
    from = this->Pulse.isRectangle() ? this->addWindow<true>(from, to)
                                     : this->addWindow<false>(from, to);
  }
}
}
