// SPDX-License-Identifier: BSD-3-Clause
#include "Receiver.h"

#include "ParallelLoop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace avianlidar
{
namespace
{
/// Of a unit's variance: from there on drops are drawn.
constexpr double DropsCount = 0.01;
}

double perceivedEnergy(double received, double lower, double upper)
{
  return received > lower ? std::min(received, upper) : 0.0;
}

BeamReceiver::BeamReceiver(const Sensor& sensor, const NoisePlan& noise, std::int32_t seed,
  ReturnMode mode, std::int32_t revolution, std::function<bool()> wanted, AirEcho air)
  : Instrument(sensor)
  , Radiance(sensor.backgroundRadiance)
  , Errors(sensor, noise.ofRanges)
  , UnitLength(sensor.rangeUnitLength())
  , Lower(sensor.lowerEnergyLimit)
  , Upper(sensor.upperEnergyLimit)
  , Plan(noise)
  , Air(std::move(air))
  , FollowsAir(sensor.followsAir())
  , Photons(sensor)
  , Drops(this->Air.pulse())
  , Seed(seed)
  , Revolution(revolution)
  , Mode(mode)
  , Wanted(std::move(wanted))
{
  if (this->Air.any())
  {
    this->planAir();
  }
}

/// Find the units in which the air alone may be perceived, and from where on drops matter there. A
/// brighter background than the sensor's raises what is needed.
void BeamReceiver::planAir()
{
  for (std::int64_t unit = 0; unit < this->Air.units(); ++unit)
  {
    const double mean = this->Air.mean(unit);
    const double variance = this->Plan.darkVariance + this->Plan.varianceOfEnergy * mean;
    const bool hasDrops = this->Plan.active && this->Air.variance(unit) > DropsCount * variance;
    if (hasDrops || (!this->FollowsAir && mean > 1e-6 * this->Lower))
    {
      this->AirLooked = unit + 1;
    }
  }
}

/// The lower limit of a unit, J. @param air mean of what the air sends back, J
double BeamReceiver::lowerIn(double air) const
{
  return this->FollowsAir
    ? this->Lower * this->Photons.growthInAir(this->Photons.electronsPerJoule * air)
    : this->Lower;
}

void BeamReceiver::receive(
  std::uint64_t beam, const std::vector<RangeUnit>& units, double radiance, BeamAir* along)
{
  this->Along = along;
  if (radiance != this->Radiance)
  {
    this->lookAt(radiance);
  }
  this->Noise.begin(this->Plan, this->Seed, beam, this->Revolution);
  this->Beam = beam;
  this->Gaps.clear();
  this->Drops.clear();
  if (this->Plan.active && along && along->isLocal())
  {
    this->Gaps.begin(*along, this->Instrument.solidAngle(), this->Seed, beam, this->Revolution);
  }
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
  this->Photons = PhotonReceiver(there);
}

void BeamReceiver::collectUnits(const std::vector<RangeUnit>& units)
{
  this->Units.clear();
  const bool isLocal = this->Along && this->Along->isLocal();
  if (!this->mayAlarm() && !isLocal)
  {
    this->Units.resize(units.size());
    ReceivedUnit* received = this->Units.data();
    for (const RangeUnit& unit : units)
    {
      received->index = unit.index;
      received->energy = unit.energy;
      received->paths = unit.paths;
      received->lower = this->Lower;
      received->upper = this->Upper;
      ++received;
    }
    return;
  }
  const auto& alarms = this->Noise.alarms();
  auto alarm = alarms.begin();
  auto lit = units.begin();
  constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  const auto lookedFrom = [&](std::int64_t unit) {
    return isLocal ? this->Along->nextLooked(unit) : unit < this->AirLooked ? unit : none;
  };
  std::int64_t next = lookedFrom(0); // of those in which the air alone may be perceived
  while (next < none || lit != units.end() || alarm != alarms.end())
  {
    const std::int64_t index = std::min(
      { next, lit != units.end() ? lit->index : none, alarm != alarms.end() ? *alarm : none });
    const bool isAlarm = alarm != alarms.end() && *alarm == index;
    const bool isLit = lit != units.end() && lit->index == index;
    const double light = isLit ? lit->energy * this->openAt(index) : 0.0;
    const bool hasAir = isLocal ? index == next || !this->FollowsAir : this->Air.mean(index) > 0.0;
    if (isAlarm || hasAir || !(light < this->Plan.faintLight) || this->Noise.isRare(index))
    {
      this->addUnit(index, light, isLit ? lit->paths : 0, isAlarm);
    }
    alarm += isAlarm ? 1 : 0;
    lit += isLit ? 1 : 0;
    next = next == none ? none : lookedFrom(std::max(next, index + 1));
  }
}

/// The mean, J, of the air's light that a threshold may follow.
double BeamReceiver::followedNow(std::int64_t unit)
{
  return this->Along ? this->followedIn(*this->Along, unit) : this->Air.mean(unit);
}

/// What drops return in a unit beyond their mean, J.
double BeamReceiver::fromDrops(std::int64_t unit)
{
  const bool isLocal = this->Along && this->Along->isLocal();
  return this->Drops.in(unit,
    [&](std::int64_t of, double* units)
    {
      if (isLocal)
      {
        this->drawLocalDrops(of, units);
      }
      else if (of < this->AirLooked)
      {
        const double open = this->Along ? this->Along->open(of) : 1.0;
        this->Air.addBeyondMean(this->Seed, this->Beam, of, this->Revolution, open, units);
      }
    });
}

/// Variance of the noise of a unit with what media return there, J^2.
double BeamReceiver::varianceWith(const std::vector<BeamAir::Share>& shares) const
{
  double all = 0.0;
  for (const BeamAir::Share& share : shares)
  {
    all += share.mean;
  }
  return this->Plan.darkVariance + this->Plan.varianceOfEnergy * all;
}

/// Add what drops of media that do not fill the scene, and of what is with them, return beyond
/// their mean, to the units that they reach.
void BeamReceiver::drawLocalDrops(std::int64_t unit, double* units)
{
  const std::vector<BeamAir::Share>& shares = this->Along->sharesOf(unit);
  const double variance = this->varianceWith(shares);
  for (const BeamAir::Share& share : shares)
  {
    const Medium& medium = this->Along->mediumAt(share.medium);
    const double ofDrops = share.mean * share.mean * medium.squareOfDrops;
    if (medium.isFollowed && ofDrops > DropsCount * variance * share.drops)
    {
      const auto number = static_cast<std::uint64_t>(unit) +
        static_cast<std::uint64_t>(AirEcho::MostUnits) * share.medium;
      addDropsBeyondMean(this->Seed, this->Beam, number, this->Revolution,
        this->openAt(unit) * share.mean, share.drops, medium, this->Air.pulse(), units);
    }
  }
}

/// What media that do not fill the scene, and what is with them, return in a unit. @param beyond
/// the mean, J, of those that a threshold follows @param received gets the light of the others
void BeamReceiver::drawLocal(std::int64_t unit, double& beyond, ReceivedUnit& received)
{
  const std::vector<BeamAir::Share>& shares = this->Along->sharesOf(unit);
  const double from = static_cast<double>(unit) * this->UnitLength;
  const double open = this->openAt(unit);
  const double variance = this->varianceWith(shares);
  double most = 0.0;
  for (const BeamAir::Share& share : shares)
  {
    const Medium& medium = this->Along->mediumAt(share.medium);
    const double ofDrops =
      share.drops > 0.0 ? share.mean * share.mean * medium.squareOfDrops / share.drops : 0.0;
    const bool isLeaves = medium.sharesGaps && this->Gaps.any();
    double energy = isLeaves
      ? this->Gaps.returnedBetween(from, from + this->UnitLength, share.medium)
      : open * share.mean;
    if (!isLeaves && this->Plan.active && !medium.isFollowed && ofDrops > DropsCount * variance)
    {
      const auto number = static_cast<std::uint64_t>(unit) +
        static_cast<std::uint64_t>(AirEcho::MostUnits) * share.medium;
      double leaves = energy;
      addDropsBeyondMean(this->Seed, this->Beam, number, this->Revolution, energy, share.drops,
        medium, PulseShares(), &leaves);
      energy = std::max(0.0, leaves);
    }
    if (medium.isFollowed)
    {
      beyond += energy - share.mean;
      continue;
    }
    received.leaves += energy;
    if (energy > most)
    {
      most = energy;
      received.medium = medium.objectId;
    }
  }
  beyond += this->Plan.active ? this->fromDrops(unit) : 0.0;
}

/// Add a unit, unless noise and drops are too common for it to be perceived.
void BeamReceiver::addUnit(std::int64_t index, double light, std::uint32_t paths, bool alarm)
{
  const bool gaussian = this->Plan.gaussian;
  const double mean = this->followedNow(index);
  double beyond = 0.0;
  ReceivedUnit unit;
  if (this->Along && this->Along->isLocal())
  {
    this->drawLocal(index, beyond, unit);
    light += unit.leaves;
  }
  else if (this->Plan.active && index < this->AirLooked)
  {
    beyond = this->fromDrops(index);
  }
  const double all = light + std::max(0.0, mean + beyond);
  const double off = this->FollowsAir ? mean : 0.0;
  const double lower = this->lowerIn(mean);
  const double most = all - off +
    CommonDeviate * std::sqrt(this->Plan.darkVariance + this->Plan.varianceOfEnergy * all);
  if (gaussian && !alarm && !(most > lower) && !this->Noise.isRare(index))
  {
    return;
  }
  const double noise = this->Plan.active ? this->noiseOf(index, all) : 0.0;
  unit.index = index;
  unit.energy = all - off + noise;
  unit.noise = noise;
  unit.paths = paths;
  unit.air = all - light - off;
  unit.lower = lower;
  unit.upper = this->Upper - off;
  this->Units.push_back(unit);
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

/// Light of what stands in a unit or behind, over its mean, that leaves before it let through.
double BeamReceiver::openAt(std::int64_t unit) const
{
  return this->Gaps.any() ? this->Gaps.openAt(this->centreOf(unit)) : 1.0;
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
  const std::vector<double>& lengths = accumulator.pathLengths();
  const WeightedSum sum =
    sumShares(shares, [&](std::size_t s) { return lengths[shares.contribution[s]] - reference; });
  return sum.energy > 0.0 ? 0.5 * (reference + sum.moment / sum.energy) : this->rangeOfNoise(run);
}

double BeamReceiver::measured(const Return& run, double range) const
{
  if (this->Mode == ReturnMode::RangeUnits)
  {
    return range;
  }
  const ReceivedUnit& unit = this->Units[run.strongestUnit];
  // Noise of the air makes an echo count for less.
  const double share = unit.lower > this->Lower ? this->Lower / unit.lower : 1.0;
  return this->Errors.measured(range, run.energyReceived * share,
    this->Errors.hasNoise() ? this->Noise.rangeDeviate(unit.index) : 0.0);
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
    if (!(unit.energy > unit.lower) || !(unit.upper >= unit.lower))
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
    run.air += unit.air;
    if (unit.leaves > 0.0)
    {
      const double at = static_cast<double>(unit.index) + this->Noise.place(unit.index);
      run.rangeOfLeaves = (run.leaves * run.rangeOfLeaves + unit.leaves * at * this->UnitLength) /
        (run.leaves + unit.leaves);
      run.leaves += unit.leaves;
    }
    run.hasLight = run.hasLight || unit.paths > 0;
    if (unit.energy > this->Units[run.strongestUnit].energy)
    {
      run.strongestUnit = u;
    }
  }
  for (std::size_t r = 0; r < this->Returns.size(); ++r)
  {
    Return& run = this->Returns[r];
    const ReceivedUnit& strongest = this->Units[run.strongestUnit];
    run.energyReceived = strongest.energy;
    double most = 0.0;
    for (std::size_t u = run.firstUnit; u < run.lastUnit; ++u)
    {
      const ReceivedUnit& unit = this->Units[u];
      run.medium = unit.leaves > most ? unit.medium : run.medium;
      most = std::max(most, unit.leaves);
    }
    run.energy = perceivedEnergy(run.energyReceived, strongest.lower, strongest.upper);
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
