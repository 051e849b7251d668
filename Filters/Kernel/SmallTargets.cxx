// SPDX-License-Identifier: BSD-3-Clause
#include "SmallTargets.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace avianlidar
{
namespace
{
/// Each guard cone of a beam has a stream of its own.
RandomPurpose purposeOf(std::size_t guard)
{
  return static_cast<RandomPurpose>(
    static_cast<std::uint32_t>(RandomPurpose::Targets) + static_cast<std::uint32_t>(guard));
}

/// The largest first; a total order of spheres that differ.
bool larger(const ObjectSpheres::Seen& a, const ObjectSpheres::Seen& b)
{
  const ObjectSphere& p = *a.sphere;
  const ObjectSphere& q = *b.sphere;
  return std::tie(b.share, p.radius, p.center.x, p.center.y, p.center.z) <
    std::tie(a.share, q.radius, q.center.x, q.center.y, q.center.z);
}
}

SmallTargets::SmallTargets(std::int32_t seed, double halfBeamwidth, BeamProfile profile)
  : Seed(seed)
  , HalfBeamwidth(halfBeamwidth)
  , Profile(profile)
  , Strata(RaysOfTarget)
{
}

void SmallTargets::find(const ObjectSpheres& objects, const BeamFrame& beam, std::uint32_t rays,
  double smallest, std::vector<GuardCone>& guards)
{
  guards.clear();
  this->Seen.clear();
  if (this->Window.from != smallest || this->Window.to != 1.0 / rays)
  {
    this->Window = ShareWindow(this->HalfBeamwidth, smallest, 1.0 / rays);
  }
  objects.find(beam, this->Window, this->Seen);
  if (this->Seen.empty())
  {
    return;
  }
  const std::size_t count = std::min(this->Seen.size(), MaximumTargets);
  std::partial_sort(this->Seen.begin(), this->Seen.begin() + count, this->Seen.end(), larger);
  for (std::size_t k = count; k-- > 0;)
  {
    const ObjectSphere& sphere = *this->Seen[k].sphere;
    const Vec3 to = sphere.center - beam.origin;
    const double halfAngle = std::asin(std::min(1.0, sphere.radius / safeLength(to)));
    const double s = 2.0 * std::sin(0.5 * halfAngle);
    guards.push_back({ unitVector(to), halfAngle, s * s, this->Seen[k].share });
  }
}

void SmallTargets::draw(std::uint64_t beamId, const BeamFrame& beam,
  const std::vector<GuardCone>& guards, BeamRays& rays, std::vector<double>& shares)
{
  rays.resize(guards.size() * RaysOfTarget);
  shares.assign(rays.size(), 0.0);
  for (std::size_t g = 0; g < guards.size(); ++g)
  {
    const GuardCone& guard = guards[g];
    sampleBeam(this->Seed, beamId, RaysOfTarget, guard.halfAngle, BeamProfile::Uniform,
      Sampling::Stratified, &this->Strata, purposeOf(g), this->Own);
    const BeamFrame cone = makeBeamFrame(beam.origin, guard.axis, guard.halfAngle);
    for (std::uint32_t i = 0; i < RaysOfTarget; ++i)
    {
      const Vec3 direction = cone.direction(this->Own.x[i], this->Own.y[i]);
      const Vec3 place = beam.toPlane(direction);
      const Vec3 unit = direction / safeLength(direction);
      const std::size_t n = g * RaysOfTarget + i;
      const double x = place.x / place.z;
      const double y = place.y / place.z;
      const bool counts = place.z > 0.0 && x * x + y * y <= 1.0 &&
        std::none_of(guards.begin(), guards.begin() + g,
          [&](const GuardCone& smaller) { return smaller.contains(unit); });
      rays.x[n] = counts ? x : 0.0;
      rays.y[n] = counts ? y : 0.0;
      shares[n] = counts ? guard.solidAngle / RaysOfTarget *
          rayDensity(this->Profile, this->HalfBeamwidth, x * x + y * y)
                         : 0.0;
    }
  }
}

void shareOut(const std::vector<GuardCone>& guards, const HitGeometry& geometry,
  const std::vector<double>& shares, PrimaryHits& hits)
{
  hits.share.resize(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    const std::uint32_t ray = hits.ray[i];
    if (ray >= hits.rays)
    {
      hits.share[i] = shares[ray - hits.rays];
      continue;
    }
    const Vec3 direction = geometry.direction(i);
    const bool guarded = std::any_of(guards.begin(), guards.end(),
      [&direction](const GuardCone& guard) { return guard.contains(direction); });
    hits.share[i] = guarded ? 0.0 : 1.0 / hits.rays;
  }
}
}
