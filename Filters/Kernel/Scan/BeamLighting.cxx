// SPDX-License-Identifier: BSD-3-Clause
#include "BeamLighting.h"

#include "HiddenGlint.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
BeamLighting::BeamLighting(const ScanSetup& setup, const ScanBeams& beams, std::uint32_t shading,
  ScanBlock& block, BeamSamplers& samplers, const BeamReceiver& receiver,
  std::function<bool()> wanted)
  : Setup(setup)
  , Beams(beams)
  , Shading(shading)
  , Block(block)
  , Samplers(samplers)
  , Receiver(receiver)
  , Wanted(std::move(wanted))
  , Secondary(setup)
  , Quadrature(setup)
  , Error(samplers)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate)
{
}

bool BeamLighting::light(std::size_t beam, BeamTrace& trace)
{
  this->Lost = 0.0;
  this->Skipped = 0;
  this->Paths.clear();
  this->Energies.clear();
  this->Units.clear();
  if (!this->placeSamples(beam, trace))
  {
    return false;
  }
  if (!this->Lit)
  {
    return this->Receiver.mayAlarm();
  }
  const EchoSettings& settings = this->Setup.settings;
  const BeamSamples& samples = *this->Lit;
  Throughput& throughput = this->throughputOf(beam, trace);
  const double most =
    this->Setup.sensor.pulseEnergy * mostAir(samples, settings.attenuationCoefficient);
  this->Glint = most / samples.rays * throughput.glint;
  if (!this->mayBePerceived(throughput, most))
  {
    return false;
  }
  if (settings.numberOfReflections > 1 && (this->Starts || this->Facing))
  {
    this->reflectAgain(beam, trace, throughput, most);
  }
  this->fillUnits();
  return true;
}

/// Set the samples of the beam: its rays, or nodes if it is integrated. @return false if, by a
/// bound, nothing of it can be perceived
bool BeamLighting::placeSamples(std::size_t beam, BeamTrace& trace)
{
  this->Lit = trace.hits.get();
  this->Targets = trace.targets.get();
  this->Starts = this->Lit;
  this->Unplaced = 0.0;
  this->Integrated = this->Block.isIntegrated(beam);
  this->Facing = false;
  this->Cells = this->Block.isInCells(beam) ? trace.cells.get() : nullptr;
  if (this->Cells)
  {
    this->Lit = this->Cells->samples.size() > 0 ? &this->Cells->samples : nullptr;
    return true;
  }
  if (!this->Integrated)
  {
    return true;
  }
  this->Starts = nullptr;
  this->Lit = nullptr;
  const BeamFrame& frame = this->Block.frameOf(beam);
  this->Quadrature.begin(frame, *trace.polygons);
  const PolygonQuadrature::Extent& extent = this->Quadrature.extent();
  this->Facing = trace.polygons->facing && this->Setup.settings.numberOfReflections > 1;
  this->Most = extent.mostReturned;
  if (!this->Facing && dropsFaintPaths(this->Setup.settings) &&
    this->isSkipped(extent.mostInUnit, extent.farthest, extent.nearest))
  {
    return false;
  }
  const PolygonNodes& nodes = this->Quadrature.place();
  this->Lit = &nodes.samples;
  this->Lost = this->Unplaced = this->Quadrature.dropped();
  this->Skipped |= this->Quadrature.dropped() > 0.0 ? SkippedDirectPaths : 0u;
  return true;
}

/// The throughputs of the direct echoes, and what is known of the other paths.
Throughput& BeamLighting::throughputOf(std::size_t beam, BeamTrace& trace)
{
  if (this->Integrated)
  {
    this->OfNodes.measure(this->Setup, *this->Lit);
    return this->OfNodes;
  }
  if (this->Cells)
  {
    this->MostOfStarts = this->Starts && this->Setup.settings.numberOfReflections > 1
      ? this->Secondary.bound(*this->Starts, this->throughputOfRays(beam, trace))
      : 0.0;
    this->OfNodes.measure(this->Setup, *this->Lit);
    return this->OfNodes;
  }
  return this->throughputOfRays(beam, trace);
}

/// The throughputs of the beam's rays, or of those from which its paths start.
Throughput& BeamLighting::throughputOfRays(std::size_t beam, BeamTrace& trace)
{
  if (!trace.throughput || trace.throughput->shading != this->Shading)
  {
    trace.throughput = std::make_unique<Throughput>();
    trace.throughput->measure(this->Setup, *this->Starts);
    trace.throughput->glint =
      this->Integrated || this->Cells ? 0.0 : hiddenGlintOf(this->Setup, *this->Starts);
    trace.throughput->shading = this->Shading;
    this->Block.markChanged(beam);
  }
  return *trace.throughput;
}

void BeamLighting::fillUnits()
{
  this->Units.add(this->Lit->range.data(), this->Energies.data(), this->Energies.size());
  for (const SecondaryPath& path : this->Paths)
  {
    this->Units.add({ path.length, path.energy });
  }
  this->Units.accumulate();
}

/// Add paths over two reflections, unless none of the scan can matter. @param most energy of a path
/// of throughput 1 at most, J
void BeamLighting::reflectAgain(
  std::size_t beam, BeamTrace& trace, const Throughput& throughput, double most)
{
  const double lostBefore = this->Lost;
  if (this->Setup.needs.secondaryReflections)
  {
    this->collectPaths(beam, trace);
  }
  else
  {
    this->Lost += std::min(most * this->mostByPaths(throughput), this->Setup.needs.secondaryBound);
  }
  this->Skipped |= this->Lost > lostBefore ? SkippedSecondaryPaths : 0u;
}

/// Bound of the sum of the throughputs of all paths over two reflections.
double BeamLighting::mostByPaths(const Throughput& throughput) const
{
  if (this->Cells)
  {
    return this->MostOfStarts;
  }
  // Paths of an integrated beam start from random points: no sum over its nodes bounds them.
  return this->Integrated ? (this->Facing ? this->Quadrature.extent().mostAlbedo : 0.0)
                          : this->Secondary.bound(*this->Lit, throughput);
}

void BeamLighting::collectPaths(std::size_t beam, BeamTrace& trace)
{
  if (this->Integrated)
  {
    this->Starts = &this->Block.pathStartsOf(beam, trace);
  }
  const BeamSamples& samples = *this->Starts;
  Throughput& throughput = this->throughputOfRays(beam, trace);
  bool traced = false;
  const auto scene = [&]() -> SecondaryReflection::Scene
  {
    traced = true;
    return { this->Block.frameOf(beam), this->Block.raysOf(beam, samples),
      this->Block.geometryOf(beam, samples), this->Block.tracerOf(beam) };
  };
  const bool strata = this->Setup.settings.sampling == Sampling::Stratified;
  if (!trace.secondary)
  {
    trace.secondary = std::make_unique<SecondaryTrace>();
  }
  const SecondaryReflection::Beam paths{ this->Beams.ids[beam], samples, throughput,
    strata ? &this->Samplers.of(samples.rays).strata : nullptr, *trace.secondary, std::ref(scene),
    &this->Wanted };
  if (this->Secondary.collect(paths, this->Paths, this->Lost))
  {
    this->Block.markChanged(beam);
  }
  if (traced)
  {
    this->Block.addCounters(beam, this->Block.tracerOf(beam).counters());
  }
}

/// Set the energies of direct echoes. @return false if, by bounds, nothing of the beam can be
/// perceived; energies may not be set then
bool BeamLighting::mayBePerceived(const Throughput& throughput, double most)
{
  const EchoSettings& settings = this->Setup.settings;
  const BeamSamples& samples = *this->Lit;
  const bool drops = dropsFaintPaths(settings);
  double others = this->Unplaced; // J, bound of all paths over two reflections, too
  if (drops)
  {
    others += settings.numberOfReflections > 1 ? most * this->mostByPaths(throughput) : 0.0;
    if (this->isSkipped(most * throughput.directSum + others, samples.farthest, samples.nearest))
    {
      return false;
    }
  }
  const double sum = directEnergies(this->Setup, samples, throughput, this->Energies);
  if (drops)
  {
    if (samples.pathStep > 0) // nodes of an integral are not paths
    {
      this->dropFaintPaths();
    }
    this->Skipped |= this->Lost > 0.0 ? SkippedDirectPaths : 0u;
    return !this->isSkipped(sum + others, samples.farthest, samples.nearest);
  }
  return true;
}

/// True if nothing of the beam can be perceived. @param most J, bound of its strongest unit
bool BeamLighting::isSkipped(double most, double farthest, double nearest)
{
  // The report says what arrives beyond the gate.
  const bool perceivable = this->LightsAll || this->Receiver.mayAlarm() ||
    !(most < SurelyBelow * this->Setup.sensor.lowerEnergyLimit) ||
    !(this->Units.lastUnitOf(farthest) < static_cast<double>(this->Units.gateUnits()));
  if (!perceivable)
  {
    this->Skipped = SkippedBeam |
      (nearest > this->Setup.needs.perceivableRange ? SkippedBeyondRange : SkippedPart{});
    this->Lost = most;
  }
  return !perceivable;
}

/// Apply the light-energy constraint to direct echoes.
void BeamLighting::dropFaintPaths()
{
  const double threshold =
    lightEnergyTolerance(this->Setup) / pathsOf(this->Setup.settings, *this->Lit);
  for (double& energy : this->Energies)
  {
    if (energy < threshold)
    {
      this->Lost += energy;
      energy = 0.0;
    }
  }
}

double BeamLighting::errorOf(std::int64_t unit, std::uint32_t paths)
{
  if (paths == 0)
  {
    return 0.0; // a false alarm: no sample has a share in it
  }
  const RangeShares shares = this->Units.sharesOf(unit, unit + 1);
  static const TargetRays none;
  if (this->Cells)
  {
    const double ofCells = this->Cells->errorOf(shares);
    if (this->Paths.empty())
    {
      return ofCells;
    }
    this->Error.gather(*this->Starts, this->Paths, shares, none, this->Lit->size());
    const double ofPaths = this->Error.total(false, 0.0);
    return std::sqrt(ofCells * ofCells + ofPaths * ofPaths);
  }
  if (this->Integrated)
  {
    const double bound = this->Quadrature.boundOf(shares, this->Energies, this->Most);
    if (this->Paths.empty())
    {
      return bound;
    }
    this->Error.gather(*this->Starts, this->Paths, shares, none, this->Lit->size());
    return bound + this->Error.total(false, 0.0);
  }
  this->Error.gather(*this->Lit, this->Paths, shares, this->Targets ? *this->Targets : none);
  return this->Error.total(paths >= this->Lit->rays && this->Lit->onOnePlane(), this->Glint);
}

bool BeamLighting::isBeyondGate() const
{
  return this->Units.units().empty() && this->Units.energyBeyondGate() > 0.0 &&
    std::any_of(this->Energies.begin(), this->Energies.end(), [](double e) { return e > 0.0; });
}
}
