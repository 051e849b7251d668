// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSimulator.h"

#include "Propagation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// True if the rays of a beam hit one plane, all of them: no edge can hide between them.
bool onOnePlane(const std::vector<RayHit>& hits)
{
  const RayHit& first = hits.front();
  return first.valid() &&
    std::all_of(hits.begin(), hits.end(),
      [&first](const RayHit& hit)
      {
        return hit.valid() &&
          (hit.triangle == first.triangle ||
            (glm::dot(hit.normal, first.normal) > 1.0 - 1e-12 &&
              std::abs(glm::dot(first.normal, hit.point - first.point)) <=
                surfaceMargin(first.range)));
      });
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

BeamSimulator::BeamSimulator(const ScanSetup& setup, std::function<bool()> wanted)
  : Setup(setup)
  , Wanted(std::move(wanted))
  , Tracer(*setup.tree, setup.settings.precision)
  , Secondary(setup)
  , Units(setup.sensor.samplingInterval, setup.sensor.pulseWidth, setup.sensor.rangeGate)
  , Receiver(setup.sensor, setup.noise, setup.settings.seed, setup.settings.returnMode)
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

void BeamSimulator::simulate(std::uint64_t id, const Vec3& origin, const Vec3& direction,
  BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report)
{
  const BeamFrame frame = makeBeamFrame(origin, direction, this->Setup.sensor.halfBeamwidth);
  this->Tracer.setBeam(frame);
  const std::uint32_t rays = this->raysFor(id, frame, trace);
  this->Current = &this->samplerFor(rays);
  this->Units.clear();
  this->Paths.clear();
  this->Lit.clear();
  report.lost = 0.0;
  const bool known = trace.rays == rays;
  if (!known)
  {
    this->tracePrimary(id, trace, rays);
  }
  else if (trace.anyHit)
  {
    this->drawRays(id, rays, RandomPurpose::Rays);
  }
  if (trace.anyHit)
  {
    this->lightRays(frame, trace.primary, this->Lit);
    this->addDirectPaths(report.lost);
    if (this->Setup.settings.numberOfReflections > 1)
    {
      this->addSecondaryPaths(id, frame, trace, report.lost);
    }
  }
  this->Units.accumulate();
  this->Receiver.receive(id, this->Units);

  for (const Return& ret : this->Receiver.returns())
  {
    echoes.push_back(this->makeEcho(ret));
  }
  const Return* strongest = this->Receiver.strongest();
  report.range = strongest ? strongest->range : std::numeric_limits<double>::quiet_NaN();
  const TraceCounters& now = this->Tracer.counters();
  trace.counters.nodesVisited += now.nodesVisited;
  trace.counters.raysTraced += now.raysTraced;
  trace.counters.candidates = std::max(trace.counters.candidates, now.candidates);
  report.counters = trace.counters;
  report.raysTracedNow = now.raysTraced;
  report.status = this->statusOf(trace.anyHit);
}

std::uint32_t BeamSimulator::raysFor(std::uint64_t id, const BeamFrame& frame, BeamTrace& trace)
{
  const EchoSettings& settings = this->Setup.settings;
  if (settings.targetRelativeError <= 0.0)
  {
    return static_cast<std::uint32_t>(settings.raysPerBeam);
  }
  this->drawRays(id, PilotRays, RandomPurpose::Pilot);
  if (trace.pilot.empty())
  {
    this->Tracer.trace(this->Rays, settings.batchCollisionDetection, this->Hits);
    for (const Hit& hit : this->Hits)
    {
      trace.pilot.push_back(hit.triangle);
    }
  }
  this->lightRays(frame, trace.pilot, this->Lit);
  return this->raysForTarget(this->Lit);
}

/// The pilot's only use is this number; it is discarded, so the estimate that follows stays
/// unbiased.
std::uint32_t BeamSimulator::raysForTarget(const std::vector<RayHit>& pilot) const
{
  const EchoSettings& settings = this->Setup.settings;
  Sampler sampler(settings.sampling, PilotRays);
  double sum = 0.0;
  for (std::size_t n = 0; n < pilot.size(); ++n)
  {
    const double energy = pilot[n].valid() ? pilot[n].direct : 0.0;
    sampler.error.add(n, energy);
    sum += energy;
  }
  const double most = std::min(1e6, static_cast<double>(MaximumRayFactor) * settings.raysPerBeam);
  if (sum <= 0.0)
  {
    return static_cast<std::uint32_t>(settings.raysPerBeam);
  }
  const double relative = sampler.error.estimate(sampler.error.largest(), onOnePlane(pilot)) / sum /
    settings.targetRelativeError;
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

void BeamSimulator::drawRays(std::uint64_t id, std::uint32_t rays, RandomPurpose purpose)
{
  sampleBeam(this->Setup.settings.seed, id, rays, this->Setup.sensor.halfBeamwidth,
    this->Setup.sensor.beamProfile, this->Setup.settings.sampling, &this->samplerFor(rays).strata,
    purpose, this->Rays);
}

void BeamSimulator::tracePrimary(std::uint64_t id, BeamTrace& trace, std::uint32_t rays)
{
  std::vector<std::uint32_t> pilot = std::move(trace.pilot);
  trace = BeamTrace{};
  trace.pilot = std::move(pilot);
  trace.rays = rays;
  bool drawn = false;
  const auto source = [&]() -> const BeamRays&
  {
    if (!drawn)
    {
      this->drawRays(id, rays, RandomPurpose::Rays);
      drawn = true;
    }
    return this->Rays;
  };
  this->Tracer.trace(rays, source, this->Setup.settings.batchCollisionDetection, this->Hits);
  trace.anyHit =
    std::any_of(this->Hits.begin(), this->Hits.end(), [](const Hit& h) { return h.valid(); });
  if (trace.anyHit)
  {
    trace.primary.reserve(rays);
    for (const Hit& hit : this->Hits)
    {
      trace.primary.push_back(hit.triangle);
    }
  }
}

void BeamSimulator::lightRays(const BeamFrame& frame, const std::vector<std::uint32_t>& triangles,
  std::vector<RayHit>& hits) const
{
  const TriangleMesh& mesh = *this->Setup.tree->mesh;
  const Sensor& sensor = this->Setup.sensor;
  const double half = std::sin(0.5 * sensor.halfBeamwidth);
  hits.assign(triangles.size(), RayHit{});
  // Neighbouring rays mostly share their triangle.
  std::uint32_t seenNumber = NoTriangle;
  SeenTriangle seen;
  for (std::size_t n = 0; n < triangles.size(); ++n)
  {
    if (triangles[n] == NoTriangle)
    {
      continue;
    }
    RayHit& hit = hits[n];
    if (triangles[n] != seenNumber)
    {
      seenNumber = triangles[n];
      seen = seeTriangle(mesh, seenNumber, frame.origin);
    }
    hit.triangle = triangles[n];
    hit.direction = unitDirection(frame.direction(this->Rays.x[n], this->Rays.y[n]));
    hit.range = rangeOnTriangle(seen, frame, hit.direction);
    hit.point = hit.range * hit.direction;
    hit.normal = seen.normal;
    hit.cosIncidence = std::min(1.0, std::max(0.0, -glm::dot(hit.normal, hit.direction)));
    const Material& material = this->Setup.materials[hit.triangle];
    const Reflectance f = reflectance(this->Setup.settings.reflectanceModel, material,
      monostaticGeometry(hit.direction, hit.normal));
    hit.direct = throughAperture(f, material.kp, sensor.receiverAperture, hit.range).total();
    if (sensor.beamProfile == BeamProfile::Gaussian)
    {
      // Rays are denser on the axis: over the density (1 - e^-2)^-1 2 e^-2u they stand for equal
      // solid angles again.
      const double tan2 = frame.tanHalf * frame.tanHalf *
        (this->Rays.x[n] * this->Rays.x[n] + this->Rays.y[n] * this->Rays.y[n]);
      const double length = std::sqrt(1.0 + tan2);
      const double u = tan2 / (length * (1.0 + length)) / (2.0 * half * half);
      hit.share = -std::expm1(-2.0) / (2.0 * std::exp(-2.0 * std::min(1.0, u)));
    }
  }
}

void BeamSimulator::addDirectPaths(double& lost)
{
  const EchoSettings& settings = this->Setup.settings;
  const auto rays = static_cast<std::uint32_t>(this->Lit.size());
  const double rayEnergy = this->Setup.sensor.pulseEnergy / rays;
  const PathNumbers numbers{ rays, connectionsOf(settings, rays) };
  const double threshold = settings.lightEnergyConstraint ? LightEnergyTolerance *
      this->Setup.sensor.lowerEnergyLimit / static_cast<double>(numbers.total())
                                                          : 0.0;
  for (std::uint32_t n = 0; n < rays; ++n)
  {
    const RayHit& hit = this->Lit[n];
    if (!hit.valid())
    {
      continue;
    }
    const double energy =
      rayEnergy * hit.direct * transmission(settings.attenuationCoefficient, 2.0 * hit.range);
    if (energy < threshold)
    {
      lost += energy;
    }
    else if (energy > 0.0)
    {
      this->Units.add({ 2.0 * hit.range, energy, n });
    }
  }
}

void BeamSimulator::addSecondaryPaths(
  std::uint64_t id, const BeamFrame& frame, BeamTrace& trace, double& lost)
{
  const bool stratified = this->Setup.settings.sampling == Sampling::Stratified;
  const SecondaryReflection::Beam beam{ id, frame, this->Lit,
    stratified ? &this->Current->strata : nullptr, this->Tracer, trace, &this->Wanted };
  this->Secondary.collect(beam, this->Paths, lost);
  for (const SecondaryPath& path : this->Paths)
  {
    this->Units.add(path.contribution);
  }
  // Paths in the order of their numbers, so that a share finds its path by bisection.
  std::sort(this->Paths.begin(), this->Paths.end(),
    [](const SecondaryPath& a, const SecondaryPath& b)
    { return a.contribution.path < b.contribution.path; });
}

Echo BeamSimulator::makeEcho(const Return& ret) const
{
  Echo echo;
  echo.range = ret.range;
  echo.energyReceived = ret.energyReceived;
  echo.energy = ret.energy;
  echo.returnEnergy = ret.returnEnergy;
  echo.returnNumber = ret.returnNumber;
  echo.numberOfReturns = ret.numberOfReturns;
  echo.energyStdError = this->standardError(ret);
  this->label(ret, echo);
  return echo;
}

void BeamSimulator::label(const Return& ret, Echo& echo) const
{
  std::map<std::pair<int, int>, double> energyOf; // by object and material
  double all = 0.0;
  double secondary = 0.0;
  double angle = 0.0;
  const auto rays = static_cast<std::uint32_t>(this->Lit.size());
  for (std::size_t u = ret.firstUnit; u < ret.lastUnit; ++u)
  {
    const ReceivedUnit& unit = this->Receiver.units()[u];
    for (std::size_t s = unit.first; s < unit.last; ++s)
    {
      const RangeShare& share = this->Units.shares()[s];
      std::uint32_t triangle = 0;
      if (share.path < rays)
      {
        triangle = this->Lit[share.path].triangle;
        angle += share.energy * std::acos(this->Lit[share.path].cosIncidence);
      }
      else
      {
        const auto path = std::lower_bound(this->Paths.begin(), this->Paths.end(), share.path,
          [](const SecondaryPath& p, std::uint32_t number)
          { return p.contribution.path < number; });
        triangle = path->triangle;
        angle += share.energy * path->incidenceAngle;
        secondary += share.energy;
      }
      energyOf[{ this->Setup.objectIds[triangle], this->Setup.materialIds[triangle] }] +=
        share.energy;
      all += share.energy;
    }
  }
  if (all <= 0.0)
  {
    echo.incidenceAngle = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const auto largest = std::max_element(energyOf.begin(), energyOf.end(),
    [](const auto& a, const auto& b) { return a.second < b.second; });
  echo.objectId = largest->first.first;
  echo.materialId = largest->first.second;
  echo.labelShare = std::min(1.0, largest->second / all);
  echo.incidenceAngle = angle / all;
  echo.secondaryShare = secondary / all;
}

double BeamSimulator::standardError(const Return& ret) const
{
  const auto rays = static_cast<std::uint32_t>(this->Lit.size());
  const ReceivedUnit& unit = this->Receiver.units()[ret.strongestUnit];
  if (unit.first == unit.last)
  {
    return 0.0; // a false alarm: no ray had a part in it
  }
  const PathNumbers numbers{ rays, connectionsOf(this->Setup.settings, rays) };
  StandardErrorEstimator& error = this->Current->error;
  error.clear();
  for (std::size_t s = unit.first; s < unit.last; ++s)
  {
    const RangeShare& share = this->Units.shares()[s];
    error.add(numbers.rayOf(share.path), share.energy);
  }
  return error.estimate(error.largest(), this->fillsItsUnit(unit));
}

/// True if one plane fills the window of the range unit: every ray hit it, and put all its energy
/// here. A plane that spreads over several units is cut by their borders as by edges.
bool BeamSimulator::fillsItsUnit(const ReceivedUnit& unit) const
{
  return this->Units.units().size() == 1 && unit.last - unit.first >= this->Lit.size() &&
    onOnePlane(this->Lit);
}

BeamStatus BeamSimulator::statusOf(bool anyHit) const
{
  // Before the choice of the return mode: it says what is shown, not what the receiver heard.
  if (const Return* strongest = this->Receiver.strongest())
  {
    return strongest->energyReceived >= this->Setup.sensor.upperEnergyLimit ? BeamStatus::Saturated
                                                                            : BeamStatus::Echo;
  }
  if (!anyHit)
  {
    return BeamStatus::NoSurface;
  }
  const bool beyond = this->Units.units().empty() && this->Units.energyBeyondGate() > 0.0;
  return beyond ? BeamStatus::OutsideGate : BeamStatus::BelowLimit;
}
}
