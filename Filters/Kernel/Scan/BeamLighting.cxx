// SPDX-License-Identifier: BSD-3-Clause
#include "BeamLighting.h"

#include "Background.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace avianlidar
{
BeamLighting::BeamLighting(const ScanSetup& setup, const SceneTriangles& scene,
  const ScanBeams& beams, BlockBeams& block, BeamSampler& sampler, const BeamReceiver& receiver,
  BeamAir& air, LeafGaps& gaps, std::function<bool()> wanted)
  : Setup(setup)
  , Scene(scene)
  , Beams(beams)
  , Block(block)
  , Sampler(sampler)
  , Receiver(receiver)
  , Wanted(std::move(wanted))
  , Secondary(setup, scene)
  , Quadrature(setup)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate,
      setup.sensor.minimumRange)
  , Air(air)
  , Gaps(gaps)
{
}

bool BeamLighting::light(std::size_t beam, BeamTrace& trace)
{
  this->Lost = 0.0;
  this->Skipped = 0;
  this->Paths.clear();
  this->Energies.clear();
  this->Means.clear();
  this->Units.clear();
  this->Radiance = this->Setup.sensor.backgroundRadiance;
  this->Air.begin(this->Block.frameOf(beam), this->Beams.timeOf(beam));
  this->Gaps.clear();
  if (!this->placeSamples(beam, trace))
  {
    return false;
  }
  if (this->Lit && this->Setup.sensor.seesDaylight())
  {
    this->Radiance = radianceSeen(this->Setup, this->Scene, *this->Lit, this->Beams.origins[beam]);
  }
  if (!this->Lit)
  {
    this->drawLeaves(beam);
    return this->Receiver.mayAlarm() || this->Air.returnsLight();
  }
  this->OfLit.measure(this->Setup, *this->Lit);
  const double most = this->Setup.sensor.pulseEnergy *
    transmissionBound(this->Lit->nearest, this->Setup.attenuation());
  const bool again =
    this->Setup.settings.numberOfReflections > 1 && (this->Starts || this->MayReflectTwice);
  const PolygonQuadrature::Extent& extent = this->Quadrature.extent();
  const double ofPaths = !again ? 0.0
                                : most *
      (this->MayReflectTwice ? this->Secondary.bound(extent.mostAlbedo, extent.nearest)
                             : this->Secondary.bound(*this->Lit, this->OfLit));
  if (!this->mayBePerceived(beam, most, ofPaths))
  {
    return false;
  }
  if (ofPaths > 0.0 && !this->reflectAgain(beam, trace, ofPaths))
  {
    return false;
  }
  this->fillUnits();
  return true;
}

/// Set the samples of the beam (rays, nodes or strips) and the surfaces that the beam sees. @return
/// false if a bound shows that nothing of the beam can be perceived
bool BeamLighting::placeSamples(std::size_t beam, BeamTrace& trace)
{
  this->Starts = this->Lit = trace.hits.get();
  this->Cells = trace.cells();
  this->Surfaces = trace.polygons();
  this->DroppedByQuadrature = 0.0;
  this->MayReflectTwice = false;
  if (this->Cells)
  {
    this->Lit = this->Cells->samples.size() > 0 ? &this->Cells->samples : nullptr;
    this->Surfaces = this->Cells->surfaces.get();
  }
  return !trace.polygons() || this->placeNodes(beam);
}

/// Set the nodes of an integrated beam. @return see placeSamples()
bool BeamLighting::placeNodes(std::size_t beam)
{
  this->Starts = this->Lit = nullptr;
  this->Quadrature.begin(this->Block.frameOf(beam), *this->Surfaces);
  const PolygonQuadrature::Extent& extent = this->Quadrature.extent();
  this->MayReflectTwice = this->Surfaces->facing && this->Setup.settings.numberOfReflections > 1;
  if (!this->MayReflectTwice && dropsFaintPaths(this->Setup.settings) &&
    this->isSkipped(extent.mostInUnit, extent.farthest, extent.nearest))
  {
    return false;
  }
  this->Lit = &this->Quadrature.place().samples;
  this->Lost = this->DroppedByQuadrature = this->Quadrature.dropped();
  this->Skipped |= this->DroppedByQuadrature > 0.0 ? SkippedDirectPaths : 0u;
  return true;
}

/// Weaken direct echoes by media that do not fill the scene. @return their new sum, J
double BeamLighting::passMedia(std::size_t beam, double sum)
{
  if (!this->Air.isLocal())
  {
    return sum;
  }
  const BeamSamples& samples = *this->Lit;
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    this->Energies[i] *= this->Air.transmission(samples.range[i], samples.columnsOf(i));
  }
  this->drawLeaves(beam);
  return std::accumulate(this->Energies.begin(), this->Energies.end(), 0.0);
}

/// Draw the leaves in the beam, and scale direct echoes by the gaps between them.
void BeamLighting::drawLeaves(std::size_t beam)
{
  if (!this->Setup.noise.enabled || !this->Gaps.begin(this->Air))
  {
    return;
  }
  this->BehindLeaves.clear();
  const auto add = [&](std::uint32_t triangle, std::size_t begin, std::size_t end)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      const double range = this->Lit->range[i];
      LeafGaps::Sample sample{ this->Setup.objectId(triangle),
        static_cast<std::int64_t>(range / this->Setup.sensor.rangeUnitLength()), i, range,
        this->Energies[i], this->Lit->columnsOf(i), { 0.0, 0.0 }, { 1.0, 1.0 } };
      if (!this->Lit->places.empty())
      {
        this->Lit->places[i].spread(this->Lit->weight[i], sample.middle, sample.half);
      }
      this->BehindLeaves.push_back(sample);
    }
  };
  if (this->Lit)
  {
    this->Lit->forEachSurface(add);
  }
  this->Gaps.draw(this->Setup.sensor.solidAngle(), this->Setup.settings.seed, this->Beams.ids[beam],
    this->Setup.revolution, this->BehindLeaves);
  this->Means = this->Energies;
  for (const LeafGaps::Sample& sample : this->BehindLeaves)
  {
    this->Energies[sample.number] *= sample.open;
  }
}

void BeamLighting::fillUnits()
{
  if (this->Air.fillsScene() || this->Air.isLocal())
  {
    std::vector<MetSurface> surfaces(this->Lit->size());
    for (std::size_t i = 0; i < surfaces.size(); ++i)
    {
      surfaces[i] = { this->Lit->range[i], this->Lit->weight[i], this->Lit->columnsOf(i) };
    }
    this->Air.take(std::move(surfaces));
  }
  this->Units.clear();
  this->Units.add(this->Lit->range.data(), this->Energies.data(), this->Energies.size());
  for (const SecondaryPath& path : this->Paths)
  {
    this->Units.add({ path.length, path.energy });
  }
  this->Units.accumulate();
}

/// Add paths with two reflections, unless no such path in the scan can matter. @param most bound of
/// their energy, J @return false if nothing of the beam can be perceived
bool BeamLighting::reflectAgain(std::size_t beam, BeamTrace& trace, double most)
{
  const double lostBefore = this->Lost;
  // No path is shorter than twice the range of either end.
  if (dropsFaintPaths(this->Setup.settings) && !this->LightsAll &&
    this->nearestRange() > this->Setup.sensor.rangeGate)
  {
    return true;
  }
  if (!this->Setup.needs.secondaryReflections)
  {
    this->Lost += std::min(most, this->Setup.needs.secondaryBound);
  }
  else if (!this->collectPaths(beam, trace))
  {
    return false;
  }
  this->Skipped |= this->Lost > lostBefore ? SkippedSecondaryPaths : 0u;
  return true;
}

/// Set the rays from which paths start.
void BeamLighting::startFrom(const BeamSamples& rays)
{
  this->Starts = &rays;
  if (!this->raysAreLit())
  {
    this->OfStarts.measure(this->Setup, rays);
  }
}

/// Find the paths with two reflections. @return false if nothing of the beam can be perceived
bool BeamLighting::collectPaths(std::size_t beam, BeamTrace& trace)
{
  const bool byRegions = this->Surfaces && MirrorRegions::takes(*this->Surfaces);
  if (byRegions && connectionsOf(this->Setup.settings) == 0)
  {
    this->startFrom(this->NoStarts);
  }
  else
  {
    this->startFrom(this->MayReflectTwice ? this->Block.pathStartsOf(beam, trace) : *trace.hits);
  }
  if (!trace.secondary)
  {
    trace.secondary = std::make_unique<SecondaryTrace>();
  }
  const double nearest = this->nearestRange();
  const bool strata = this->Setup.settings.sampling == Sampling::Stratified;
  const bool starts = this->Starts->size() > 0;
  BeamTracer& tracer = this->Block.tracerOf(beam);
  SecondaryBeam paths{ this->Beams.ids[beam], this->Scene, this->Block.frameOf(beam), tracer,
    starts ? this->Block.raysOf(beam) : this->NoRays, *this->Starts,
    starts ? this->Block.geometryOf(beam, *this->Starts) : this->NoGeometry,
    this->raysAreLit() ? this->OfLit : this->OfStarts, strata ? &this->Sampler.strata : nullptr,
    *trace.secondary, nearest, &this->Wanted };
  if (haveVolumes(this->Setup.media))
  {
    paths.air = &this->Air;
  }
  if (byRegions)
  {
    paths.surfaces = this->Surfaces;
    paths.cells = this->Cells ? &this->Cells->samples : nullptr;
  }
  if (dropsFaintPaths(this->Setup.settings) && this->onlySurfacesMatter())
  {
    this->Units.add(this->Lit->range.data(), this->Energies.data(), this->Energies.size());
    paths.units = &this->Units;
    paths.faintBelow = SurelyBelow * this->Setup.sensor.lowerEnergyLimit;
  }
  const double lostBefore = this->Lost;
  const bool perceivable = this->Secondary.collect(paths, this->Paths, this->Lost);
  addCounters(tracer.counters(), this->Block.counters(beam));
  if (!perceivable && this->isSkipped(this->Lost, this->Lit->farthest, this->Lit->nearest))
  {
    return false;
  }
  this->Lost = perceivable ? this->Lost : lostBefore; // no echo loses light by these paths
  return true;
}

/// Lower bound of the ranges of the beam's surfaces, m. A strip of cells begins before its mean.
double BeamLighting::nearestRange() const
{
  return this->Cells ? (1.0 - MostOfRange) * this->Lit->nearest : this->Lit->nearest;
}

/// Set the energies of direct echoes. @param most bound of the energy of a path of throughput 1, J
/// @param ofPaths bound of the energy of all paths with two reflections, J @return false if bounds
/// show that nothing of the beam can be perceived. In that case energies may not be set.
bool BeamLighting::mayBePerceived(std::size_t beam, double most, double ofPaths)
{
  const BeamSamples& samples = *this->Lit;
  const bool drops = dropsFaintPaths(this->Setup.settings);
  const double others = this->DroppedByQuadrature + ofPaths;
  if (drops &&
    this->isSkipped(most * this->OfLit.directSum + others, samples.farthest, samples.nearest))
  {
    return false;
  }
  this->Direct =
    this->passMedia(beam, directEnergies(this->Setup, samples, this->OfLit, this->Energies));
  if (drops)
  {
    if (this->raysAreLit()) // nodes of an integral are not paths
    {
      this->dropFaintPaths();
    }
    this->Skipped |= this->Lost > 0.0 ? SkippedDirectPaths : 0u;
    return !this->isSkipped(this->Direct + others, samples.farthest, samples.nearest);
  }
  return true;
}

/// True if no noise and no air can be perceived.
bool BeamLighting::onlySurfacesMatter() const
{
  return !this->LightsAll && !this->Receiver.mayAlarm() && !this->Air.returnsLight();
}

/// False if the beam must be lit even if its surfaces return too little: noise or air may be
/// perceived, or the report must say that echoes arrive outside the gate.
bool BeamLighting::mayBeLeftOut(double farthest, double nearest) const
{
  return this->onlySurfacesMatter() && nearest >= this->Setup.sensor.minimumRange &&
    this->Units.lastUnitOf(farthest) < static_cast<double>(this->Units.gateUnits());
}

/// True if nothing of the beam can be perceived. In that case Skipped and Lost are set for the
/// report. @param most bound of the strongest range unit, J @param farthest, nearest ranges of the
/// beam's surfaces, m
bool BeamLighting::isSkipped(double most, double farthest, double nearest)
{
  if (!(most < SurelyBelow * this->Setup.sensor.lowerEnergyLimit) ||
    !this->mayBeLeftOut(farthest, nearest))
  {
    return false;
  }
  this->Skipped = SkippedBeam |
    (nearest > this->Setup.needs.perceivableRange ? SkippedBeyondRange : SkippedPart{});
  this->Lost = most;
  return true;
}

/// Apply the light-energy constraint to direct echoes.
void BeamLighting::dropFaintPaths()
{
  const double threshold = lightEnergyTolerance(this->Setup) / pathsOfABeam(this->Setup.settings);
  for (double& energy : this->Energies)
  {
    if (energy < threshold)
    {
      this->Lost += energy;
      energy = 0.0;
    }
  }
}

bool BeamLighting::isOutsideGate() const
{
  return this->Units.units().empty() &&
    (this->Units.energyBeyondGate() > 0.0 || this->Units.energyBeforeGate() > 0.0) &&
    std::any_of(this->Energies.begin(), this->Energies.end(), [](double e) { return e > 0.0; });
}
}
