// SPDX-License-Identifier: BSD-3-Clause
#include "MeshTools.h"

#include <algorithm>

namespace benchmarks
{
namespace
{
/// One face of an octahedron with the corners p, q, r (unit vectors), divided in n^2 triangles, on
/// the unit sphere.
void addFace(TriangleMesh& mesh, const Vec3& p, const Vec3& q, const Vec3& r, std::uint32_t n)
{
  const auto first = static_cast<std::uint32_t>(mesh.points.size());
  for (std::uint32_t i = 0; i <= n; ++i)
  {
    for (std::uint32_t j = 0; j <= i; ++j)
    {
      // The same bits from both faces at an edge: corners that carry no weight add exact zeros, and
      // the sum of two does not depend on their order.
      const Vec3 sum = double(n - i) * p + (double(i - j) * q + double(j) * r);
      mesh.points.push_back(sum / glm::length(sum));
    }
  }
  const auto number = [&](std::uint32_t i, std::uint32_t j) { return first + i * (i + 1) / 2 + j; };
  for (std::uint32_t i = 0; i < n; ++i)
  {
    for (std::uint32_t j = 0; j <= i; ++j)
    {
      mesh.triangles.push_back({ number(i, j), number(i + 1, j), number(i + 1, j + 1) });
      if (j < i)
      {
        mesh.triangles.push_back({ number(i, j), number(i + 1, j + 1), number(i, j + 1) });
      }
    }
  }
}
}

Scene makeSphere(std::size_t triangles)
{
  const auto n = static_cast<std::uint32_t>(
    std::max(1.0, std::round(std::sqrt(static_cast<double>(triangles) / 8.0))));
  Scene scene;
  scene.name = "sphere " + std::to_string(triangles);
  scene.mesh = std::make_shared<TriangleMesh>();
  scene.mesh->triangles.reserve(8 * std::size_t(n) * n);
  for (int octant = 0; octant < 8; ++octant)
  {
    const Vec3 x(octant & 1 ? -1.0 : 1.0, 0.0, 0.0);
    const Vec3 y(0.0, octant & 2 ? -1.0 : 1.0, 0.0);
    const Vec3 z(0.0, 0.0, octant & 4 ? -1.0 : 1.0);
    addFace(*scene.mesh, x, y, z, n);
  }
  // Turned, so that none of its edges lies along the scan.
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  for (Vec3& p : scene.mesh->points)
  {
    p = Vec3(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
    p = Vec3(p.x, c * p.y - s * p.z, s * p.y + c * p.z);
    p = 30.0 * p + Vec3(0.0, 100.0, 0.0);
  }
  avianlidar::ScanPattern& pattern = scene.pattern;
  pattern.channels = 120;
  pattern.elevationStep = 0.3125;
  pattern.minimumElevation = -0.3125 * 59.5;
  pattern.azimuthStep = 0.3125;
  pattern.azimuthStart = -20.0;
  pattern.azimuthEnd = 20.0;
  pattern.firingInterval = 1e-6;
  paintWall(scene);
  numberObjects(scene);
  return scene;
}
}
