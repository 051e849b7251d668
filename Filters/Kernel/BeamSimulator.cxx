// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSimulator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
void addCounters(const TraceCounters& more, TraceCounters& sum)
{
  sum.nodesVisited += more.nodesVisited;
  sum.raysTraced += more.raysTraced;
  sum.candidates = std::max(sum.candidates, more.candidates);
}

/// Paths that a beam of so many rays may have.
double pathsOf(const EchoSettings& settings, std::uint32_t rays)
{
  return static_cast<double>(PathNumbers{ rays, connectionsOf(settings, rays) }.total());
}

/// Energy below which the light-energy constraint drops a path.
double pathThreshold(const ScanSetup& setup, std::uint32_t rays)
{
  return setup.settings.lightEnergyConstraint
    ? LightEnergyTolerance * setup.sensor.lowerEnergyLimit / pathsOf(setup.settings, rays)
    : 0.0;
}
}

struct BeamSimulator::Sampler
{
  StrataPartition strata;
  StandardErrorEstimator error;
  Sampler(Sampling sampling, std::uint32_t rays)
    : strata(rays)
    , error(sampling, rays, &strata)
  {
  }
};

BeamSimulator::BeamSimulator(const ScanSetup& setup, const ScanBeams& beams,
  const ShadingChange& shading, std::function<bool()> wanted)
  : Setup(setup)
  , Beams(beams)
  , Shades(shading)
  , Now{ setup.sensor.lowerEnergyLimit, setup.settings.attenuationCoefficient,
    pathThreshold(setup, static_cast<std::uint32_t>(setup.settings.raysPerBeam)) }
  , Wanted(std::move(wanted))
  , Tracer(*setup.tree, setup.settings.precision)
  , Secondary(setup)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate)
  , Receiver(setup.sensor, setup.noise, setup.settings.seed, setup.settings.returnMode)
  , Labels(setup)
{
}

BeamSimulator::~BeamSimulator() = default;

BeamSimulator::Sampler& BeamSimulator::samplerFor(std::uint32_t rays)
{
  auto& sampler = this->Samplers[rays];
  if (!sampler)
  {
    sampler = std::make_unique<Sampler>(this->Setup.settings.sampling, rays);
  }
  return *sampler;
}

//--- tracing --------------------------------------------------------------------------------------

void BeamSimulator::trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  const EchoSettings& settings = this->Setup.settings;
  this->First = begin;
  if (this->Slots.size() < end - begin)
  {
    this->Slots.resize(end - begin);
  }
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    Slot& slot = this->slotOf(beam);
    slot.framed = false;
    slot.changed = false;
    slot.raysDrawn = 0;
    slot.triangles.clear();
    slot.counters = {};
  }
  const bool target = settings.targetRelativeError > 0.0;
  if (target)
  {
    this->tracePilots(begin, end, traces);
  }
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    const BeamTrace& trace = traces[beam];
    Slot& slot = this->slotOf(beam);
    slot.raysWanted =
      target ? this->raysForTarget(*trace.pilot) : static_cast<std::uint32_t>(settings.raysPerBeam);
    slot.raysMissing = trace.rays == slot.raysWanted ? 0 : slot.raysWanted;
  }
  this->tracePrimary(begin, end, RandomPurpose::Rays);
}

/// Pilots of the beams that have none yet.
void BeamSimulator::tracePilots(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
{
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    this->slotOf(beam).raysMissing = traces[beam].pilot ? 0 : PilotRays;
  }
  this->tracePrimary(begin, end, RandomPurpose::Pilot);
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    BeamTrace& trace = traces[beam];
    if (trace.pilot)
    {
      continue;
    }
    trace.pilot = std::make_unique<PrimaryHits>();
    trace.pilot->rays = PilotRays;
    Slot& slot = this->slotOf(beam);
    slot.changed = true;
    if (!slot.triangles.empty())
    {
      this->Finder.find(*this->Setup.tree->mesh, slot.frame,
        this->raysOf(beam, PilotRays, RandomPurpose::Pilot), slot.triangles, *trace.pilot,
        this->Geometry);
      slot.triangles.clear();
    }
  }
}

const BeamFrame& BeamSimulator::frameOf(std::size_t beam)
{
  Slot& slot = this->slotOf(beam);
  if (!slot.framed)
  {
    slot.frame = makeBeamFrame(
      this->Beams.origins[beam], this->Beams.directions[beam], this->Setup.sensor.halfBeamwidth);
    slot.framed = true;
  }
  return slot.frame;
}

const BeamRays& BeamSimulator::raysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose)
{
  Slot& slot = this->slotOf(beam);
  if (slot.raysDrawn != rays || slot.purpose != purpose)
  {
    sampleBeam(this->Setup.settings.seed, this->Beams.ids[beam], rays,
      this->Setup.sensor.halfBeamwidth, this->Setup.sensor.beamProfile,
      this->Setup.settings.sampling, &this->samplerFor(rays).strata, purpose, slot.rays);
    slot.raysDrawn = rays;
    slot.purpose = purpose;
  }
  return slot.rays;
}

/// The triangles of the missing rays of beams [begin, end); they are drawn only where the beam may
/// meet anything.
void BeamSimulator::tracePrimary(std::size_t begin, std::size_t end, RandomPurpose purpose)
{
  this->Frames.clear();
  this->Missing.clear();
  this->Traced.clear();
  for (std::size_t beam = begin; beam < end; ++beam)
  {
    if (const std::uint32_t rays = this->slotOf(beam).raysMissing)
    {
      this->Frames.push_back(this->frameOf(beam));
      this->Missing.push_back(rays);
      this->Traced.push_back(beam);
    }
  }
  if (this->Traced.empty())
  {
    return;
  }
  const BeamBlock block{ this->Frames.data(), this->Frames.size(), this->Missing.data(),
    [&](std::size_t k) -> const BeamRays&
    { return this->raysOf(this->Traced[k], this->Missing[k], purpose); } };
  const BlockHits& found = this->Tracer.traceBlock(block,
    this->Setup.settings.batchCollisionDetection ? TraceMode::Automatic : TraceMode::SingleRays);
  for (std::size_t k = 0; k < this->Traced.size(); ++k)
  {
    Slot& slot = this->slotOf(this->Traced[k]);
    addCounters(found.counters[k], slot.counters);
    if (const Hit* const hits = found.hits[k])
    {
      slot.triangles.resize(this->Missing[k]);
      std::transform(hits, hits + this->Missing[k], slot.triangles.begin(),
        [](const Hit& hit) { return hit.triangle; });
    }
  }
}

/// The pilot's only use is this number; it is discarded, so the estimate that follows stays
/// unbiased.
std::uint32_t BeamSimulator::raysForTarget(const PrimaryHits& pilot)
{
  const EchoSettings& settings = this->Setup.settings;
  StandardErrorEstimator& error = this->samplerFor(PilotRays).error;
  this->Light.clear();
  this->Light.reflect(this->Setup, pilot);
  error.clear();
  double sum = 0.0;
  for (std::size_t i = 0; i < pilot.size(); ++i)
  {
    error.add(pilot.ray[i], this->Light.reflected[i]);
    sum += this->Light.reflected[i];
  }
  const double most = std::min(1e6, static_cast<double>(MaximumRayFactor) * settings.raysPerBeam);
  if (sum <= 0.0)
  {
    return static_cast<std::uint32_t>(settings.raysPerBeam);
  }
  const double relative =
    error.estimate(error.largest(), pilot.onOnePlane()) / sum / settings.targetRelativeError;
  // Steps of about 19 % keep the number of different partitions small.
  double rays = MinimumTargetRays;
  const double wanted = std::min(most, PilotRays * relative * relative);
  while (rays < wanted)
  {
    rays = std::ceil(rays * 1.19);
  }
  return static_cast<std::uint32_t>(
    std::min(rays, std::max(most, static_cast<double>(MinimumTargetRays))));
}

//--- lighting -------------------------------------------------------------------------------------

void BeamSimulator::light(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes,
  BeamReport& report, BeamOutcome& outcome)
{
  this->Outcome = BeamOutcome();
  const bool geometryKnown = this->takeHits(beam, trace);
  report.lost = 0.0;
  report.range = std::numeric_limits<double>::quiet_NaN();
  this->Paths.clear();
  this->Units.clear();
  this->Lit = trace.hits.get();
  const bool perceivable = this->Lit ? this->lightHits(beam, trace, geometryKnown, report.lost)
                                     : this->Receiver.mayAlarm();
  report.status = this->Lit ? BeamStatus::BelowLimit : BeamStatus::NoSurface;
  if (perceivable)
  {
    this->Receiver.receive(this->Beams.ids[beam], this->Units);
    for (const Return& ret : this->Receiver.returns())
    {
      echoes.push_back(this->makeEcho(ret));
    }
    if (const Return* strongest = this->Receiver.strongest())
    {
      report.range = strongest->range;
    }
    report.status = this->statusOf();
  }
  if (this->Lit)
  {
    this->Outcome.attenuation = this->Now.attenuation;
    if (perceivable)
    {
      this->conclude(trace, report.lost);
    }
    outcome = this->Outcome;
  }
  const TraceCounters& now = this->slotOf(beam).counters;
  addCounters(now, trace.counters);
  report.counters = trace.counters;
  report.raysTracedNow = now.raysTraced;
  if (this->slotOf(beam).changed)
  {
    trace.held = trace.heldBytes();
  }
}

/// What the tracing of the block found becomes known. @return true if the geometry of these hits is
/// at hand
bool BeamSimulator::takeHits(std::size_t beam, BeamTrace& trace)
{
  Slot& slot = this->slotOf(beam);
  if (trace.rays == slot.raysWanted)
  {
    return false;
  }
  slot.changed = true;
  trace.rays = slot.raysWanted;
  trace.hits.reset();
  trace.strengths.reset();
  trace.secondary.reset();
  trace.counters = {};
  if (slot.triangles.empty())
  {
    return false;
  }
  trace.hits = std::make_unique<PrimaryHits>();
  this->Finder.find(*this->Setup.tree->mesh, slot.frame,
    this->raysOf(beam, trace.rays, RandomPurpose::Rays), slot.triangles, *trace.hits,
    this->Geometry);
  return true;
}

/// True if the strengths of a beam are not those of the present materials.
bool BeamSimulator::isRepainted(BeamTrace& trace) const
{
  if (!trace.strengths)
  {
    return true;
  }
  std::uint32_t& shading = trace.strengths->shading;
  if (shading + 1 == this->Shades.number && !this->Shades.touch(trace))
  {
    shading = this->Shades.number;
  }
  return shading != this->Shades.number;
}

bool BeamSimulator::isLit(BeamTrace& trace, const BeamOutcome& outcome) const
{
  return outcome.holds(this->Now) && (!this->Shades.isNew || !this->isRepainted(trace));
}

/// What the direct echoes bring back, and what is known of the other paths.
PathStrengths& BeamSimulator::strengthsOf(std::size_t beam, BeamTrace& trace)
{
  if (this->isRepainted(trace))
  {
    if (!trace.strengths)
    {
      trace.strengths = std::make_unique<PathStrengths>();
    }
    this->Light.reflect(this->Setup, *trace.hits);
    trace.strengths->measure(this->Setup, *trace.hits, this->Light);
    trace.strengths->shading = this->Shades.number;
    this->slotOf(beam).changed = true;
  }
  return *trace.strengths;
}

/// Energies of all paths into range units. @return false if nothing of it can be perceived
bool BeamSimulator::lightHits(std::size_t beam, BeamTrace& trace, bool geometryKnown, double& lost)
{
  const EchoSettings& settings = this->Setup.settings;
  const Sensor& sensor = this->Setup.sensor;
  const PrimaryHits& hits = *trace.hits;
  const double rayEnergy = sensor.pulseEnergy / hits.rays;
  this->Light.clear();
  PathStrengths& strengths = this->strengthsOf(beam, trace);
  const bool reflects = settings.numberOfReflections > 1;
  bool traced = false;
  const auto scene = [&]() -> SecondaryReflection::Scene
  {
    const BeamFrame& frame = this->frameOf(beam);
    const BeamRays& rays = this->raysOf(beam, hits.rays, RandomPurpose::Rays);
    if (!geometryKnown)
    {
      this->Finder.findAgain(*this->Setup.tree->mesh, frame, rays, hits, this->Geometry);
      geometryKnown = true;
    }
    if (!traced)
    {
      this->Tracer.setBeam(frame);
      traced = true;
    }
    return { frame, rays, this->Geometry, this->Tracer, this->slotOf(beam).counters.raysTraced };
  };
  this->Current = &this->samplerFor(hits.rays);
  const StrataPartition* strata =
    settings.sampling == Sampling::Stratified ? &this->Current->strata : nullptr;
  if (!trace.secondary)
  {
    trace.secondary = std::make_unique<SecondaryTrace>();
  }
  const SecondaryReflection::Beam paths{ this->Beams.ids[beam], hits, this->Light, strengths,
    strata, *trace.secondary, std::ref(scene), &this->Wanted };
  const double most = rayEnergy * strengths.mostAir(settings.attenuationCoefficient);
  double others = 0.0; // J, the most that paths over two reflections bring back
  BeamOutcome& outcome = this->Outcome;
  outcome.shortest = 2.0 * strengths.nearest;
  outcome.longest = 2.0 * hits.farthest;
  outcome.surest = std::numeric_limits<double>::infinity();
  if (settings.lightEnergyConstraint)
  {
    others = reflects ? most * this->Secondary.bound(paths) : 0.0;
    outcome.loudest = most * strengths.directSum + others;
    if (this->isFaint(hits.farthest, outcome.loudest))
    {
      return false;
    }
  }
  this->Light.attenuate(this->Setup, hits, strengths.direct, rayEnergy);
  if (settings.lightEnergyConstraint)
  {
    this->dropFaintPaths(hits, lost);
    outcome.loudest = this->Light.sum + others;
    if (this->isFaint(hits.farthest, outcome.loudest))
    {
      return false;
    }
  }
  if (reflects)
  {
    const double lostBefore = lost;
    if (this->Secondary.collect(paths, this->Paths, lost))
    {
      this->slotOf(beam).changed = true;
    }
    this->boundLimits(strengths, most, lostBefore);
  }
  if (traced)
  {
    addCounters(this->Tracer.counters(), this->slotOf(beam).counters);
  }
  this->Units.add(hits.range.data(), this->Light.energy.data(), hits.ray.data(), hits.size());
  this->Units.add(this->Paths.size(),
    [this](std::size_t p) -> const Contribution& { return this->Paths[p].contribution; });
  this->Units.accumulate();
  return true;
}

/// True if `energy`, J, of the beam would not be perceived if it arrived in one unit, and nothing
/// arrives beyond the gate, which the report would tell.
bool BeamSimulator::isFaint(double farthest, double energy) const
{
  return !this->Receiver.mayAlarm() && energy < SurelyBelow * this->Setup.sensor.lowerEnergyLimit &&
    this->Units.lastUnitOf(farthest) < static_cast<double>(this->Units.gateUnits());
}

/// Light-energy constraint on direct echoes.
void BeamSimulator::dropFaintPaths(const PrimaryHits& hits, double& lost)
{
  const double threshold = pathThreshold(this->Setup, hits.rays);
  const double limitOfPath = pathsOf(this->Setup.settings, hits.rays) / LightEnergyTolerance;
  LimitWindow& window = this->Outcome.window;
  if (this->Light.least >= threshold)
  {
    window.below(this->Light.least * limitOfPath * SurelyBelow);
    return;
  }
  for (double& energy : this->Light.energy)
  {
    if (energy < threshold)
    {
      window.atLeast(energy * limitOfPath * SurelyAbove);
      lost += energy;
      energy = 0.0;
    }
    else
    {
      window.below(energy * limitOfPath * SurelyBelow);
    }
  }
}

/// For which Qlow the light-energy constraint leaves the same paths over two reflections.
/// @param most J, what a path of strength 1 brings back at most @param lostBefore J, of direct
/// echoes
void BeamSimulator::boundLimits(const PathStrengths& strengths, double most, double lostBefore)
{
  if (!this->Setup.settings.lightEnergyConstraint)
  {
    return;
  }
  const KnownPaths& known = strengths.paths;
  LimitWindow& window = this->Outcome.window;
  const double limitOfPath = pathsOf(this->Setup.settings, this->Lit->rays) / LightEnergyTolerance;
  // Above this limit all of them are skipped.
  const double limitOfAll =
    (most * (strengths.glossSum + known.linkSum) + lostBefore) / LightEnergyTolerance;
  if (limitOfAll * SurelyAbove <= this->Now.lower)
  {
    window.atLeast(limitOfAll * SurelyAbove);
    return;
  }
  window.below(limitOfAll * SurelyBelow);
  if (limitOfAll * SurelyBelow <= this->Now.lower)
  {
    window.below(0.0); // too near to say whether they were
    return;
  }
  double dropped = std::max(known.unknownMirror, known.unknownLink); // strength, at most
  std::size_t k = 0;
  for (const SecondaryPath& path : this->Paths)
  {
    window.below(path.contribution.energy * limitOfPath * SurelyBelow);
    for (; known.ends[k].path != path.contribution.path; ++k)
    {
      dropped = std::max(dropped, known.strength[k]);
    }
    ++k;
  }
  for (; k < known.size(); ++k)
  {
    dropped = std::max(dropped, known.strength[k]);
  }
  window.atLeast(dropped * most * limitOfPath * SurelyAbove);
}

/// How far the echoes hold. @param lost J, bound of what no unit received
void BeamSimulator::conclude(const BeamTrace& trace, double lost)
{
  BeamOutcome& outcome = this->Outcome;
  if (const Return* strongest = this->Receiver.strongest())
  {
    outcome.loudest = strongest->energyReceived;
    for (const ReceivedUnit& unit : this->Receiver.units())
    {
      unit.energy > this->Now.lower ? outcome.window.below(unit.energy)
                                    : outcome.window.atLeast(unit.energy);
    }
    return;
  }
  outcome.loudest = 0.0;
  for (const ReceivedUnit& unit : this->Receiver.units())
  {
    outcome.loudest = std::max(outcome.loudest, unit.energy);
  }
  outcome.loudest += lost;
  const KnownPaths& known = trace.strengths->paths;
  for (const double length : known.length)
  {
    outcome.longest = std::max(outcome.longest, length);
  }
  if (known.mayPassBudget)
  {
    outcome.loudest = std::numeric_limits<double>::infinity(); // in other air less may be cut
  }
  outcome.surest = this->surestEnergy(*trace.hits, trace.strengths->nearest);
}

/// Of direct paths, the strongest of those that arrive inside the gate, all of their pulse; if
/// nothing at all arrives inside, the strongest of all. 0 where only parts of pulses do.
double BeamSimulator::surestEnergy(const PrimaryHits& hits, double nearest) const
{
  const double gate = static_cast<double>(this->Units.gateUnits());
  const bool allBeyond = this->Units.firstUnitOf(nearest) >= gate;
  double most = 0.0;
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    if (allBeyond || this->Units.lastUnitOf(hits.range[i]) < gate)
    {
      most = std::max(most, this->Light.energy[i]);
    }
  }
  return most;
}

//--- echoes ---------------------------------------------------------------------------------------

Echo BeamSimulator::makeEcho(const Return& ret)
{
  Echo echo;
  echo.range = ret.range;
  echo.energyReceived = ret.energyReceived;
  echo.energy = ret.energy;
  echo.returnEnergy = ret.returnEnergy;
  echo.returnNumber = ret.returnNumber;
  echo.numberOfReturns = ret.numberOfReturns;
  const auto& units = this->Receiver.units();
  this->Labels.label(
    this->Units.sharesOf(units[ret.firstUnit].index, units[ret.lastUnit - 1].index + 1), this->Lit,
    this->Paths, echo);
  echo.energyStdError = this->standardError(units[ret.strongestUnit]);
  return echo;
}

/// Of the return's strongest unit.
double BeamSimulator::standardError(const ReceivedUnit& unit)
{
  if (unit.paths == 0)
  {
    return 0.0; // a false alarm: no ray had a part in it
  }
  const PrimaryHits& hits = *this->Lit;
  StandardErrorEstimator& error = this->Current->error;
  const RangeShares shares = this->Units.sharesOf(unit.index, unit.index + 1);
  const auto rayOf = [&](std::size_t contribution)
  {
    return hits
      .ray[contribution < hits.size() ? contribution : this->Paths[contribution - hits.size()].one];
  };
  std::size_t s = 0;
  if (shares.which)
  {
    error.clear();
  }
  else
  {
    error.begin(hits.ray.data(), shares.energies, hits.size());
    s = hits.size();
  }
  for (; s < shares.count; ++s)
  {
    error.add(rayOf(shares.contribution(s)), shares.energies[s]);
  }
  return error.estimate(error.largest(), this->fillsItsUnit(unit));
}

/// True if one plane fills the window of the range unit: every ray hit it, and put all its energy
/// here. A plane that spreads over several units is cut by their borders as by edges.
bool BeamSimulator::fillsItsUnit(const ReceivedUnit& unit) const
{
  return this->Units.units().size() == 1 && unit.paths >= this->Lit->rays &&
    this->Lit->onOnePlane();
}

BeamStatus BeamSimulator::statusOfEcho(double energyReceived) const
{
  return energyReceived >= this->Setup.sensor.upperEnergyLimit ? BeamStatus::Saturated
                                                               : BeamStatus::Echo;
}

/// Direct echoes tell what lies outside the gate: of the paths over two reflections it depends on
/// how well the beam is known whether they are looked at.
BeamStatus BeamSimulator::statusOf() const
{
  // Before the choice of the return mode: it says what is shown, not what the receiver heard.
  if (const Return* strongest = this->Receiver.strongest())
  {
    return this->statusOfEcho(strongest->energyReceived);
  }
  if (!this->Lit)
  {
    return BeamStatus::NoSurface;
  }
  const std::vector<double>& direct = this->Light.energy;
  const bool beyond = this->Units.units().empty() && this->Units.energyBeyondGate() > 0.0 &&
    std::any_of(direct.begin(), direct.end(), [](double energy) { return energy > 0.0; });
  return beyond ? BeamStatus::OutsideGate : BeamStatus::BelowLimit;
}
}
