// SPDX-License-Identifier: BSD-3-Clause
#include "SceneTriangles.h"

#include "CollisionTreeBuilder.h"

namespace avianlidar
{
namespace
{
/// Largest number of triangles of a mover without a tree. Rays are tested against each of these
/// triangles.
constexpr std::size_t FewMoved = 64;
}

void SceneTriangles::clear()
{
  this->Numbers.clear();
  this->MovedTree.reset();
}

void SceneTriangles::place(std::uint32_t first, const TriangleMesh& mesh)
{
  const std::size_t begin = first - this->Fixed;
  this->Moved.resize(std::max(this->Moved.size(), begin + mesh.size()));
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    this->Moved[begin + t] = { mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2) };
    this->Numbers.push_back(first + t);
  }
}

void SceneTriangles::finish()
{
  if (this->Numbers.size() <= FewMoved)
  {
    return;
  }
  const auto mesh = std::make_shared<TriangleMesh>();
  for (const std::uint32_t number : this->Numbers)
  {
    const auto corner = static_cast<std::uint32_t>(mesh->points.size());
    mesh->triangles.push_back({ corner, corner + 1, corner + 2 });
    const std::array<Vec3, 3>& corners = this->Moved[number - this->Fixed];
    mesh->points.insert(mesh->points.end(), corners.begin(), corners.end());
  }
  this->MovedTree =
    buildCollisionTree(mesh, { SplitRule::Median, BoundingVolumeType::AABB, 4 }, {}, 1);
}
}
