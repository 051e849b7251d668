// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MeshTools.h
 * @brief Building blocks of the generated scenes.
 */
#ifndef avianlidar_MeshTools_h
#define avianlidar_MeshTools_h

#include "BenchmarkScene.h"
#include "Sensor.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>

namespace benchmarks
{
/// The same numbers on every machine, which the distributions of <random> do not promise.
class Numbers
{
public:
  explicit Numbers(std::uint64_t seed)
    : Engine(seed)
  {
  }
  double operator()(double lower, double upper)
  {
    return lower + (upper - lower) * (static_cast<double>(this->Engine() >> 11) * 0x1p-53);
  }

private:
  std::mt19937_64 Engine;
};

/// Two triangles that share the diagonal a-c.
inline void addQuad(TriangleMesh& mesh, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d)
{
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), { a, b, c, d });
  mesh.triangles.push_back({ n, n + 1, n + 2 });
  mesh.triangles.push_back({ n, n + 2, n + 3 });
}

/// Twelve triangles over eight points: `half` along x and y turned by `yaw`, z from `low` to
/// `high`.
inline void addBox(
  TriangleMesh& mesh, double x, double y, Vec3 half, double yaw, double low, double high)
{
  const auto n = static_cast<std::uint32_t>(mesh.points.size());
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  for (int k = 0; k < 8; ++k)
  {
    const double u = k & 1 ? half.x : -half.x;
    const double v = k & 2 ? half.y : -half.y;
    mesh.points.emplace_back(x + c * u - s * v, y + s * u + c * v, k & 4 ? high : low);
  }
  static const std::uint32_t faces[6][4] = { { 0, 1, 5, 4 }, { 1, 3, 7, 5 }, { 3, 2, 6, 7 },
    { 2, 0, 4, 6 }, { 4, 5, 7, 6 }, { 0, 2, 3, 1 } };
  for (const auto& f : faces)
  {
    mesh.triangles.push_back({ n + f[0], n + f[1], n + f[2] });
    mesh.triangles.push_back({ n + f[0], n + f[2], n + f[3] });
  }
}

/// Every triangle is the paper's wall.
inline void paintWall(Scene& scene)
{
  scene.materials.assign(scene.mesh->size(), avianlidar::Material{});
}

/// What hangs together by points is an object: triangles get the number of theirs, in the order of
/// the mesh.
inline void numberObjects(Scene& scene)
{
  const TriangleMesh& mesh = *scene.mesh;
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&parent](std::uint32_t p)
  {
    while (parent[p] != p)
    {
      p = parent[p] = parent[parent[p]];
    }
    return p;
  };
  for (const auto& corners : mesh.triangles)
  {
    const std::uint32_t root = rootOf(corners[0]);
    parent[rootOf(corners[1])] = root;
    parent[rootOf(corners[2])] = root;
  }
  std::vector<int> numbers(mesh.points.size(), -1);
  int objects = 0;
  scene.objectIds.clear();
  for (const auto& corners : mesh.triangles)
  {
    int& number = numbers[rootOf(corners[0])];
    if (number < 0)
    {
      number = objects++;
    }
    scene.objectIds.push_back(number);
  }
}
}

#endif
