// SPDX-License-Identifier: BSD-3-Clause
#include "MirrorPairs.h"

#include "Descents.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// Largest number of triangles per sample for which the search of a beam goes on.
constexpr std::size_t TrianglesPerSample = 2;

/// Least ratio of the smallest cosine of incidence in the cone to the cosine of the cone's axis. A
/// surface with a smaller ratio is not bounded.
constexpr double LeastCosine = 0.1;

/// Rounding of the height of a point above a plane, over the farthest coordinate involved.
constexpr double HeightNoise = 64.0 * RoundOffDouble;

/// Height of a triangle, over the farthest coordinate involved, below which its plane is
/// unreliable.
constexpr double SliverHeight = 1e-5;

/// Margin beyond all rounding, over the farthest coordinate involved.
constexpr double Slack = 1e-9;

double lengthOf(const Vec3& v)
{
  return std::sqrt(glm::dot(v, v));
}

/// Largest of `f` at the corners.
template <class F>
double most(const Corners& t, F f)
{
  return std::max(f(t.a), std::max(f(t.b), f(t.c)));
}

/// True if the triangle lies on one side of the pyramid around the cone.
bool isBeside(const Corners& t, const BeamFrame& frame, double slack)
{
  const double wide = frame.tanHalf * (1.0 + Slack);
  const auto inside = [&](const Vec3& side)
  {
    return most(t,
             [&](const Vec3& p)
             { return wide * glm::dot(frame.axis, p) - glm::dot(side, p); }) >= -slack;
  };
  return !(inside(frame.e1) && inside(-frame.e1) && inside(frame.e2) && inside(-frame.e2));
}
}

/// Collects the triangles that the cone may meet.
class MirrorPairs::Search
{
public:
  Search(MirrorPairs& pairs, const SecondaryBeam& beam, double farthest, std::size_t most)
    : Pairs(pairs)
    , Scene(beam.scene)
    , Frame(beam.frame)
    , Farthest(farthest)
    , Left(most)
  {
  }

  double limit() const { return this->Farthest; }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    if (count > this->Left)
    {
      for (Start& start : this->Pairs.Starts)
      {
        start.paired = true;
      }
      return false;
    }
    this->Left -= count;
    bool open = false;
    for (std::uint32_t i = 0; i < count; ++i)
    {
      this->look(triangles[i]);
    }
    for (const Start& start : this->Pairs.Starts)
    {
      open = open || !start.paired;
    }
    return open;
  }

private:
  void look(std::uint32_t triangle)
  {
    const Corners corners = this->Scene.cornersFrom(triangle, this->Frame.origin);
    const double reach = this->Farthest +
      most(corners,
        [](const Vec3& p)
        { return std::max(std::fabs(p.x), std::max(std::fabs(p.y), std::fabs(p.z))); });
    if (isBeside(corners, this->Frame, Slack * reach))
    {
      return;
    }
    const TrianglePlane plane = planeOf(corners);
    for (Start& start : this->Pairs.Starts)
    {
      start.paired = start.paired || this->Pairs.facing(start, this->Frame, corners, plane, reach);
    }
  }

  MirrorPairs& Pairs;
  const SceneTriangles& Scene;
  const BeamFrame& Frame;
  double Farthest;
  std::size_t Left;
};

/// False if no mirror path ends on the triangle.
bool MirrorPairs::facing(const Start& start, const BeamFrame& frame, const Corners& corners,
  const TrianglePlane& plane, double reach) const
{
  // A part of the triangle must lie before the surface. A hit lies off its triangle by a multiple
  // of HitMargin in the triangle's own plane (TriangleTest.h).
  const Vec3& n = start.normal;
  const double size = lengthOf(plane.normal);
  const double turned = size > 0.0 ? lengthOf(glm::cross(n, plane.normal)) / size : 1.0;
  const double noise = (HeightNoise + 4.0 * HitMargin * turned) * reach;
  const auto above = [&](const Vec3& p) { return glm::dot(n, p) + start.height; };
  if (most(corners, above) < start.least - noise)
  {
    return false;
  }
  if (!(size > SliverHeight * reach * std::sqrt(plane.longestSquared)))
  {
    return true;
  }
  // The triangle's plane must be within reach of the cone before the surface.
  const Vec3 up = plane.height > 0.0 ? -plane.normal : plane.normal;
  const double down = -glm::dot(up, frame.axis) * frame.cosHalf +
    lengthOf(glm::cross(up, frame.axis)) * frame.sinHalf;
  if (start.farthest * down < std::fabs(plane.height) - Slack * reach * size)
  {
    return false;
  }
  // Some hits must lie before the side of the plane that faces the apex.
  const Vec3 half = 0.5 * start.hits.upper - 0.5 * start.hits.lower;
  return glm::dot(up, start.hits.center()) + glm::dot(glm::abs(up), half) +
    std::fabs(plane.height) >=
    -Slack * reach * size;
}

/// Set the starts, and pair the starts that cannot be bounded. @return range, m, beyond which no
/// path of the other starts ends
double MirrorPairs::measure(const SecondaryBeam& beam)
{
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const SampleGeometry& geometry = beam.geometry;
  const BeamFrame& frame = beam.frame;
  this->Starts.clear();
  for (const SampleGeometry::Surface& surface : geometry.surfaces)
  {
    this->Starts.push_back({ surface.normal, surface.height, 0.0, infinity, 0.0, AABB{}, false });
  }
  for (std::uint32_t hit = 0; hit < beam.samples.size(); ++hit)
  {
    Start& start = this->Starts[geometry.surface[hit]];
    const Vec3 direction = geometry.direction(hit);
    const Vec3 point = beam.samples.range[hit] * direction;
    const double height = glm::dot(start.normal, point) + start.height;
    const double cosine = -glm::dot(start.normal, direction);
    // The search along a path of this hit begins at twice this height.
    start.least =
      std::min(start.least, height + 0.5 * surfaceMargin(beam.samples.range[hit]) * cosine);
    start.off = std::max(start.off, std::fabs(height));
    start.hits.extend(point);
    start.paired = start.paired || !(cosine > 0.0);
  }
  double farthest = 0.0;
  for (Start& start : this->Starts)
  {
    // The smallest cosine of incidence of any ray of the cone.
    const double cosine = -glm::dot(start.normal, frame.axis);
    const double sine = lengthOf(glm::cross(start.normal, frame.axis));
    const double least = cosine * frame.cosHalf - sine * frame.sinHalf;
    start.paired = start.paired || !(least > LeastCosine * cosine);
    if (!start.paired)
    {
      start.farthest = (start.height + start.off) / least * (1.0 + Slack);
      farthest = std::max(farthest, start.farthest);
    }
  }
  return farthest;
}

void MirrorPairs::find(const SecondaryBeam& beam)
{
  const double farthest = this->measure(beam);
  if (!(farthest > 0.0))
  {
    return;
  }
  Search search(*this, beam, farthest, TrianglesPerSample * beam.samples.size());
  const std::vector<std::uint32_t>& moved = beam.scene.moved();
  const bool open = search.leaf(moved.data(), static_cast<std::uint32_t>(moved.size()));
  if (open && !beam.scene.tree().empty())
  {
    descendCone(beam.scene.tree(), beam.frame, search, this->Stack);
  }
}
}
