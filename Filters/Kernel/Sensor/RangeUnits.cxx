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
/// Where the pulses of a beam's paths lie among its range units, in lanes.
struct PulseLanes
{
  const double* energies; ///< J
  const double* begins;   ///< in units
  const double* widths;   ///< in units
  const double* firsts;   ///< first unit that each pulse overlaps
  const double* lasts;    ///< last unit that each pulse overlaps
  std::size_t count;
};

namespace
{
/// After so many requests for shares a beam's contributions are sorted by their first units, so
/// that a request costs what it returns.
constexpr int RequestsBeforeSorting = 8;

/// Units of the table of sums. Where it holds all of a beam's and no pulse meets more than two,
/// sums are taken in lanes; else it is filled window by window.
constexpr std::size_t LargestTable = 16384;

/// Place of the lowest bit of `bits`, which is not 0.
std::uint32_t lowestBit(std::uint64_t bits)
{
  return static_cast<std::uint32_t>(__builtin_ctzll(bits));
}

/// What the pulses of a beam that have energy have in common.
struct PulseExtent
{
  double lowest;  ///< unit
  double highest; ///< unit; below the lowest where there is no energy
  double units;   ///< most that one pulse overlaps, less one
};

/// Energy of a pulse inside units [first, last).
AVIANLIDAR_ALWAYS_INLINE double portionOfPulse(double energy, double begin, double width,
  double pulseFirst, double pulseLast, double first, double last)
{
  const double from = pulseFirst >= first ? 0.0 : (first - begin) / width;
  const double to = pulseLast < last ? 1.0 : (last - begin) / width;
  const double portion = energy * (to - from);
  const bool meets = (pulseFirst < last) & (pulseLast >= first) & (portion > 0.0);
  return meets ? portion : 0.0;
}

/// Place `count` pulses by the lengths of their paths. @param unitPathLength m @param relativeWidth
/// of a pulse, in units
AVIANLIDAR_MULTIVERSION PulseExtent placePulses(const double* lengths, const double* energies,
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

/// Halve pulses that meet two units at most: the first of them, counted from the lowest and at most
/// `window`, and what this one and the next get.
AVIANLIDAR_MULTIVERSION void halvePulses(const PulseLanes& pulses, double lowest, double window,
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

/// Energies of all pulses inside units [first, last).
AVIANLIDAR_MULTIVERSION void portionsOfPulses(
  const PulseLanes& pulses, double first, double last, double* portions)
{
  const PulseLanes p = pulses;
#pragma omp simd
  for (std::size_t c = 0; c < p.count; ++c)
  {
    portions[c] =
      portionOfPulse(p.energies[c], p.begins[c], p.widths[c], p.firsts[c], p.lasts[c], first, last);
  }
}

/// The same of pulses that were halved. @param first, last counted from the lowest
AVIANLIDAR_MULTIVERSION void portionsOfHalves(const double* energies, const std::uint32_t* places,
  const double* here, const double* next, double first, double last, double* portions,
  std::size_t count)
{
#pragma omp simd
  for (std::size_t c = 0; c < count; ++c)
  {
    const double place = static_cast<double>(static_cast<std::int32_t>(places[c]));
    const double one = ((place >= first) & (place < last)) ? here[c] : 0.0;
    const double two = ((place + 1.0 >= first) & (place + 1.0 < last)) ? next[c] : 0.0;
    portions[c] = ((place >= first) & (place + 1.0 < last)) ? energies[c] : one + two;
  }
}
}

std::int64_t unitsInsideGate(double samplingInterval, double rangeGate)
{
  // checkSensor() refuses more than MaximumGateUnits.
  const double units = std::ceil(2.0 * rangeGate / (SpeedOfLight * samplingInterval));
  return static_cast<std::int64_t>(std::clamp(units, 1.0, MaximumGateUnits));
}

std::int64_t firstUnitInsideGate(double samplingInterval, double minimumRange)
{
  return static_cast<std::int64_t>(
    std::min(MaximumGateUnits, std::floor(2.0 * minimumRange / (SpeedOfLight * samplingInterval))));
}

RangeUnitAccumulator::RangeUnitAccumulator(
  double samplingInterval, double pulseWidth, double rangeGate, double minimumRange)
  : UnitPathLength(SpeedOfLight * samplingInterval)
  , RelativeWidth(pulseWidth / samplingInterval)
  , GateUnits(unitsInsideGate(samplingInterval, rangeGate))
  , LeastLength(2.0 * minimumRange)
{
}

void RangeUnitAccumulator::clear()
{
  this->Lengths.clear();
  this->Energies.clear();
  this->EnergyBeforeGate = 0.0;
  this->clearUnits();
}

void RangeUnitAccumulator::clearUnits()
{
  this->Units.clear();
  this->EnergyBeyondGate = 0.0;
  this->Narrow = false;
  this->Requests = 0;
  this->ByFirst.clear();
}

/// The energy of a path, or 0 if it arrives before the gate.
double RangeUnitAccumulator::recorded(double length, double energy)
{
  const bool isEarly = length < this->LeastLength;
  this->EnergyBeforeGate += isEarly ? energy : 0.0;
  return isEarly ? 0.0 : energy;
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
  for (std::size_t i = 0; i < count; ++i)
  {
    this->Lengths[before + i] = 2.0 * ranges[i];
    this->Energies[before + i] = this->recorded(2.0 * ranges[i], energies[i]);
  }
}

double RangeUnitAccumulator::lastUnitOf(double range) const
{
  return std::floor(2.0 * range / this->UnitPathLength + 0.5 * this->RelativeWidth);
}

PulseLanes RangeUnitAccumulator::pulses() const
{
  return { this->Energies.data(), this->Begins.data(), this->Widths.data(), this->Firsts.data(),
    this->Lasts.data(), this->Lengths.size() };
}

void RangeUnitAccumulator::accumulate()
{
  this->clearUnits();
  const std::size_t count = this->Lengths.size();
  for (std::vector<double>* v : { &this->Begins, &this->Widths, &this->Firsts, &this->Lasts })
  {
    v->resize(count);
  }
  const PulseExtent extent = placePulses(this->Lengths.data(), this->Energies.data(),
    this->UnitPathLength, this->RelativeWidth, this->Begins.data(), this->Widths.data(),
    this->Firsts.data(), this->Lasts.data(), count);
  if (!(extent.lowest <= extent.highest))
  {
    return;
  }
  const double end = std::min(extent.highest + 1.0, static_cast<double>(this->GateUnits));
  const double window = std::max(0.0, end - extent.lowest);
  this->Narrow = extent.units <= 1.0 && window <= static_cast<double>(LargestTable);
  if (this->Narrow)
  {
    this->accumulateNarrow(extent.lowest, static_cast<std::uint32_t>(window));
  }
  else
  {
    this->accumulateWide(extent.lowest);
  }
}

/// Every pulse meets one or two units. @param window units from the lowest that are inside the
/// gate; what lies beyond goes to a cell of its own
void RangeUnitAccumulator::accumulateNarrow(double lowest, std::uint32_t window)
{
  const std::size_t count = this->Lengths.size();
  this->Places.resize(count);
  this->Here.resize(count);
  this->Next.resize(count);
  if (this->Table.size() < window + 1)
  {
    this->Table.resize(window + 1);
    this->Marks.resize(window / 64 + 1, 0);
  }
  halvePulses(
    this->pulses(), lowest, window, this->Places.data(), this->Here.data(), this->Next.data());
  Cell* const table = this->Table.data();
  for (std::size_t c = 0; c < count; ++c)
  {
    const std::uint32_t place = this->Places[c];
    const double here = this->Here[c];
    const double next = this->Next[c];
    Cell& one = table[place];
    one.energy += here;
    one.paths += here > 0.0;
    Cell& two = table[place < window ? place + 1 : window];
    two.energy += next;
    two.paths += next > 0.0;
    this->Marks[place / 64] |= std::uint64_t{ 1 } << (place % 64);
  }
  this->LowestNarrow = lowest;
  this->EnergyBeyondGate = table[window].energy;
  this->takeCells(static_cast<std::int64_t>(lowest), window);
}

/// From the table to the list of units.
void RangeUnitAccumulator::takeCells(std::int64_t lowest, std::uint32_t window)
{
  const auto take = [&](std::uint32_t place)
  {
    Cell& cell = this->Table[place];
    if (place < window && cell.paths > 0)
    {
      RangeUnit& unit = this->Units.emplace_back();
      unit.index = lowest + place;
      unit.energy = cell.energy;
      unit.paths = cell.paths;
    }
    cell = Cell();
  };
  for (std::uint32_t word = 0; word <= window / 64; ++word)
  {
    for (std::uint64_t left = this->Marks[word]; left != 0; left &= left - 1)
    {
      const std::uint32_t place = 64 * word + lowestBit(left);
      take(place);
      take(std::min(place + 1, window));
    }
    this->Marks[word] = 0;
  }
}

/// Pulses that meet many units, or units far apart: a window of the table after the other, so that
/// memory follows what is found, not pulses times the units that each of them meets.
void RangeUnitAccumulator::accumulateWide(double lowest)
{
  this->sumBeyondGate();
  this->sortByFirst();
  this->Table.resize(std::max<std::size_t>(this->Table.size(), LargestTable + 1));
  this->Marks.resize(std::max<std::size_t>(this->Marks.size(), LargestTable / 64 + 1), 0);
  const double gate = static_cast<double>(this->GateUnits);
  std::size_t next = 0;
  double from = lowest;
  while (from < gate)
  {
    const double to = std::min(from + static_cast<double>(LargestTable), gate);
    const double farthest = this->addToTable(from, to, next);
    this->takeCells(static_cast<std::int64_t>(from), static_cast<std::uint32_t>(to - from));
    const auto after = std::lower_bound(this->ByFirst.begin(), this->ByFirst.end(), to,
      [this](std::uint32_t c, double unit) { return this->Firsts[c] < unit; });
    const double begin =
      after != this->ByFirst.end() ? this->Firsts[*after] : std::numeric_limits<double>::infinity();
    from = farthest >= to ? to : begin;
  }
}

/// What arrives too late.
void RangeUnitAccumulator::sumBeyondGate()
{
  const double gate = static_cast<double>(this->GateUnits);
  for (std::size_t c = 0; c < this->Lengths.size(); ++c)
  {
    if (this->Energies[c] > 0.0 && this->Lasts[c] >= gate)
    {
      const double inside =
        this->Firsts[c] < gate ? (gate - this->Begins[c]) / this->Widths[c] : 0.0;
      this->EnergyBeyondGate += this->Energies[c] * (1.0 - inside);
    }
  }
}

/// Add what pulses put into units [from, to) to the table, in the order of their numbers. @param
/// next in ByFirst, the first that may reach `from`: moved on @return the last unit that one of
/// them meets
double RangeUnitAccumulator::addToTable(double from, double to, std::size_t& next)
{
  const double reach = std::ceil(this->RelativeWidth) + 2.0; // more units than any pulse overlaps
  while (next < this->ByFirst.size() && this->Firsts[this->ByFirst[next]] + reach < from)
  {
    ++next;
  }
  double farthest = from;
  this->Few.clear();
  for (std::size_t i = next; i < this->ByFirst.size() && this->Firsts[this->ByFirst[i]] < to; ++i)
  {
    const std::uint32_t c = this->ByFirst[i];
    if (this->Energies[c] > 0.0 && this->Lasts[c] >= from)
    {
      this->Few.push_back(c);
      farthest = std::max(farthest, this->Lasts[c]);
    }
  }
  std::sort(this->Few.begin(), this->Few.end());
  for (const std::uint32_t c : this->Few)
  {
    const double first = std::max(this->Firsts[c], from);
    const double last = std::min(this->Lasts[c], to - 1.0);
    double before = first > this->Firsts[c] ? (first - this->Begins[c]) / this->Widths[c] : 0.0;
    for (double unit = first; unit <= last; unit += 1.0)
    {
      const double after =
        unit < this->Lasts[c] ? (unit + 1.0 - this->Begins[c]) / this->Widths[c] : 1.0;
      if (after > before)
      {
        const auto place = static_cast<std::uint32_t>(unit - from);
        this->Table[place].energy += this->Energies[c] * (after - before);
        ++this->Table[place].paths;
        this->Marks[place / 64] |= std::uint64_t{ 1 } << (place % 64);
      }
      before = after;
    }
  }
  return farthest;
}

void RangeUnitAccumulator::sortByFirst()
{
  this->ByFirst.resize(this->Lengths.size());
  std::iota(this->ByFirst.begin(), this->ByFirst.end(), 0u);
  std::sort(this->ByFirst.begin(), this->ByFirst.end(),
    [this](std::uint32_t a, std::uint32_t b)
    { return std::tie(this->Firsts[a], a) < std::tie(this->Firsts[b], b); });
}

RangeShares RangeUnitAccumulator::sharesOf(std::int64_t first, std::int64_t last)
{
  if (this->Requests == 0 || first != this->ShareFirst || last != this->ShareLast)
  {
    ++this->Requests;
    this->ShareFirst = first;
    this->ShareLast = last;
    this->FewAsked = this->Requests > RequestsBeforeSorting;
    const double from = static_cast<double>(first);
    const double to = static_cast<double>(last);
    if (this->FewAsked)
    {
      this->findSharesAmongFew(from, to);
    }
    else
    {
      this->findShares(from, to);
    }
  }
  return { this->Portions.data(), this->FewAsked ? this->Few.data() : nullptr,
    this->Portions.size() };
}

/// By a look at every contribution.
void RangeUnitAccumulator::findShares(double from, double to)
{
  const std::size_t count = this->Lengths.size();
  this->Portions.resize(count);
  if (this->Narrow)
  {
    portionsOfHalves(this->Energies.data(), this->Places.data(), this->Here.data(),
      this->Next.data(), from - this->LowestNarrow, to - this->LowestNarrow, this->Portions.data(),
      count);
    return;
  }
  portionsOfPulses(this->pulses(), from, to, this->Portions.data());
}

/// By a look at those that begin near.
void RangeUnitAccumulator::findSharesAmongFew(double from, double to)
{
  if (this->ByFirst.size() != this->Lengths.size())
  {
    this->sortByFirst();
  }
  // No pulse overlaps more than RelativeWidth + 2 units.
  const auto firstBelow = [this](std::uint32_t c, double unit) { return this->Firsts[c] < unit; };
  const auto begin = std::lower_bound(this->ByFirst.begin(), this->ByFirst.end(),
    from - std::ceil(this->RelativeWidth) - 2.0, firstBelow);
  const auto end = std::lower_bound(begin, this->ByFirst.end(), to, firstBelow);
  this->FewPortions.clear();
  for (auto c = begin; c != end; ++c)
  {
    const double energy = portionOfPulse(this->Energies[*c], this->Begins[*c], this->Widths[*c],
      this->Firsts[*c], this->Lasts[*c], from, to);
    if (energy > 0.0)
    {
      this->FewPortions.push_back({ *c, energy });
    }
  }
  std::sort(this->FewPortions.begin(), this->FewPortions.end(),
    [](const Portion& a, const Portion& b) { return a.contribution < b.contribution; });
  this->Few.clear();
  this->Portions.clear();
  for (const Portion& portion : this->FewPortions)
  {
    this->Few.push_back(portion.contribution);
    this->Portions.push_back(portion.energy);
  }
}
}
