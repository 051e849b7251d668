// SPDX-License-Identifier: BSD-3-Clause
#include "ConvexBody.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
bool isConvexBody(const TriangleMesh& mesh, const Vec3& from)
{
  Vec3 low = mesh.points[0], high = low, sum(0.0);
  for (const Vec3& p : mesh.points)
  {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const double size = glm::length(high - low);
  double area = 0.0;
  bool outside = false;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Vec3& corner = mesh.corner(t, 0);
    Vec3 normal = glm::cross(mesh.corner(t, 1) - corner, mesh.corner(t, 2) - corner);
    const double twice = glm::length(normal);
    if (!(twice > 1e-12 * size * size))
    {
      continue; // degenerate, as at the poles of a sphere
    }
    normal /= twice;
    double above = 0.0, below = 0.0;
    for (const auto& other : mesh.triangles)
    {
      for (const std::uint32_t c : other)
      {
        const double height = glm::dot(mesh.points[c] - corner, normal);
        above = std::max(above, height);
        below = std::max(below, -height);
      }
      if (above > 1e-6 * size && below > 1e-6 * size)
      {
        return false;
      }
    }
    normal *= above > below ? -1.0 : 1.0;
    outside = outside || glm::dot(from - corner, normal) > 0.0;
    sum += twice * normal;
    area += twice;
  }
  return outside && glm::length(sum) < 1e-3 * area;
}
}
