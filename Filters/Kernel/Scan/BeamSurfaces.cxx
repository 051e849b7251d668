// SPDX-License-Identifier: BSD-3-Clause
#include "BeamSurfaces.h"

#include "BeamShape.h"
#include "BeamSimulator.h"
#include "MovedBeams.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

namespace avianlidar
{
namespace
{
constexpr int SidesOfDisc = 64;

using SurfaceSums = std::map<std::uint32_t, SeenSurface>;

/// The sums of a triangle, begun if the triangle is new.
SeenSurface& surfaceOf(const ScanSetup& setup, std::uint32_t triangle, SurfaceSums& sums)
{
  const auto [place, isNew] = sums.try_emplace(triangle);
  SeenSurface& surface = place->second;
  if (isNew)
  {
    surface.objectId = setup.objectId(triangle);
    surface.materialId = setup.materialId(triangle);
    surface.nearest = std::numeric_limits<double>::infinity();
  }
  return surface;
}

/// Corners of a triangle, or of its quadrilateral if the next or the previous triangle belongs to
/// the same surface and is not in `sums` itself.
std::vector<Vec3> cornersOf(const ScanSetup& setup, const SceneTriangles& scene,
  std::uint32_t triangle, const SurfaceSums& sums)
{
  std::vector<Vec3> corners = { scene.corner(triangle, 0), scene.corner(triangle, 1),
    scene.corner(triangle, 2) };
  const Vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  for (const std::uint32_t other : { triangle + 1, triangle - 1 })
  {
    if (!scene.holds(other) || sums.count(other) > 0 ||
      setup.objectId(other) != setup.objectId(triangle) ||
      setup.materialId(other) != setup.materialId(triangle))
    {
      continue;
    }
    for (int c = 0; c < 3; ++c)
    {
      const Vec3 from = scene.corner(other, (c + 1) % 3);
      const Vec3 to = scene.corner(other, (c + 2) % 3);
      const Vec3 apart = scene.corner(other, c) - from;
      const bool inPlane =
        std::fabs(glm::dot(normal, apart)) <= 1e-9 * safeLength(normal) * safeLength(apart);
      for (std::size_t k = 0; k < 3 && inPlane; ++k)
      {
        const Vec3& a = corners[k];
        const Vec3& b = corners[(k + 1) % 3];
        if ((a == from && b == to) || (a == to && b == from))
        {
          corners.insert(
            corners.begin() + static_cast<std::ptrdiff_t>(k + 1), scene.corner(other, c));
          return corners;
        }
      }
    }
  }
  return corners;
}

/// Keep the part of a polygon where dot(inward, p) >= least.
void cut(const Vec3& inward, double least, std::vector<Vec3>& polygon)
{
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i)
  {
    const Vec3& from = polygon[i];
    const Vec3& to = polygon[(i + 1) % polygon.size()];
    const double a = glm::dot(inward, from) - least;
    const double b = glm::dot(inward, to) - least;
    if (a >= 0.0)
    {
      kept.push_back(from);
    }
    if ((a < 0.0) != (b < 0.0))
    {
      kept.push_back(from + (a / (a - b)) * (to - from));
    }
  }
  polygon.swap(kept);
}

/// Light a single beam, and call f(light, scene).
template <class F>
void light(
  const ScanSetup& setup, const ScanBeams& one, const std::function<bool()>& wanted, const F& f)
{
  BeamSampler sampler(setup.sensor, setup.settings.sampling, tracedRaysOf(setup.settings));
  const ScanAir air(setup.sensor, setup.air());
  BeamResults results;
  BeamReport report;
  if (setup.movers && !setup.movers->empty())
  {
    MovedBeams moved(setup, air, one, sampler, wanted, true);
    moved.find(0, 1);
    if (moved.isTouched(0))
    {
      std::vector<MoverLight> sights;
      const MovedBeams::Followed followed =
        moved.simulate(0, results, report, sights, BeamLight(setup.sensor));
      f(followed.light, moved.scene());
      return;
    }
  }
  std::vector<KeptBeam> kept(1);
  BeamSimulator simulator(setup, air, one, { false, true }, sampler, wanted);
  BeamSimulator::Traced traced = simulator.trace(0, 1, kept, {}, {});
  f(simulator.follow(0, traced.of(0), kept[0], results, report, BeamLight(setup.sensor)),
    simulator.scene());
}

/// Add the samples of a beam: shares, energies with ranges and angles, or both.
void addSamples(
  const ScanSetup& setup, const BeamLight& light, bool shares, bool energies, SurfaceSums& sums)
{
  const BeamSamples* samples = light.samples();
  if (!samples)
  {
    return;
  }
  samples->forEachSurface(
    [&](std::uint32_t triangle, std::uint32_t begin, std::uint32_t end)
    {
      SeenSurface& surface = surfaceOf(setup, triangle, sums);
      for (std::uint32_t i = begin; i < end; ++i)
      {
        const double weight = samples->weight[i];
        surface.share += shares ? weight : 0.0;
        if (energies)
        {
          surface.weight += weight;
          surface.energy += light.energies.empty() ? 0.0 : light.energies[i];
          surface.range += weight * samples->range[i];
          surface.cosine += weight * samples->cosine[i];
          surface.nearest = std::min(surface.nearest, samples->range[i]);
          surface.farthest = std::max(surface.farthest, samples->range[i]);
        }
      }
    });
}
}

std::vector<SeenSurface> surfacesAlong(const ScanSetup& setup, const ScanBeams& beams,
  std::size_t beam, const std::function<bool()>& wanted)
{
  ScanBeams one;
  one.ids = { beams.ids[beam] };
  one.origins = { beams.origins[beam] };
  one.directions = { beams.directions[beam] };
  one.times = { beams.timeOf(beam) };
  SurfaceSums sums;
  const bool uniform = setup.sensor.beamProfile == BeamProfile::Uniform;
  light(setup, one, wanted,
    [&](const BeamLight& lit, const SceneTriangles& scene)
    {
      addSamples(setup, lit, uniform, true, sums);
      for (auto& [triangle, surface] : sums)
      {
        surface.corners = cornersOf(setup, scene, triangle, sums);
      }
    });
  if (!uniform)
  {
    ScanSetup even = setup;
    even.sensor.beamProfile = BeamProfile::Uniform;
    light(even, one, wanted,
      [&](const BeamLight& lit, const SceneTriangles&)
      { addSamples(setup, lit, true, false, sums); });
  }
  std::vector<SeenSurface> seen;
  double all = 0.0;
  for (const auto& [triangle, surface] : sums)
  {
    all += surface.share;
  }
  for (auto& [triangle, surface] : sums)
  {
    surface.share /= std::max(1.0, all); // shares exceed 1 by rounding alone
    if (surface.weight > 0.0)
    {
      surface.range /= surface.weight;
      surface.cosine /= surface.weight;
    }
    else
    {
      surface.range = surface.nearest = surface.farthest = std::numeric_limits<double>::quiet_NaN();
    }
    if (surface.weight > 0.0 || surface.share > 0.0)
    {
      seen.push_back(surface);
    }
  }
  return seen;
}

std::vector<Vec3> outlineOf(const BeamFrame& frame)
{
  std::vector<Vec3> outline;
  if (frame.isRectangle)
  {
    const double h = BeamShape::HalfSide;
    return { frame.direction(h, h), frame.direction(-h, h), frame.direction(-h, -h),
      frame.direction(h, -h) };
  }
  for (int i = 0; i < SidesOfDisc; ++i)
  {
    const double angle = 2.0 * Pi * i / SidesOfDisc;
    outline.push_back(frame.direction(std::cos(angle), std::sin(angle)));
  }
  return outline;
}

std::vector<Vec3> partWithin(
  const BeamFrame& frame, const std::vector<Vec3>& outline, const SeenSurface& surface)
{
  std::vector<Vec3> part;
  for (const Vec3& corner : surface.corners)
  {
    part.push_back(corner - frame.origin);
  }
  // Each plane of the outline in turn cuts off the part outside (Sutherland and Hodgman).
  for (std::size_t k = 0; k < outline.size() && !part.empty(); ++k)
  {
    const Vec3 inward = glm::cross(outline[k], outline[(k + 1) % outline.size()]);
    cut(glm::dot(inward, frame.axis) < 0.0 ? -inward : inward, 0.0, part);
  }
  // Because of rounding, a margin of 1e-6 keeps surfaces that are square to the beam.
  cut(frame.axis, frame.cosHalf * surface.nearest * (1.0 - 1e-6), part);
  cut(-frame.axis, -surface.farthest * (1.0 + 1e-6), part);
  return part.size() < 3 ? std::vector<Vec3>() : part;
}
}
