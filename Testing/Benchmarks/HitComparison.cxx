// SPDX-License-Identifier: BSD-3-Clause
#include "HitComparison.h"

#include <algorithm>
#include <cmath>

namespace benchmarks
{
using namespace avianlidar;

namespace
{
double angleBetween(const Vec3& a, const Vec3& b)
{
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// Angle between the direction d and the side a-b as seen from the apex.
double angleToSide(const Vec3& d, const Vec3& a, const Vec3& b)
{
  const Vec3 normal = glm::cross(a, b);
  const double length = glm::length(normal);
  if (length > 0.0)
  {
    const Vec3 n = normal / length;
    const Vec3 foot = d - glm::dot(d, n) * n;
    if (glm::dot(glm::cross(a, foot), n) >= 0.0 && glm::dot(glm::cross(foot, b), n) >= 0.0)
    {
      return std::asin(std::min(1.0, std::fabs(glm::dot(d, n))));
    }
  }
  return std::min(angleBetween(d, a), angleBetween(d, b));
}

bool atEdge(const Scene& scene, const Hit& hit, const Vec3& d)
{
  if (!hit.valid())
  {
    return false;
  }
  Vec3 corners[3];
  double farthest = 0.0;
  for (int c = 0; c < 3; ++c)
  {
    corners[c] = scene.mesh->corner(hit.triangle, c) - scene.apex;
    farthest = std::max(farthest, glm::length(corners[c]));
  }
  const double tolerance = 1e-5 + 16.0 * 0x1p-24 * farthest / std::max(hit.range, 1e-3);
  for (int c = 0; c < 3; ++c)
  {
    if (angleToSide(d, corners[c], corners[(c + 1) % 3]) < tolerance)
    {
      return true;
    }
  }
  return false;
}
}

HitAgreement compareHits(const Scene& scene, const Workload& work, const std::vector<Hit>& ours,
  const std::vector<Hit>& theirs)
{
  HitAgreement agreement;
  agreement.rays = ours.size();
  for (std::size_t i = 0; i < ours.size(); ++i)
  {
    agreement.hits += ours[i].valid();
    const bool same = ours[i].valid() == theirs[i].valid() &&
      (!ours[i].valid() || std::fabs(ours[i].range - theirs[i].range) <= 1e-3 * ours[i].range);
    if (!same)
    {
      ++agreement.differ;
      const Vec3 d = work.direction(i);
      agreement.atEdges += atEdge(scene, ours[i], d) || atEdge(scene, theirs[i], d);
    }
  }
  return agreement;
}
}
