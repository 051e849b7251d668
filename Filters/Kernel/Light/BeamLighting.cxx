// SPDX-License-Identifier: BSD-3-Clause
#include "BeamLighting.h"

#include "Background.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace avianlidar
{
namespace
{
/// Give all contributions to the range units, which are not accumulated yet.
void collectContributions(BeamLight& light)
{
  light.units.clear();
  light.units.add(light.samples()->range.data(), light.energies.data(), light.energies.size());
  for (const SecondaryPath& path : light.paths)
  {
    light.units.add({ path.length, path.energy });
  }
}
}

BeamLighting::BeamLighting(const ScanSetup& setup, const SceneTriangles& scene, bool mayAlarm,
  bool lightsAll, std::function<bool()> wanted, double parts)
  : Setup(setup)
  , Scene(scene)
  , MayAlarm(mayAlarm)
  , LightsAll(lightsAll)
  , LeastShare(
      SurelyBelow * (setup.settings.waveforms ? std::min(1.0, setup.settings.waveformFloor) : 1.0))
  , Wanted(std::move(wanted))
  , Secondary(setup, scene)
  , Tracer(scene)
  , Quadrature(setup, parts)
{
}

BeamLight BeamLighting::light(const Beam& beam, const StrataPartition* strata,
  std::unique_ptr<SecondaryTrace>& known, TraceCounters& cost, BeamLight&& memory)
{
  BeamLight light = std::move(memory);
  light.clear(this->Setup.sensor.backgroundRadiance);
  light.isPerceivable = this->addDirect(beam, light);
  if (light.isPerceivable && light.samples() && this->hasPaths(light))
  {
    if (!known)
    {
      known = std::make_unique<SecondaryTrace>();
    }
    const double lostBefore = light.lost;
    light.isPerceivable = this->collectPaths(beam, strata, *known, cost, light);
    light.skipped |= light.isPerceivable && light.lost > lostBefore ? SkippedSecondaryPaths : 0u;
  }
  if (light.isPerceivable && light.samples())
  {
    this->addUp(beam, light);
  }
  return light;
}

BeamLight BeamLighting::divided(const Beam& beam, const BeamLight& coarse, BeamLight&& memory)
{
  BeamLight light = std::move(memory);
  light.clear(this->Setup.sensor.backgroundRadiance);
  light.isPerceivable = this->addDirect(beam, light);
  light.paths = coarse.paths;
  collectContributions(light);
  return light;
}

/// Add the direct echoes of a beam. @return false if nothing of the beam can be perceived
bool BeamLighting::addDirect(const Beam& beam, BeamLight& light)
{
  const VisiblePolygons* const polygons = beam.view.polygons();
  const CellSamples* const cells = beam.view.cells();
  if (polygons && !this->placeNodes(beam, light))
  {
    return false;
  }
  if (cells)
  {
    light.cells = cells;
    light.seen = cells->samples.size() > 0 ? &cells->samples : nullptr;
  }
  else if (!polygons)
  {
    light.seen = light.starts = beam.view.hits.get();
  }
  const BeamSamples* const samples = light.samples();
  if (!samples)
  {
    this->drawLeaves(beam, light);
    return this->MayAlarm || !beam.air.alone().empty();
  }
  if (this->Setup.sensor.seesDaylight())
  {
    light.radiance = radianceSeen(this->Setup, this->Scene, *samples, beam.frame.origin);
  }
  light.direct.measure(this->Setup, *samples);
  const double most =
    this->Setup.sensor.pulseEnergy * transmissionBound(samples->nearest, this->Setup.attenuation());
  light.mostOfPaths = most * this->boundOfPaths(beam, light);
  const double dropped = polygons ? this->Bounds.dropped : 0.0;
  return this->mayBePerceived(beam, most, dropped + light.mostOfPaths, light);
}

/// Upper bound of the sum of the throughputs of paths with two reflections.
double BeamLighting::boundOfPaths(const Beam& beam, const BeamLight& light) const
{
  if (this->Setup.settings.numberOfReflections < 2)
  {
    return 0.0;
  }
  if (const VisiblePolygons* const polygons = beam.view.polygons())
  {
    return polygons->facing ? this->Secondary.bound(this->Bounds.mostAlbedo, this->Bounds.nearest)
                            : 0.0;
  }
  return beam.view.hits ? this->Secondary.bound(*light.samples(), light.direct) : 0.0;
}

/// True if paths with two reflections are to be found.
bool BeamLighting::hasPaths(BeamLight& light) const
{
  // No path is shorter than twice the range of either end.
  if (!(light.mostOfPaths > 0.0) ||
    (dropsFaintPaths(this->Setup.settings) && !this->LightsAll &&
      light.nearestRange() > this->Setup.sensor.rangeGate))
  {
    return false;
  }
  if (!this->Setup.needs.secondaryReflections)
  {
    const double before = light.lost;
    light.lost += std::min(light.mostOfPaths, this->Setup.needs.secondaryBound);
    light.skipped |= light.lost > before ? SkippedSecondaryPaths : 0u;
  }
  return this->Setup.needs.secondaryReflections;
}

/// Set the nodes of an integrated beam. @return false if a bound shows that nothing of the beam can
/// be perceived
bool BeamLighting::placeNodes(const Beam& beam, BeamLight& light)
{
  const VisiblePolygons& polygons = *beam.view.polygons();
  PolygonBounds& bounds = this->Bounds;
  this->Quadrature.bound(polygons, bounds);
  const bool reflectsTwice = polygons.facing && this->Setup.settings.numberOfReflections > 1;
  if (!reflectsTwice && dropsFaintPaths(this->Setup.settings) &&
    this->isSkipped(beam, bounds.mostInUnit, bounds.farthest, bounds.nearest, light))
  {
    return false;
  }
  light.isIntegrated = true;
  this->Quadrature.place(beam.frame, polygons, bounds, light.nodes);
  light.lost = bounds.dropped;
  light.skipped |= bounds.dropped > 0.0 ? SkippedDirectPaths : 0u;
  return true;
}

/// Weaken direct echoes by media that do not fill the scene. @return their new sum, J
double BeamLighting::passMedia(const Beam& beam, double sum, BeamLight& light)
{
  if (!beam.air.isLocal())
  {
    return sum;
  }
  const BeamSamples& samples = *light.samples();
  for (std::size_t i = 0; i < samples.size(); ++i)
  {
    light.energies[i] *= beam.air.transmission(samples.range[i], samples.columnsOf(i));
  }
  this->drawLeaves(beam, light);
  return std::accumulate(light.energies.begin(), light.energies.end(), 0.0);
}

/// Draw the leaves in the beam, and scale direct echoes by the gaps between them.
void BeamLighting::drawLeaves(const Beam& beam, BeamLight& light)
{
  if (!this->Setup.noise.enabled || !beam.air.isLocal())
  {
    return;
  }
  const std::vector<BeamAir::Leaves> leaves = beam.air.leaves();
  if (leaves.empty())
  {
    return;
  }
  this->BehindLeaves.clear();
  const BeamSamples* const samples = light.samples();
  const auto add = [&](std::uint32_t triangle, std::size_t begin, std::size_t end)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      const double range = samples->range[i];
      LeafGaps::Sample sample{ this->Setup.objectId(triangle),
        static_cast<std::int64_t>(range / this->Setup.sensor.rangeUnitLength()), i, range,
        light.energies[i], samples->columnsOf(i), { 0.0, 0.0 }, { 1.0, 1.0 } };
      if (!samples->places.empty())
      {
        samples->places[i].spread(samples->weight[i], sample.middle, sample.half);
      }
      this->BehindLeaves.push_back(sample);
    }
  };
  if (samples)
  {
    samples->forEachSurface(add);
  }
  light.leaves = this->Gaps.draw(beam.air, leaves, this->Setup.settings.seed, beam.id,
    this->Setup.revolution, this->BehindLeaves);
  light.means = light.energies;
  for (const LeafGaps::Sample& sample : this->BehindLeaves)
  {
    light.energies[sample.number] *= sample.open;
  }
}

/// Find the paths with two reflections. @return false if nothing of the beam can be perceived
bool BeamLighting::collectPaths(const Beam& beam, const StrataPartition* strata,
  SecondaryTrace& known, TraceCounters& cost, BeamLight& light)
{
  const BeamSamples& samples = *light.samples();
  const PathStarts& starts = beam.starts;
  light.starts = &starts.hits;
  if (!light.raysAreLit())
  {
    this->OfStarts.measure(this->Setup, starts.hits);
  }
  this->Tracer.setBeam(beam.frame);
  SecondaryBeam paths{ beam.id, this->Scene, beam.frame, this->Tracer, starts.rays, starts.hits,
    starts.geometry, light.raysAreLit() ? light.direct : this->OfStarts, strata, known,
    light.nearestRange(), &this->Wanted };
  if (haveVolumes(this->Setup.media))
  {
    paths.air = &beam.air;
  }
  paths.surfaces = beam.view.surfacesOfMirrors();
  paths.cells = paths.surfaces && light.cells ? &light.cells->samples : nullptr;
  if (dropsFaintPaths(this->Setup.settings) && this->onlySurfacesMatter(beam))
  {
    light.units.add(samples.range.data(), light.energies.data(), light.energies.size());
    paths.units = &light.units;
    paths.faintBelow = SurelyBelow * this->Setup.sensor.lowerEnergyLimit;
  }
  const double lostBefore = light.lost;
  const bool perceivable = this->Secondary.collect(paths, light.paths, light.lost);
  addCounters(this->Tracer.counters(), cost);
  if (!perceivable && this->isSkipped(beam, light.lost, samples.farthest, samples.nearest, light))
  {
    return false;
  }
  light.lost = perceivable ? light.lost : lostBefore; // no echo loses light by these paths
  return true;
}

/// Sum the energies in range units.
void BeamLighting::addUp(const Beam& beam, BeamLight& light) const
{
  const BeamSamples* const samples = light.samples();
  if (beam.air.scan().fillsScene() || beam.air.isLocal())
  {
    light.surfaces.resize(samples->size());
    for (std::size_t i = 0; i < light.surfaces.size(); ++i)
    {
      light.surfaces[i] = { samples->range[i], samples->weight[i], samples->columnsOf(i) };
    }
    light.surfaces = beam.air.arrange(std::move(light.surfaces));
  }
  collectContributions(light);
  light.units.accumulate();
}

/// Set the energies of direct echoes. @param most bound of the energy of a path of throughput 1, J
/// @param others bound of the energy of all other light, J @return false if bounds show that
/// nothing of the beam can be perceived. In that case energies may not be set.
bool BeamLighting::mayBePerceived(const Beam& beam, double most, double others, BeamLight& light)
{
  const BeamSamples& samples = *light.samples();
  const bool drops = dropsFaintPaths(this->Setup.settings);
  if (drops &&
    this->isSkipped(
      beam, most * light.direct.directSum + others, samples.farthest, samples.nearest, light))
  {
    return false;
  }
  const double sum = this->passMedia(
    beam, directEnergies(this->Setup, samples, light.direct, light.energies), light);
  if (drops)
  {
    if (light.raysAreLit()) // nodes of an integral are not paths
    {
      this->dropFaintPaths(light);
    }
    light.skipped |= light.lost > 0.0 ? SkippedDirectPaths : 0u;
    return !this->isSkipped(beam, sum + others, samples.farthest, samples.nearest, light);
  }
  return true;
}

/// True if no noise and no air can be perceived.
bool BeamLighting::onlySurfacesMatter(const Beam& beam) const
{
  return !this->LightsAll && !this->MayAlarm && beam.air.alone().empty();
}

/// True if nothing of the beam can be perceived. In that case `skipped` and `lost` are set for the
/// report. A beam is not skipped if noise or air may be perceived, or if the report must say that
/// echoes arrive outside the gate. @param most bound of the strongest range unit, J @param
/// farthest, nearest ranges of the beam's surfaces, m
bool BeamLighting::isSkipped(
  const Beam& beam, double most, double farthest, double nearest, BeamLight& light) const
{
  if (!(most < this->LeastShare * this->Setup.sensor.lowerEnergyLimit) ||
    !this->onlySurfacesMatter(beam) || !(nearest >= this->Setup.sensor.minimumRange) ||
    !(light.units.lastUnitOf(farthest) < static_cast<double>(light.units.gateUnits())))
  {
    return false;
  }
  light.skipped = SkippedBeam |
    (nearest > this->Setup.needs.perceivableRange ? SkippedBeyondRange : SkippedPart{});
  light.lost = most;
  return true;
}

/// Apply the light-energy constraint to direct echoes.
void BeamLighting::dropFaintPaths(BeamLight& light) const
{
  const double threshold = lightEnergyTolerance(this->Setup) / pathsOfABeam(this->Setup.settings);
  for (double& energy : light.energies)
  {
    if (energy < threshold)
    {
      light.lost += energy;
      energy = 0.0;
    }
  }
}
}
