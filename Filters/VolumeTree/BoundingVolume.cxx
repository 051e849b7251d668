// SPDX-License-Identifier: BSD-3-Clause
#include "BoundingVolume.h"

#include "PrincipalAxes.h"

namespace avianlidar
{
namespace
{
constexpr double Ulp = std::numeric_limits<double>::epsilon();

/// The corners of triangles, seen one by one.
struct CornerSet
{
  const TriangleMesh& mesh;
  const std::uint32_t* triangles;
  std::size_t count;
  template <class F>
  void each(F&& f) const
  {
    for (std::size_t i = 0; i < this->count; ++i)
    {
      for (const std::uint32_t p : this->mesh.triangles[this->triangles[i]])
      {
        f(this->mesh.points[p]);
      }
    }
  }
};

Vec3 inAxes(const std::array<Vec3, 3>& axes, const Vec3& v)
{
  return { glm::dot(axes[0], v), glm::dot(axes[1], v), glm::dot(axes[2], v) };
}

Vec3 fromAxes(const std::array<Vec3, 3>& axes, const Vec3& v)
{
  return v.x * axes[0] + v.y * axes[1] + v.z * axes[2];
}

AABB fitBox(const CornerSet& set)
{
  AABB box;
  set.each([&](const Vec3& p) { box.extend(p); });
  return box;
}

/// Box along given axes. The second pass measures from the rounded centre, so that its rounding
/// costs nothing.
OBB fitAlong(const CornerSet& set, const std::array<Vec3, 3>& axes, const Vec3& reference)
{
  AABB local;
  set.each([&](const Vec3& p) { local.extend(inAxes(axes, p - reference)); });
  OBB box;
  box.axes = axes;
  box.center = reference + fromAxes(axes, local.center());
  box.half = Vec3(0.0);
  set.each(
    [&](const Vec3& p) { box.half = glm::max(box.half, glm::abs(inAxes(axes, p - box.center))); });
  // The axes are orthonormal to rounding only; other code may multiply in another order.
  box.half += Vec3(8.0 * Ulp * (box.half.x + box.half.y + box.half.z));
  return box;
}

OBB fitOriented(const CornerSet& set)
{
  const AABB box = fitBox(set);
  if (box.empty())
  {
    return {};
  }
  const Vec3 reference = box.center();
  Vec3 sum(0.0);
  double count = 0.0;
  set.each(
    [&](const Vec3& p)
    {
      sum += p - reference;
      count += 1.0;
    });
  const Vec3 mean = sum / count;
  SecondMoments moments;
  set.each([&](const Vec3& p) { moments.add((p - reference) - mean); });
  const OBB principal = fitAlong(set, principalAxes(moments.sums), reference);
  const OBB aligned = fitAlong(set, OBB().axes, reference);
  return surfaceArea(principal) < surfaceArea(aligned) ? principal : aligned;
}

BoundingSphere fitSphere(const CornerSet& set)
{
  const AABB box = fitBox(set);
  if (box.empty())
  {
    return {};
  }
  // Steps towards the farthest point, ever shorter, from the centre of the box; the best centre
  // seen is kept.
  constexpr int Steps = 12;
  BoundingSphere best;
  best.radius = std::numeric_limits<double>::infinity();
  Vec3 center = box.center();
  for (int step = 0; step < Steps; ++step)
  {
    double farthest = -1.0;
    Vec3 farthestPoint(0.0);
    set.each(
      [&](const Vec3& p)
      {
        const Vec3 d = p - center;
        const double squared = glm::dot(d, d);
        if (squared > farthest)
        {
          farthest = squared;
          farthestPoint = p;
        }
      });
    const double radius = std::sqrt(farthest);
    if (radius < best.radius)
    {
      best.center = center;
      best.radius = radius;
    }
    center += (farthestPoint - center) * (0.5 / (step + 2.0));
  }
  best.radius *= 1.0 + 8.0 * Ulp;
  return best;
}
}

bool contains(const AABB& v, const Vec3& p)
{
  return v.lower.x <= p.x && p.x <= v.upper.x && v.lower.y <= p.y && p.y <= v.upper.y &&
    v.lower.z <= p.z && p.z <= v.upper.z;
}

bool contains(const OBB& v, const Vec3& p)
{
  const Vec3 q = glm::abs(inAxes(v.axes, p - v.center));
  return q.x <= v.half.x && q.y <= v.half.y && q.z <= v.half.z;
}

bool contains(const BoundingSphere& v, const Vec3& p)
{
  return v.radius >= 0.0 && glm::length(p - v.center) <= v.radius;
}

double surfaceArea(const OBB& v)
{
  return v.empty() ? 0.0 : 8.0 * (v.half.x * v.half.y + v.half.y * v.half.z + v.half.z * v.half.x);
}

template <>
AABB fitToTriangles<AABB>(
  const TriangleMesh& mesh, const std::uint32_t* triangles, std::size_t count)
{
  return fitBox(CornerSet{ mesh, triangles, count });
}

template <>
OBB fitToTriangles<OBB>(const TriangleMesh& mesh, const std::uint32_t* triangles, std::size_t count)
{
  return fitOriented(CornerSet{ mesh, triangles, count });
}

template <>
BoundingSphere fitToTriangles<BoundingSphere>(
  const TriangleMesh& mesh, const std::uint32_t* triangles, std::size_t count)
{
  return fitSphere(CornerSet{ mesh, triangles, count });
}
}
