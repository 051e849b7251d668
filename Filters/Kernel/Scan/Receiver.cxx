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
/// Drops are drawn where their variance exceeds this share of the variance of the unit's noise.
constexpr double DropsCount = 0.01;

/// Variance of the light that a medium returns in a unit, by the number and size of its drops, J^2.
double varianceOfDrops(const BeamAir::Share& share, const Medium& medium)
{
  return share.drops > 0.0 ? share.mean * share.mean * medium.squareOfDrops / share.drops : 0.0;
}
}

double perceivedEnergy(double received, double lower, double upper)
{
  return received > lower ? std::min(received, upper) : 0.0;
}

BeamReceiver::BeamReceiver(const Sensor& sensor, const NoisePlan& noise, std::int32_t seed,
  ReturnMode mode, std::int32_t revolution, std::function<bool()> wanted, BeamAir* air,
  const LeafGaps* gaps)
  : Instrument(sensor)
  , Radiance(sensor.backgroundRadiance)
  , Errors(sensor, noise.ofRanges)
  , UnitLength(sensor.rangeUnitLength())
  , Gate{ sensor.minimumRange, sensor.rangeGate }
  , Lower(sensor.lowerEnergyLimit)
  , Upper(sensor.upperEnergyLimit)
  , Plan(noise)
  , Air(air)
  , FollowsAir(sensor.followsAir())
  , Photons(sensor)
  , Gaps(gaps)
  , Pulse(sensor.pulseWidth / sensor.samplingInterval)
  , Drops(this->Pulse)
  , Seed(seed)
  , Revolution(revolution)
  , Mode(mode)
  , Wanted(std::move(wanted))
{
  if (this->Air)
  {
    this->planAir();
  }
}

/// Find up to which unit the air alone may be perceived, or its drops matter. A background brighter
/// than the sensor's background raises the limit, so these units suffice.
void BeamReceiver::planAir()
{
  std::int64_t looked = 0;
  this->Air->beginOutside();
  for (std::int64_t unit = 0; unit < this->Air->units(); ++unit)
  {
    const double variance = this->varianceWith(this->Air->sharesOf(unit));
    double ofDrops = 0.0;
    for (const BeamAir::Share& share : this->Air->sharesOf(unit))
    {
      ofDrops += varianceOfDrops(share, this->Air->mediumAt(share.medium));
    }
    const bool hasDrops = this->Plan.enabled && ofDrops > DropsCount * variance;
    if (hasDrops || (!this->FollowsAir && this->Air->followed(unit) > 1e-6 * this->Lower))
    {
      looked = unit + 1;
    }
  }
  this->Air->lookAt(looked);
  this->Air->beginOutside();
}

/// Lower limit of a unit, J. @param air mean energy that the air returns in the unit, J
double BeamReceiver::lowerIn(double air) const
{
  return this->FollowsAir
    ? this->Lower * this->Photons.growthInAir(this->Photons.electronsPerJoule * air)
    : this->Lower;
}

void BeamReceiver::receive(std::uint64_t beam, const std::vector<RangeUnit>& units, double radiance)
{
  if (radiance != this->Radiance)
  {
    this->lookAt(radiance);
  }
  this->Noise.begin(this->Plan, this->Seed, beam, this->Revolution);
  this->Beam = beam;
  this->Drops.clear();
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
  this->Plan = planNoise(there, this->Plan.enabled);
  this->Plan.ofRanges = ofRanges;
  this->Errors = RangeErrors(there, ofRanges);
  this->Photons = PhotonReceiver(there);
}

void BeamReceiver::collectUnits(const std::vector<RangeUnit>& units)
{
  this->Units.clear();
  const bool isLocal = this->isLocal();
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
  const auto lookedFrom = [&](std::int64_t unit)
  { return this->Air ? this->Air->nextLooked(unit) : none; };
  std::int64_t next = lookedFrom(0); // next unit in which the air alone may be perceived
  while (next < none || lit != units.end() || alarm != alarms.end())
  {
    const std::int64_t index = std::min(
      { next, lit != units.end() ? lit->index : none, alarm != alarms.end() ? *alarm : none });
    const bool isAlarm = alarm != alarms.end() && *alarm == index;
    const bool isLit = lit != units.end() && lit->index == index;
    const double light = isLit ? lit->energy : 0.0;
    const bool hasAir =
      isLocal ? index == next || !this->FollowsAir : this->Air && index < this->Air->units();
    if (isAlarm || hasAir || !(light < this->Plan.faintLight) || this->Noise.isRare(index))
    {
      this->addUnit(index, light, isLit ? lit->paths : 0, isAlarm);
    }
    alarm += isAlarm ? 1 : 0;
    lit += isLit ? 1 : 0;
    next = next == none ? none : lookedFrom(std::max(next, index + 1));
  }
}

/// Variance of the noise of a unit that receives the mean light of media alone, J^2.
double BeamReceiver::varianceWith(const std::vector<BeamAir::Share>& shares) const
{
  double all = 0.0;
  for (const BeamAir::Share& share : shares)
  {
    all += share.mean;
  }
  return this->Plan.darkVariance + this->Plan.varianceOfEnergy * all;
}

/// Index of the random numbers of a medium's drops in a unit.
std::uint64_t BeamReceiver::drawsOf(const BeamAir::Share& share, std::int64_t unit) const
{
  const std::uint64_t stream = this->isLocal() ? share.medium : 0;
  return static_cast<std::uint64_t>(unit) + static_cast<std::uint64_t>(BeamAir::MostUnits) * stream;
}

/// Add the light of drops beyond its mean, for media that a threshold may follow. @param units sums
/// of the units that the pulses of these drops reach, J
void BeamReceiver::drawDrops(std::int64_t unit, double* units)
{
  const std::vector<BeamAir::Share>& shares = this->Air->sharesOf(unit);
  const double variance = this->varianceWith(shares);
  for (const BeamAir::Share& share : shares)
  {
    const Medium& medium = this->Air->mediumAt(share.medium);
    const bool isDrawn = this->isLocal() ? varianceOfDrops(share, medium) > DropsCount * variance
                                         : unit < this->Air->looked();
    if (medium.isFollowed && isDrawn)
    {
      addDropsBeyondMean(this->Seed, this->Beam, this->drawsOf(share, unit), this->Revolution,
        this->openAt(unit) * share.mean, share.drops, medium, this->Pulse, units);
    }
  }
}

/// Draw the light that media return in a unit. @param received gets `leaves` and `medium` @return
/// light of the other media beyond its mean, J
double BeamReceiver::drawAir(std::int64_t unit, ReceivedUnit& received)
{
  const std::vector<BeamAir::Share>& shares = this->Air->sharesOf(unit);
  const double from = static_cast<double>(unit) * this->UnitLength;
  const double open = this->openAt(unit);
  const double variance = this->varianceWith(shares);
  double beyond = 0.0;
  double most = 0.0;
  for (const BeamAir::Share& share : shares)
  {
    const Medium& medium = this->Air->mediumAt(share.medium);
    if (medium.isFollowed)
    {
      beyond += open * share.mean - share.mean;
      continue;
    }
    double energy = open * share.mean;
    if (medium.sharesGaps && this->Gaps && this->Gaps->any())
    {
      energy = this->Gaps->returnedBetween(from, from + this->UnitLength, share.medium);
    }
    else if (this->Plan.enabled && varianceOfDrops(share, medium) > DropsCount * variance)
    {
      double drawn = energy;
      addDropsBeyondMean(this->Seed, this->Beam, this->drawsOf(share, unit), this->Revolution,
        energy, share.drops, medium, PulseShares(), &drawn);
      energy = std::max(0.0, drawn);
    }
    received.leaves += energy;
    received.medium = energy > most ? medium.objectId : received.medium;
    most = std::max(most, energy);
  }
  if (this->Plan.enabled)
  {
    beyond +=
      this->Drops.in(unit, [&](std::int64_t of, double* units) { this->drawDrops(of, units); });
  }
  return beyond;
}

/// Add a unit, unless it is too faint to be perceived without rare noise.
void BeamReceiver::addUnit(std::int64_t index, double light, std::uint32_t paths, bool alarm)
{
  const bool gaussian = this->Plan.gaussian;
  ReceivedUnit unit;
  const double mean = this->Air ? this->Air->followed(index) : 0.0;
  const bool isDrawn =
    this->isLocal() || (this->Air && this->Plan.enabled && index < this->Air->looked());
  const double beyond = isDrawn ? this->drawAir(index, unit) : 0.0;
  light += unit.leaves;
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
  constexpr std::uint64_t interval = 512; // number of units, which take 0.1 s with 1e5 photons each
  if (++this->Drawn % interval == 0 && this->Wanted && !this->Wanted())
  {
    throw WorkStopped();
  }
  return this->Noise.energy(unit, light);
}

/// Light of the air that leaves let through to a unit and back, over its mean; 1 where no leaves
/// are drawn.
double BeamReceiver::openAt(std::int64_t unit) const
{
  return this->Gaps && this->Gaps->any() ? this->Gaps->openAt(this->centreOf(unit)) : 1.0;
}

double BeamReceiver::centreOf(std::int64_t unit) const
{
  return this->placeIn(unit, 0.5);
}

/// Range, m, of a place in the part of a unit that lies inside the gate. @param place 0 to 1
double BeamReceiver::placeIn(std::int64_t unit, double place) const
{
  const double begin = static_cast<double>(unit) * this->UnitLength;
  const double low = std::max(begin, this->Gate[0]);
  const double high = std::min(begin + this->UnitLength, this->Gate[1]);
  return low < high ? low + place * (high - low) : begin + place * this->UnitLength;
}

double BeamReceiver::rangeOf(const Return& run, RangeUnitAccumulator& accumulator) const
{
  if (!run.hasLight || this->Mode == ReturnMode::RangeUnits)
  {
    return run.range;
  }
  // Lengths are taken from the beginning of the first unit, which is near and below all lengths.
  // The sums then have no round-off of the range, nor of a unit that is as long as the scene.
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
  // Where the air raises the limit, an echo has the errors of a weaker echo in clear air.
  const double share = unit.lower > this->Lower ? this->Lower / unit.lower : 1.0;
  return this->Errors.measured(range, run.energyReceived * share,
    this->Errors.hasNoise() ? this->Noise.rangeDeviate(unit.index) : 0.0);
}

double BeamReceiver::rangeOfNoise(const Return& run) const
{
  double weight = 0.0;
  double moment = 0.0;
  for (std::size_t u = run.firstUnit; u < run.lastUnit; ++u)
  {
    const ReceivedUnit& unit = this->Units[u];
    weight += unit.energy;
    moment += unit.energy * this->placeIn(unit.index, this->Noise.place(unit.index));
  }
  return moment / weight;
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
