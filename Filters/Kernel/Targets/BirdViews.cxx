// SPDX-License-Identifier: BSD-3-Clause
#include "BirdViews.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace avianlidar
{
namespace
{
constexpr double ElevationStep = 4.0 * RadiansPerDegree;
/// Largest elevation of a line of sight, which must not be vertical.
constexpr double Steepest = 89.9 * RadiansPerDegree;

/// Poses by elevation, rad, that a law still uses.
struct KeptPoses
{
  std::mutex mutex;
  std::map<double, std::weak_ptr<const TargetPoses>> byElevation;
};
}

TargetViews birdViews(const BirdShape& shape, bool gliding, double meanArea)
{
  const std::size_t phases = gliding ? 1 : BirdPhases;
  const std::size_t headings = gliding ? GlidingHeadings : BirdHeadings;
  std::vector<TriangleMesh> birds;
  for (std::size_t phase = 0; phase < phases; ++phase)
  {
    // The wings pass the same angles up and down. Half a beat is therefore enough.
    const double beat = 0.5 * (static_cast<double>(phase) + 0.5) / static_cast<double>(phases);
    birds.push_back(wholeBird(shape, wingAngle(beat - 0.25, gliding)));
  }
  const double wide = 0.5 * shape.bodyDiameter + shape.wingLength;
  TargetViews views;
  // The body's polyhedron is longer than the ellipsoid by a few per cent.
  views.reach = std::hypot(std::max(wide, 0.6 * shape.bodyLength), shape.wingChord);
  views.step = ElevationStep;
  views.poses = phases * headings;
  views.headings = headings;
  const auto kept = std::make_shared<KeptPoses>();
  views.from = [=](double elevation) -> SharedPoses
  {
    const double up = std::clamp(elevation, -Steepest, Steepest);
    const std::lock_guard<std::mutex> lock(kept->mutex);
    std::weak_ptr<const TargetPoses>& known = kept->byElevation[up];
    if (const SharedPoses there = known.lock())
    {
      return there;
    }
    TargetPoses poses;
    for (std::size_t phase = 0; phase < phases; ++phase)
    {
      for (std::size_t k = 0; k < headings; ++k)
      {
        // The mesh heads north. A bird of heading h to the north appears as the mesh does along -h.
        const double shift = (static_cast<double>(phase) + 0.5) / static_cast<double>(phases);
        const double heading =
          2.0 * Pi * (static_cast<double>(k) + shift) / static_cast<double>(headings);
        poses.emplace_back(birds[phase],
          Vec3(-std::cos(up) * std::sin(heading), std::cos(up) * std::cos(heading), std::sin(up)),
          meanArea);
      }
    }
    const auto drawn = std::make_shared<const TargetPoses>(std::move(poses));
    known = drawn;
    return drawn;
  };
  return views;
}

double meanEffectiveArea(const BirdShape& shape, bool gliding)
{
  // A bird is symmetric, so half a turn covers all headings.
  constexpr int headings = 24;
  constexpr int phases = 24;
  constexpr double elevation = 3.0 * RadiansPerDegree;
  // The sum is NaN if a length is NaN.
  double sum = 0.0 * (shape.bodyLength + shape.bodyDiameter + shape.wingLength + shape.wingChord);
  int count = 0;
  for (int phase = 0; phase < (gliding ? 1 : phases); ++phase)
  {
    const TriangleMesh bird = wholeBird(shape, wingAngle((phase + 0.5) / phases, gliding));
    for (int k = 0; k < headings; ++k, ++count)
    {
      const double heading = Pi * (k + 0.5) / headings;
      sum += effectiveArea(bird,
        Vec3(-std::cos(elevation) * std::sin(heading), -std::cos(elevation) * std::cos(heading),
          std::sin(elevation)));
    }
  }
  return sum / count;
}
}
