// SPDX-License-Identifier: BSD-3-Clause
#include "BeamReceiver.h"

#include "ParallelLoop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr std::int64_t NoUnit = std::numeric_limits<std::int64_t>::max();

/// Drops are drawn where their variance exceeds this share of the variance of the unit's noise.
constexpr double DropsCount = 0.01;

/// Variance of the light that a medium returns in a unit, by the number and size of its drops, J^2.
double varianceOfDrops(const AirLight::Share& share, const Medium& medium)
{
  return share.drops > 0.0 ? share.mean * share.mean * medium.squareOfDrops / share.drops : 0.0;
}
}

double perceivedEnergy(double received, double lower, double upper)
{
  return received > lower ? std::min(received, upper) : 0.0;
}

BeamReceiver::Exposure::Exposure(const Sensor& sensor, const NoisePlan& noise)
  : radiance(sensor.backgroundRadiance)
  , lower(sensor.lowerEnergyLimit)
  , upper(sensor.upperEnergyLimit)
  , plan(noise)
  , errors(sensor, noise.ofRanges)
  , photons(sensor)
{
}

BeamReceiver::BeamReceiver(const Sensor& sensor, const NoisePlan& noise, std::int32_t seed,
  ReturnMode mode, const ScanAir& air, std::int32_t revolution, std::function<bool()> wanted)
  : Instrument(sensor)
  , Scan(air)
  , UnitLength(sensor.rangeUnitLength())
  , FollowsAir(sensor.followsAir())
  , Seed(seed)
  , Revolution(revolution)
  , Mode(mode)
  , Ranges(sensor, mode)
  , Wanted(std::move(wanted))
  , Pulse(ReceivedPulse(sensor, sensor.samplingInterval))
  , Sky(sensor, noise)
  , Light(air)
  , Drops(this->Pulse)
{
  this->planAir();
}

/// Find up to which unit the air alone may be perceived, or its drops matter. A background brighter
/// than the sensor's background raises the limit, so these units suffice.
void BeamReceiver::planAir()
{
  const BeamAir outside(this->Scan);
  const std::vector<MetSurface> none;
  this->Light.begin(outside, none);
  for (std::int64_t unit = 0; unit < this->Scan.units(); ++unit)
  {
    const double variance = this->varianceWith(this->Sky, this->Light.sharesOf(unit));
    double ofDrops = 0.0;
    for (const AirLight::Share& share : this->Light.sharesOf(unit))
    {
      ofDrops += varianceOfDrops(share, this->Scan.mediumAt(share.medium));
    }
    const bool hasDrops = this->Sky.plan.enabled && ofDrops > DropsCount * variance;
    if (hasDrops || (!this->FollowsAir && this->Light.followed(unit) > 1e-6 * this->Sky.lower))
    {
      this->Looked = unit + 1;
    }
  }
  this->Light.end();
}

/// Variance of the noise of a unit that receives the mean light of media alone, J^2.
double BeamReceiver::varianceWith(
  const Exposure& exposure, const std::vector<AirLight::Share>& shares) const
{
  double all = 0.0;
  for (const AirLight::Share& share : shares)
  {
    all += share.mean;
  }
  return exposure.plan.darkVariance + exposure.plan.varianceOfEnergy * all;
}

const BeamReceiver::Exposure& BeamReceiver::exposureTo(double radiance)
{
  if (radiance == this->Sky.radiance)
  {
    return this->Sky;
  }
  if (!this->Other || radiance != this->Other->radiance)
  {
    const Sensor there = lookingAt(this->Instrument, radiance);
    NoisePlan plan = planNoise(there, this->Sky.plan.enabled);
    plan.ofRanges = this->Sky.plan.ofRanges;
    this->Other.emplace(there, plan);
  }
  return *this->Other;
}

class BeamReceiver::Reception
{
public:
  Reception(BeamReceiver& receiver, std::uint64_t beam, const ArrivingLight& light,
    const BeamAir& air, const DrawnLeaves& leaves)
    : Receiver(receiver)
    , Exposed(receiver.exposureTo(light.radiance))
    , Arriving(light)
    , Air(air)
    , Leaves(leaves)
  {
    this->Result.key = { receiver.Seed, beam, receiver.Revolution };
    this->Result.radiance = light.radiance;
    receiver.Noise.begin(this->Exposed.plan, this->Result.key);
    receiver.Drops.clear();
    receiver.Light.begin(air, light.surfaces);
  }

  Received receive()
  {
    this->collectUnits();
    this->formReturns();
    this->select();
    this->findErrors();
    this->Receiver.Light.end();
    return std::move(this->Result);
  }

private:
  std::uint64_t drawsOf(const AirLight::Share& share, std::int64_t unit) const;
  void drawDrops(std::int64_t unit, double* units);
  double drawAir(std::int64_t unit, ReceivedUnit& received);
  void collectUnits();
  void addUnit(std::int64_t index, double light, std::uint32_t paths, bool alarm);
  double noiseOf(std::int64_t unit, double light);
  void formReturns();
  void select();
  void findErrors();
  double openAt(std::int64_t unit) const;

  BeamReceiver& Receiver;
  const Exposure& Exposed;
  const ArrivingLight& Arriving;
  const BeamAir& Air;
  const DrawnLeaves& Leaves;
  Received Result;
};

Received BeamReceiver::receive(
  std::uint64_t beam, const ArrivingLight& light, const BeamAir& air, const DrawnLeaves& leaves)
{
  return Reception(*this, beam, light, air, leaves).receive();
}

void BeamReceiver::Reception::collectUnits()
{
  const std::vector<RangeUnit>& units = this->Arriving.units;
  const bool isLocal = this->Air.isLocal();
  const bool mayAlarm = this->Exposed.plan.active || this->Receiver.Scan.fillsScene();
  if (!mayAlarm && !isLocal)
  {
    this->Result.units.resize(units.size());
    ReceivedUnit* received = this->Result.units.data();
    for (const RangeUnit& unit : units)
    {
      received->index = unit.index;
      received->energy = unit.energy;
      received->paths = unit.paths;
      received->lower = this->Exposed.lower;
      received->upper = this->Exposed.upper;
      ++received;
    }
    return;
  }
  const auto& alarms = this->Receiver.Noise.alarms();
  auto alarm = alarms.begin();
  auto lit = units.begin();
  const auto lookedFrom = [&](std::int64_t unit)
  { return this->Receiver.Light.nextLooked(unit, this->Receiver.Looked); };
  std::int64_t next = lookedFrom(0); // next unit in which the air alone may be perceived
  while (next < NoUnit || lit != units.end() || alarm != alarms.end())
  {
    const std::int64_t index = std::min(
      { next, lit != units.end() ? lit->index : NoUnit, alarm != alarms.end() ? *alarm : NoUnit });
    const bool isAlarm = alarm != alarms.end() && *alarm == index;
    const bool isLit = lit != units.end() && lit->index == index;
    const double light = isLit ? lit->energy : 0.0;
    const bool hasAir =
      isLocal ? index == next || !this->Receiver.FollowsAir : index < this->Receiver.Scan.units();
    if (isAlarm || hasAir || !(light < this->Exposed.plan.faintLight) ||
      this->Receiver.Noise.isRare(index))
    {
      this->addUnit(index, light, isLit ? lit->paths : 0, isAlarm);
    }
    alarm += isAlarm ? 1 : 0;
    lit += isLit ? 1 : 0;
    next = next == NoUnit ? NoUnit : lookedFrom(std::max(next, index + 1));
  }
}

/// Index of the random numbers of a medium's drops in a unit.
std::uint64_t BeamReceiver::Reception::drawsOf(
  const AirLight::Share& share, std::int64_t unit) const
{
  const std::uint64_t stream = this->Air.isLocal() ? share.medium : 0;
  return static_cast<std::uint64_t>(unit) + static_cast<std::uint64_t>(ScanAir::MostUnits) * stream;
}

/// Add the light of drops beyond its mean, for media that a threshold may follow. @param units sums
/// of the units that the pulses of these drops reach, J
void BeamReceiver::Reception::drawDrops(std::int64_t unit, double* units)
{
  const std::vector<AirLight::Share>& shares = this->Receiver.Light.sharesOf(unit);
  const double variance = this->Receiver.varianceWith(this->Exposed, shares);
  for (const AirLight::Share& share : shares)
  {
    const Medium& medium = this->Air.mediumAt(share.medium);
    const bool isDrawn = this->Air.isLocal()
      ? varianceOfDrops(share, medium) > DropsCount * variance
      : unit < this->Receiver.Looked;
    if (medium.isFollowed && isDrawn)
    {
      addDropsBeyondMean(this->Receiver.Seed, this->Result.key.beam, this->drawsOf(share, unit),
        this->Receiver.Revolution, this->openAt(unit) * share.mean, share.drops, medium,
        this->Receiver.Pulse, units);
    }
  }
}

/// Draw the light that media return in a unit. @param received gets `leaves` and `medium` @return
/// light of the other media beyond its mean, J
double BeamReceiver::Reception::drawAir(std::int64_t unit, ReceivedUnit& received)
{
  const std::vector<AirLight::Share>& shares = this->Receiver.Light.sharesOf(unit);
  const double from = static_cast<double>(unit) * this->Receiver.UnitLength;
  const double open = this->openAt(unit);
  const double variance = this->Receiver.varianceWith(this->Exposed, shares);
  double beyond = 0.0;
  double most = 0.0;
  for (const AirLight::Share& share : shares)
  {
    const Medium& medium = this->Air.mediumAt(share.medium);
    if (medium.isFollowed)
    {
      beyond += open * share.mean - share.mean;
      continue;
    }
    double energy = open * share.mean;
    if (medium.sharesGaps && this->Leaves.any())
    {
      energy = this->Leaves.returnedBetween(
        this->Air, this->Receiver.Light, from, from + this->Receiver.UnitLength, share.medium);
    }
    else if (this->Exposed.plan.enabled && varianceOfDrops(share, medium) > DropsCount * variance)
    {
      double drawn = energy;
      addDropsBeyondMean(this->Receiver.Seed, this->Result.key.beam, this->drawsOf(share, unit),
        this->Receiver.Revolution, energy, share.drops, medium, PulseShares(), &drawn);
      energy = std::max(0.0, drawn);
    }
    received.leaves += energy;
    received.medium = energy > most ? medium.objectId : received.medium;
    most = std::max(most, energy);
  }
  if (this->Exposed.plan.enabled)
  {
    beyond += this->Receiver.Drops.in(
      unit, [&](std::int64_t of, double* units) { this->drawDrops(of, units); });
  }
  return beyond;
}

/// Add a unit, unless it is too faint to be perceived without rare noise.
void BeamReceiver::Reception::addUnit(
  std::int64_t index, double light, std::uint32_t paths, bool alarm)
{
  const bool gaussian = this->Exposed.plan.gaussian;
  ReceivedUnit unit;
  const double mean = this->Receiver.Light.followed(index);
  const bool isDrawn =
    this->Air.isLocal() || (this->Exposed.plan.enabled && index < this->Receiver.Looked);
  const double beyond = isDrawn ? this->drawAir(index, unit) : 0.0;
  light += unit.leaves;
  const double all = light + std::max(0.0, mean + beyond);
  const double off = this->Receiver.FollowsAir ? mean : 0.0;
  const double lower = this->Receiver.lowerIn(this->Exposed, mean);
  const double most = all - off +
    CommonDeviate *
      std::sqrt(this->Exposed.plan.darkVariance + this->Exposed.plan.varianceOfEnergy * all);
  if (gaussian && !alarm && !(most > lower) && !this->Receiver.Noise.isRare(index))
  {
    return;
  }
  const double noise = this->Exposed.plan.active ? this->noiseOf(index, all) : 0.0;
  unit.index = index;
  unit.energy = all - off + noise;
  unit.noise = noise;
  unit.paths = paths;
  unit.air = all - light - off;
  unit.lower = lower;
  unit.upper = this->Exposed.upper - off;
  this->Result.units.push_back(unit);
}

double BeamReceiver::Reception::noiseOf(std::int64_t unit, double light)
{
  constexpr std::uint64_t interval = 512; // number of units, which take 0.1 s with 1e5 photons each
  if (++this->Receiver.Drawn % interval == 0 && this->Receiver.Wanted && !this->Receiver.Wanted())
  {
    throw WorkStopped();
  }
  return this->Receiver.Noise.energy(unit, light);
}

/// Light of the air that leaves let through to a unit and back, over its mean; 1 where no leaves
/// are drawn.
double BeamReceiver::Reception::openAt(std::int64_t unit) const
{
  return this->Leaves.any()
    ? this->Leaves.openAt(this->Air, this->Receiver.Ranges.placeIn(unit, 0.5))
    : 1.0;
}

void BeamReceiver::Reception::formReturns()
{
  this->Result.returns.clear();
  const bool single = this->Receiver.Mode == ReturnMode::RangeUnits;
  for (std::size_t u = 0; u < this->Result.units.size(); ++u)
  {
    const ReceivedUnit& unit = this->Result.units[u];
    if (!(unit.energy > unit.lower) || !(unit.upper >= unit.lower))
    {
      continue;
    }
    const bool continues = !single && !this->Result.returns.empty() &&
      this->Result.returns.back().lastUnit == u &&
      this->Result.units[u - 1].index + 1 == unit.index;
    if (!continues)
    {
      Return run;
      run.firstUnit = run.strongestUnit = u;
      this->Result.returns.push_back(run);
    }
    Return& run = this->Result.returns.back();
    run.lastUnit = u + 1;
    run.returnEnergy += unit.energy;
    run.air += unit.air;
    if (unit.leaves > 0.0)
    {
      const double at =
        static_cast<double>(unit.index) + placeOfNoise(this->Result.key, unit.index);
      run.rangeOfLeaves =
        (run.leaves * run.rangeOfLeaves + unit.leaves * at * this->Receiver.UnitLength) /
        (run.leaves + unit.leaves);
      run.leaves += unit.leaves;
    }
    run.hasLight = run.hasLight || unit.paths > 0;
    if (unit.energy > this->Result.units[run.strongestUnit].energy)
    {
      run.strongestUnit = u;
    }
  }
  for (std::size_t r = 0; r < this->Result.returns.size(); ++r)
  {
    Return& run = this->Result.returns[r];
    const ReceivedUnit& strongest = this->Result.units[run.strongestUnit];
    run.energyReceived = strongest.energy;
    double most = 0.0;
    for (std::size_t u = run.firstUnit; u < run.lastUnit; ++u)
    {
      const ReceivedUnit& unit = this->Result.units[u];
      run.medium = unit.leaves > most ? unit.medium : run.medium;
      most = std::max(most, unit.leaves);
    }
    run.energy = perceivedEnergy(run.energyReceived, strongest.lower, strongest.upper);
    if (single || !run.hasLight)
    {
      run.range = this->Receiver.Ranges.ofNoise(this->Result, run);
    }
    run.returnNumber = static_cast<int>(r) + 1;
    run.numberOfReturns = static_cast<int>(this->Result.returns.size());
  }
}

void BeamReceiver::Reception::select()
{
  if (this->Result.returns.empty())
  {
    return;
  }
  this->Result.strongest =
    *std::max_element(this->Result.returns.begin(), this->Result.returns.end(),
      [](const Return& a, const Return& b) { return a.energyReceived < b.energyReceived; });
  Return chosen;
  switch (this->Receiver.Mode)
  {
    case ReturnMode::Strongest:
      chosen = *this->Result.strongest;
      break;
    case ReturnMode::First:
      chosen = this->Result.returns.front();
      break;
    case ReturnMode::Last:
      chosen = this->Result.returns.back();
      break;
    case ReturnMode::All:
    case ReturnMode::RangeUnits:
      return;
  }
  this->Result.returns.assign(1, chosen);
}

/// Set the errors of the ranges of the returns.
void BeamReceiver::Reception::findErrors()
{
  const auto set = [&](Return& run)
  {
    const ReceivedUnit& strongest = this->Result.units[run.strongestUnit];
    // Where the air raises the limit, an echo has the errors of a weaker echo in clear air.
    const double share =
      strongest.lower > this->Exposed.lower ? this->Exposed.lower / strongest.lower : 1.0;
    run.error = this->Exposed.errors.of(run.energyReceived * share,
      this->Exposed.errors.hasNoise() ? rangeDeviate(this->Result.key, strongest.index) : 0.0);
  };
  if (this->Result.strongest && this->Receiver.Mode != ReturnMode::RangeUnits)
  {
    std::for_each(this->Result.returns.begin(), this->Result.returns.end(), set);
    set(*this->Result.strongest);
  }
}
}
