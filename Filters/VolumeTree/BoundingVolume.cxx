// SPDX-License-Identifier: BSD-3-Clause
#include "BoundingVolume.h"

#include "AABB.h"
#include "PrincipalAxes.h"

namespace avianlidar
{
namespace
{
constexpr double Ulp = std::numeric_limits<double>::epsilon();

/// Call `f` with each corner.
template <class F>
void forCorners(const TriangleList& triangles, F&& f)
{
  for (std::size_t i = 0; i < triangles.count; ++i)
  {
    for (int c = 0; c < 3; ++c)
    {
      f(triangles.mesh.corner(triangles.numbers[i], c));
    }
  }
}

/// Centre of the axis-aligned box.
Vec3 middleOf(const TriangleList& triangles)
{
  AABB box;
  forCorners(triangles, [&](const Vec3& p) { box.extend(p); });
  return box.center();
}

/// Smallest box along the axes of `box`. The second pass measures from the rounded centre, so that
/// the rounding of the centre does not matter.
OBB fitAlong(const TriangleList& triangles, OBB box)
{
  if (triangles.count == 0)
  {
    return {};
  }
  const Vec3 reference = middleOf(triangles);
  AABB local;
  forCorners(triangles, [&](const Vec3& p) { local.extend(box.along(p - reference)); });
  const Vec3 middle = local.center();
  box.center = reference + box.axes * middle;
  box.half = Vec3(0.0);
  forCorners(triangles,
    [&](const Vec3& p) { box.half = glm::max(box.half, glm::abs(box.along(p - box.center))); });
  // Rounding leaves the axes not quite orthonormal. Other code may also multiply in another order.
  box.half += Vec3(8.0 * Ulp * (box.half.x + box.half.y + box.half.z));
  return box;
}
}

double surfaceArea(const OBB& v)
{
  return v.empty() ? 0.0 : 8.0 * (v.half.x * v.half.y + v.half.y * v.half.z + v.half.z * v.half.x);
}

AlignedBox alignedBox(const TriangleList& triangles)
{
  const OBB box = fitAlong(triangles, OBB());
  return { box.center, box.half };
}

OBB orientedBox(const TriangleList& triangles)
{
  const OBB aligned = alignedBox(triangles);
  Vec3 mean(0.0);
  forCorners(triangles, [&](const Vec3& p) { mean += p - aligned.center; });
  mean /= 3.0 * static_cast<double>(triangles.count);
  glm::dmat3 moments(0.0);
  forCorners(triangles,
    [&](const Vec3& p)
    {
      const Vec3 off = (p - aligned.center) - mean;
      moments += glm::outerProduct(off, off);
    });
  OBB principal;
  principal.axes = principalAxes(moments);
  principal = fitAlong(triangles, principal);
  return surfaceArea(principal) < surfaceArea(aligned) ? principal : aligned;
}

BoundingSphere boundingSphere(const TriangleList& triangles)
{
  BoundingSphere best;
  if (triangles.count == 0)
  {
    return best;
  }
  // The centre moves from the middle of the box towards the farthest point in ever shorter steps.
  // The best centre is kept.
  best.radius = std::numeric_limits<double>::infinity();
  Vec3 center = middleOf(triangles);
  constexpr int Steps = 12;
  for (int step = 0; step < Steps; ++step)
  {
    double squared = -1.0;
    Vec3 farthest(0.0);
    forCorners(triangles,
      [&](const Vec3& p)
      {
        const Vec3 d = p - center;
        if (glm::dot(d, d) > squared)
        {
          squared = glm::dot(d, d);
          farthest = p;
        }
      });
    if (std::sqrt(squared) < best.radius)
    {
      best = { center, std::sqrt(squared) };
    }
    center += (farthest - center) * (0.5 / (step + 2.0));
  }
  best.radius *= 1.0 + 8.0 * Ulp;
  return best;
}
}
