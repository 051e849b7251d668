// SPDX-License-Identifier: BSD-3-Clause
#include "Receiver.h"

#include "LaneSums.h"
#include "ParallelLoop.h"

#include <algorithm>
#include <utility>

namespace avianlidar
{
double perceivedEnergy(double received, double lower, double upper)
{
  return received > lower ? std::min(received, upper) : 0.0;
}

BeamReceiver::BeamReceiver(const Sensor& sensor, const NoisePlan& noise, std::int32_t seed,
  ReturnMode mode, std::int32_t revolution, std::function<bool()> wanted)
  : Instrument(sensor)
  , Radiance(sensor.backgroundRadiance)
  , Errors(sensor, noise.ofRanges)
  , UnitLength(sensor.rangeUnitLength())
  , Lower(sensor.lowerEnergyLimit)
  , Upper(sensor.upperEnergyLimit)
  , Plan(noise)
  , Seed(seed)
  , Revolution(revolution)
  , Mode(mode)
  , Wanted(std::move(wanted))
{
}

void BeamReceiver::receive(std::uint64_t beam, const std::vector<RangeUnit>& units, double radiance)
{
  if (radiance != this->Radiance)
  {
    this->lookAt(radiance);
  }
  this->Noise.begin(this->Plan, this->Seed, beam, this->Revolution);
  this->collectUnits(units);
  this->formReturns();
  this->select();
}

void BeamReceiver::lookAt(double radiance)
{
  const Sensor there = lookingAt(this->Instrument, radiance);
  const bool ofRanges = this->Plan.ofRanges;
  this->Radiance = radiance;
  this->Lower = there.lowerEnergyLimit;
  this->Upper = there.upperEnergyLimit;
  this->Plan = planNoise(there, this->Plan.active);
  this->Plan.ofRanges = ofRanges;
  this->Errors = RangeErrors(there, ofRanges);
}

void BeamReceiver::collectUnits(const std::vector<RangeUnit>& units)
{
  this->Units.clear();
  if (!this->Plan.active)
  {
    this->Units.resize(units.size());
    ReceivedUnit* received = this->Units.data();
    for (const RangeUnit& unit : units)
    {
      received->index = unit.index;
      received->energy = unit.energy;
      received->paths = unit.paths;
      ++received;
    }
    return;
  }
  const auto& alarms = this->Noise.alarms();
  auto alarm = alarms.begin();
  const auto addAlarmsBefore = [&](std::int64_t index, bool all)
  {
    for (; alarm != alarms.end() && (all || *alarm < index); ++alarm)
    {
      const double noise = this->noiseOf(*alarm, 0.0);
      this->Units.push_back({ *alarm, noise, noise, 0 });
    }
  };
  for (const RangeUnit& unit : units)
  {
    addAlarmsBefore(unit.index, false);
    const bool isAlarm = alarm != alarms.end() && *alarm == unit.index;
    alarm += isAlarm ? 1 : 0;
    if (unit.energy < this->Plan.faintLight && !isAlarm && !this->Noise.isRare(unit.index))
    {
      continue;
    }
    const double noise = this->noiseOf(unit.index, unit.energy);
    this->Units.push_back({ unit.index, unit.energy + noise, noise, unit.paths });
  }
  addAlarmsBefore(0, true);
}

double BeamReceiver::noiseOf(std::int64_t unit, double light)
{
  constexpr std::uint64_t interval = 512; // draws of 1e5 photons take 0.1 s
  if (++this->Drawn % interval == 0 && this->Wanted && !this->Wanted())
  {
    throw WorkStopped();
  }
  return this->Noise.energy(unit, light);
}

double BeamReceiver::centreOf(std::int64_t unit) const
{
  return (static_cast<double>(unit) + 0.5) * this->UnitLength;
}

double BeamReceiver::rangeOf(const Return& run, RangeUnitAccumulator& accumulator) const
{
  if (!run.hasLight || this->Mode == ReturnMode::RangeUnits)
  {
    return run.range;
  }
  // Means of differences from the beginning of the first unit, a value near them and below them:
  // the sums then carry no round-off of the range itself, and a unit as long as the scene none of
  // its own.
  const RangeShares shares =
    accumulator.sharesOf(this->Units[run.firstUnit].index, this->Units[run.lastUnit - 1].index + 1);
  const double reference =
    2.0 * this->UnitLength * static_cast<double>(this->Units[run.firstUnit].index);
  const WeightedSum sum = sumShares(shares, accumulator.pathLengths().data(), reference);
  return sum.energy > 0.0 ? 0.5 * (reference + sum.moment / sum.energy) : this->rangeOfNoise(run);
}

double BeamReceiver::measured(const Return& run, double range) const
{
  if (this->Mode == ReturnMode::RangeUnits)
  {
    return range;
  }
  const std::int64_t unit = this->Units[run.strongestUnit].index;
  return this->Errors.measured(
    range, run.energyReceived, this->Errors.hasNoise() ? this->Noise.rangeDeviate(unit) : 0.0);
}

double BeamReceiver::rangeOfNoise(const Return& run) const
{
  double weight = 0.0;
  double moment = 0.0;
  const std::int64_t first = this->Units[run.firstUnit].index;
  for (std::size_t u = run.firstUnit; u < run.lastUnit; ++u)
  {
    const ReceivedUnit& unit = this->Units[u];
    weight += unit.energy;
    moment +=
      unit.energy * (static_cast<double>(unit.index - first) + this->Noise.place(unit.index));
  }
  return (static_cast<double>(first) + moment / weight) * this->UnitLength;
}

void BeamReceiver::formReturns()
{
  this->Returns.clear();
  const bool single = this->Mode == ReturnMode::RangeUnits;
  for (std::size_t u = 0; u < this->Units.size(); ++u)
  {
    const ReceivedUnit& unit = this->Units[u];
    if (!(unit.energy > this->Lower))
    {
      continue;
    }
    const bool continues = !single && !this->Returns.empty() &&
      this->Returns.back().lastUnit == u && this->Units[u - 1].index + 1 == unit.index;
    if (!continues)
    {
      Return run;
      run.firstUnit = run.strongestUnit = u;
      this->Returns.push_back(run);
    }
    Return& run = this->Returns.back();
    run.lastUnit = u + 1;
    run.returnEnergy += unit.energy;
    run.hasLight = run.hasLight || unit.paths > 0;
    if (unit.energy > this->Units[run.strongestUnit].energy)
    {
      run.strongestUnit = u;
    }
  }
  for (std::size_t r = 0; r < this->Returns.size(); ++r)
  {
    Return& run = this->Returns[r];
    run.energyReceived = this->Units[run.strongestUnit].energy;
    run.energy = perceivedEnergy(run.energyReceived, this->Lower, this->Upper);
    if (single || !run.hasLight)
    {
      run.range =
        single ? this->centreOf(this->Units[run.firstUnit].index) : this->rangeOfNoise(run);
    }
    run.returnNumber = static_cast<int>(r) + 1;
    run.numberOfReturns = static_cast<int>(this->Returns.size());
  }
}

void BeamReceiver::select()
{
  this->HasReturn = !this->Returns.empty();
  if (!this->HasReturn)
  {
    return;
  }
  this->Strongest = *std::max_element(this->Returns.begin(), this->Returns.end(),
    [](const Return& a, const Return& b) { return a.energyReceived < b.energyReceived; });
  Return chosen;
  switch (this->Mode)
  {
    case ReturnMode::Strongest:
      chosen = this->Strongest;
      break;
    case ReturnMode::First:
      chosen = this->Returns.front();
      break;
    case ReturnMode::Last:
      chosen = this->Returns.back();
      break;
    case ReturnMode::All:
    case ReturnMode::RangeUnits:
      return;
  }
  this->Returns.assign(1, chosen);
}
}
