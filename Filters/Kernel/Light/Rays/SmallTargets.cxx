// SPDX-License-Identifier: BSD-3-Clause
#include "SmallTargets.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace avianlidar
{
namespace
{
constexpr double LargestTarget = 0.5;

/// Each sampling cone of a beam has streams of its own.
RandomPurpose purposeOf(RandomPurpose rays, std::size_t cone)
{
  const RandomPurpose first =
    rays == RandomPurpose::Pilot ? RandomPurpose::TargetPilots : RandomPurpose::Targets;
  return static_cast<RandomPurpose>(
    static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(cone));
}

/// The largest first; a total order.
bool larger(const ObjectSpheres::Seen& a, const ObjectSpheres::Seen& b)
{
  return std::tie(b.share, a.sphere->number) < std::tie(a.share, b.sphere->number);
}
}

void BeamTargets::clear()
{
  this->cones.clear();
  this->leftOut = 0;
  this->found = false;
  this->wanted.clear();
  this->shares.clear();
}

SmallTargets::SmallTargets(const ScanSetup& setup, BeamSamplers& samplers)
  : Setup(setup)
  , Samplers(samplers)
  , Window(
      setup.sensor.halfBeamwidth, setup.needs.smallestTarget, endOfSmallTargets(setup.settings))
{
}

void SmallTargets::find(const BeamFrame& beam, BeamTargets& targets)
{
  targets.found = true;
  this->Seen.clear();
  this->Setup.objects->find(beam, this->Window, this->Seen);
  if (this->Seen.empty())
  {
    return;
  }
  const std::size_t count = std::min(this->Seen.size(), MaximumTargets);
  targets.leftOut = static_cast<std::uint32_t>(this->Seen.size() - count);
  std::partial_sort(this->Seen.begin(), this->Seen.begin() + count, this->Seen.end(), larger);
  for (std::size_t k = count; k-- > 0;)
  {
    const ObjectSphere& sphere = *this->Seen[k].sphere;
    const Vec3 to = sphere.center - beam.origin;
    const double halfAngle = std::asin(std::min(1.0, sphere.radius / safeLength(to)));
    targets.cones.push_back({ unitVector(to), halfAngle, this->Seen[k].share, sphere.id });
  }
}

void SmallTargets::draw(std::uint64_t beamId, const BeamFrame& beam, RandomPurpose purpose,
  const TargetRays& rays, BeamTargets& targets)
{
  const Sensor& sensor = this->Setup.sensor;
  const std::uint32_t all = sumOf(rays);
  targets.rays.resize(all);
  targets.shares.assign(all, 0.0);
  std::size_t n = 0;
  for (std::size_t g = 0; g < rays.size(); ++g)
  {
    const SamplingCone& cone = targets.cones[g];
    sampleBeam(this->Setup.settings.seed, beamId, rays[g], cone.halfAngle, BeamProfile::Uniform,
      Sampling::Stratified, &this->Samplers.of(rays[g]).strata, purposeOf(purpose, g), this->Own);
    const BeamFrame frame = makeBeamFrame(beam.origin, cone.axis, cone.halfAngle);
    for (std::uint32_t i = 0; i < rays[g]; ++i, ++n)
    {
      const Vec3 place = beam.toPlane(frame.direction(this->Own.x[i], this->Own.y[i]));
      const double x = place.x / place.z;
      const double y = place.y / place.z;
      const bool inside = place.z > 0.0 && x * x + y * y <= 1.0;
      targets.rays.x[n] = inside ? x : 0.0;
      targets.rays.y[n] = inside ? y : 0.0;
      targets.shares[n] = inside ? cone.solidAngle / rays[g] *
          rayDensity(sensor.beamProfile, sensor.halfBeamwidth, x * x + y * y)
                                 : 0.0;
    }
  }
}

bool SmallTargets::keepOwn(
  const BeamTargets& targets, const TargetRays& rays, std::uint32_t* triangles) const
{
  bool any = false;
  std::size_t n = 0;
  for (std::size_t g = 0; g < rays.size(); ++g)
  {
    for (std::uint32_t i = 0; i < rays[g]; ++i, ++n)
    {
      const bool counts = triangles[n] != NoTriangle && targets.shares[n] > 0.0 &&
        this->Setup.objectIds[triangles[n]] == targets.cones[g].object;
      triangles[n] = counts ? triangles[n] : NoTriangle;
      any = any || counts;
    }
  }
  return any;
}

void SmallTargets::weigh(const BeamTargets& targets, std::uint32_t rays, BeamSamples& samples) const
{
  bool met = false;
  samples.forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      const int object = this->Setup.objectIds[triangle];
      const bool isTarget = std::any_of(targets.cones.begin(), targets.cones.end(),
        [object](const SamplingCone& cone) { return cone.object == object; });
      met = met || isTarget;
      for (std::uint32_t i = begin; i < end; ++i)
      {
        const std::uint32_t ray = samples.ray[i];
        samples.weight[i] =
          ray >= rays ? targets.shares[ray - rays] : (isTarget ? 0.0 : 1.0 / rays);
      }
    });
  samples.rays = rays;
  samples.extraRays = met ? static_cast<std::uint32_t>(targets.shares.size()) : 0;
}

double endOfSmallTargets(const EchoSettings& settings)
{
  const double rays = settings.targetRelativeError > 0.0 ? PilotRays : settings.raysPerBeam;
  const double worth = settings.sampling == Sampling::MonteCarlo ? 1.5 : 1.0;
  return std::min(LargestTarget, worth * RaysOfTarget / rays);
}

std::uint32_t sumOf(const TargetRays& rays)
{
  return std::accumulate(rays.begin(), rays.end(), 0u);
}
}
