// SPDX-License-Identifier: BSD-3-Clause
#include "BeamLighting.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Paths that a beam of so many rays may have.
double pathsOf(const EchoSettings& settings, std::uint32_t rays, std::uint32_t extraRays)
{
  return static_cast<double>(
    PathNumbers{ rays + extraRays, connectionsOf(settings, rays) }.total());
}

/// Energy below which the light-energy constraint drops a path.
double pathThreshold(const ScanSetup& setup, std::uint32_t rays, std::uint32_t extraRays)
{
  return dropsFaintPaths(setup.settings) ? LightEnergyTolerance * setup.sensor.lowerEnergyLimit /
      pathsOf(setup.settings, rays, extraRays)
                                         : 0.0;
}
}

BeamLighting::BeamLighting(const ScanSetup& setup, const ScanBeams& beams,
  const ShadingChange& shading, ScanBlock& block, BeamSamplers& samplers,
  const BeamReceiver& receiver, std::function<bool()> wanted)
  : Setup(setup)
  , Beams(beams)
  , Shades(shading)
  , Now{ setup.sensor.lowerEnergyLimit, setup.settings.attenuationCoefficient,
    pathThreshold(setup, static_cast<std::uint32_t>(setup.settings.raysPerBeam), 0) }
  , Block(block)
  , Samplers(samplers)
  , Receiver(receiver)
  , Wanted(std::move(wanted))
  , Secondary(setup)
  , Quadrature(setup)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate)
{
}

bool BeamLighting::light(std::size_t beam, BeamTrace& trace)
{
  this->Outcome = BeamOutcome();
  this->Lost = 0.0;
  this->Skipped = 0;
  this->Paths.clear();
  this->Units.clear();
  this->Lit = trace.hits.get();
  this->Targets = trace.targets.get();
  this->Integrated = this->Block.isIntegrated(beam);
  if (this->Integrated)
  {
    this->Outcome.attenuation = this->Now.attenuation;
    return this->lightPatch(beam, *trace.patch);
  }
  if (trace.patch)
  {
    trace.patch->shading = 0;
  }
  if (!this->Lit)
  {
    return this->Receiver.mayAlarm();
  }
  this->Outcome.attenuation = this->Now.attenuation;
  return this->lightHits(beam, trace);
}

/// True if the strengths of a beam are not those of the present materials.
bool BeamLighting::isRepainted(BeamTrace& trace) const
{
  VisiblePatch* const patch = trace.patch.get();
  const bool integrated = patch && patch->shading > 0;
  if (!integrated && !trace.strengths)
  {
    return true;
  }
  std::uint32_t& shading = integrated ? patch->shading : trace.strengths->shading;
  if (shading + 1 == this->Shades.number && !(patch && this->Shades.touch(*patch)) &&
    (integrated || !this->Shades.touch(trace)))
  {
    shading = this->Shades.number;
  }
  return shading != this->Shades.number;
}

bool BeamLighting::isLit(BeamTrace& trace, const BeamOutcome& outcome) const
{
  return outcome.holds(this->Now) && (!this->Shades.isNew || !this->isRepainted(trace));
}

/// What the direct echoes bring back, and what is known of the other paths.
PathStrengths& BeamLighting::strengthsOf(std::size_t beam, BeamTrace& trace)
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
    this->Block.markChanged(beam);
  }
  return *trace.strengths;
}

/// Energies of all paths into range units. @return false if nothing of it can be perceived
bool BeamLighting::lightHits(std::size_t beam, BeamTrace& trace)
{
  const EchoSettings& settings = this->Setup.settings;
  const PrimaryHits& hits = *trace.hits;
  this->Light.clear();
  PathStrengths& strengths = this->strengthsOf(beam, trace);
  bool traced = false;
  const auto scene = [&]() -> SecondaryReflection::Scene
  {
    traced = true;
    return { this->Block.frameOf(beam), this->Block.raysOf(beam, hits),
      this->Block.geometryOf(beam, hits), this->Block.tracerOf(beam),
      this->Block.countersOf(beam).raysTraced };
  };
  const StrataPartition* strata =
    settings.sampling == Sampling::Stratified ? &this->Samplers.of(hits.rays).strata : nullptr;
  if (!trace.secondary)
  {
    trace.secondary = std::make_unique<SecondaryTrace>();
  }
  const SecondaryReflection::Beam paths{ this->Beams.ids[beam], hits, this->Light, strengths,
    strata, *trace.secondary, std::ref(scene), &this->Wanted };
  const double most =
    this->Setup.sensor.pulseEnergy / hits.rays * strengths.mostAir(settings.attenuationCoefficient);
  this->Glint = most * strengths.glint;
  if (!this->mayBePerceived(paths, most))
  {
    return false;
  }
  if (settings.numberOfReflections > 1)
  {
    this->reflectAgain(beam, paths, most);
  }
  if (traced)
  {
    this->Block.addCounters(beam, this->Block.tracerOf(beam).counters());
  }
  this->Units.add(hits.range.data(), this->Light.energy.data(), hits.ray.data(), hits.size());
  this->Units.add(this->Paths.size(),
    [this](std::size_t p) -> const Contribution& { return this->Paths[p].contribution; });
  this->Units.accumulate();
  return true;
}

/// The same of a beam that a plane fills.
bool BeamLighting::lightPatch(std::size_t beam, VisiblePatch& patch)
{
  patch.shading = this->Shades.number;
  const BeamFrame& frame = this->Block.frameOf(beam);
  const double pulse = this->Setup.sensor.pulseEnergy;
  const PlaneQuadrature::Extent extent = this->Quadrature.extentOf(frame, patch);
  BeamOutcome& outcome = this->Outcome;
  this->Nearest = extent.nearest;
  outcome.shortest = 2.0 * extent.nearest;
  outcome.longest = 2.0 * extent.farthest;
  outcome.surest = std::numeric_limits<double>::infinity();
  this->Most = pulse * extent.mostReturned;
  outcome.loudest = this->Most;
  this->Light.energy.clear();
  this->Lit = nullptr;
  if (dropsFaintPaths(this->Setup.settings) && this->isSkipped(extent.farthest, extent.nearest))
  {
    return false;
  }
  const PrimaryHits& hits = this->Quadrature.place(frame, patch).hits;
  this->Lit = &hits;
  this->Light.clear();
  this->Light.reflect(this->Setup, hits);
  this->Light.attenuate(this->Setup, hits, this->Light.reflected, pulse / hits.rays);
  this->Units.add(hits.range.data(), this->Light.energy.data(), hits.ray.data(), hits.size());
  this->Units.accumulate();
  return true;
}

/// Paths over two reflections, unless none of the scan can matter.
void BeamLighting::reflectAgain(std::size_t beam, const SecondaryBeam& paths, double most)
{
  const double lostBefore = this->Lost;
  if (this->Setup.needs.secondaryReflections)
  {
    if (this->Secondary.collect(paths, this->Paths, this->Lost))
    {
      this->Block.markChanged(beam);
    }
    this->boundLimits(paths.strengths, most, lostBefore);
  }
  else
  {
    this->Lost += std::min(most * this->Secondary.bound(paths), this->Setup.needs.secondaryBound);
  }
  this->Skipped |= this->Lost > lostBefore ? SkippedSecondaryPaths : 0u;
}

/// Energies of direct echoes. @param most J, what a path of strength 1 brings back at most @return
/// false if, by bounds, nothing of the beam can be perceived; energies may not be known then
bool BeamLighting::mayBePerceived(const SecondaryBeam& paths, double most)
{
  const EchoSettings& settings = this->Setup.settings;
  const PrimaryHits& hits = paths.hits;
  const PathStrengths& strengths = paths.strengths;
  BeamOutcome& outcome = this->Outcome;
  outcome.shortest = 2.0 * strengths.nearest;
  outcome.longest = 2.0 * hits.farthest;
  outcome.surest = std::numeric_limits<double>::infinity();
  double others = 0.0; // J, the most that paths over two reflections bring back
  const bool drops = dropsFaintPaths(settings);
  if (drops)
  {
    others = settings.numberOfReflections > 1 ? most * this->Secondary.bound(paths) : 0.0;
    outcome.loudest = most * strengths.directSum + others;
    if (this->isSkipped(hits.farthest, strengths.nearest))
    {
      return false;
    }
  }
  this->Light.attenuate(
    this->Setup, hits, strengths.direct, this->Setup.sensor.pulseEnergy / hits.rays);
  if (drops)
  {
    this->dropFaintPaths(hits);
    this->Skipped |= this->Lost > 0.0 ? SkippedDirectPaths : 0u;
    outcome.loudest = this->Light.sum + others;
    return !this->isSkipped(hits.farthest, strengths.nearest);
  }
  return true;
}

/// True if nothing of the beam can be perceived, by the bound of its loudest unit.
bool BeamLighting::isSkipped(double farthest, double nearest)
{
  const double loudest = this->Outcome.loudest;
  if (!this->isFaint(farthest, loudest))
  {
    return false;
  }
  this->Skipped = SkippedBeam |
    (nearest > this->Setup.needs.perceivableRange ? SkippedBeyondRange : SkippedPart{});
  this->Lost = loudest;
  return true;
}

/// True if `energy`, J, of the beam would not be perceived if it arrived in one unit, and nothing
/// arrives beyond the gate, which the report would tell.
bool BeamLighting::isFaint(double farthest, double energy) const
{
  return !this->Receiver.mayAlarm() && energy < SurelyBelow * this->Setup.sensor.lowerEnergyLimit &&
    this->Units.lastUnitOf(farthest) < static_cast<double>(this->Units.gateUnits());
}

/// Light-energy constraint on direct echoes.
void BeamLighting::dropFaintPaths(const PrimaryHits& hits)
{
  const double threshold = pathThreshold(this->Setup, hits.rays, hits.extraRays);
  const double limitOfPath =
    pathsOf(this->Setup.settings, hits.rays, hits.extraRays) / LightEnergyTolerance;
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
      this->Lost += energy;
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
void BeamLighting::boundLimits(const PathStrengths& strengths, double most, double lostBefore)
{
  if (!dropsFaintPaths(this->Setup.settings))
  {
    return;
  }
  const KnownPaths& known = strengths.paths;
  LimitWindow& window = this->Outcome.window;
  const double limitOfPath =
    pathsOf(this->Setup.settings, this->Lit->rays, this->Lit->extraRays) / LightEnergyTolerance;
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

void BeamLighting::conclude(const BeamTrace& trace)
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
  outcome.loudest += this->Lost;
  if (this->Integrated)
  {
    outcome.surest = this->surestEnergy(*this->Lit, this->Nearest);
    return;
  }
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
double BeamLighting::surestEnergy(const PrimaryHits& hits, double nearest) const
{
  const double gate = static_cast<double>(this->Units.gateUnits());
  const bool allBeyond = this->Units.firstUnitOf(nearest) >= gate;
  double most = 0.0;
  const bool all = allBeyond || this->Units.lastUnitOf(hits.farthest) < gate;
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    if (all || this->Units.lastUnitOf(hits.range[i]) < gate)
    {
      most = std::max(most, this->Light.energy[i]);
    }
  }
  return most;
}
}
