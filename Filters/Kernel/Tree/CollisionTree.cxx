// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTree.h"

namespace avianlidar
{
std::vector<std::uint32_t> CollisionTree::depths() const
{
  std::vector<std::uint32_t> depth(this->nodes.size(), 0);
  // Parents come before their children.
  for (std::size_t i = 0; i < this->nodes.size(); ++i)
  {
    if (!this->nodes[i].isLeaf())
    {
      depth[this->nodes[i].first] = depth[i] + 1;
      depth[this->nodes[i].first + 1] = depth[i] + 1;
    }
  }
  return depth;
}

TrianglePlane planeOf(
  const CollisionTree& tree, std::uint32_t triangle, const Corners& corners, const Vec3& apex)
{
  const std::uint32_t owner = tree.planeOwner(triangle);
  return owner == triangle ? planeOf(corners)
                           : planeOf(corners, planeOf(cornersFrom(*tree.mesh, owner, apex)));
}

void collectLeafTriangles(CollisionTree& tree, ParallelTeam& team)
{
  constexpr std::size_t Block = 4096;
  tree.leafTriangles.resize(tree.order.size());
  const auto body = [&tree](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      const std::uint32_t number = tree.order[i];
      const auto& corners = tree.mesh->triangles[number];
      tree.leafTriangles[i] = { { corners[0], corners[1], corners[2] }, number };
    }
  };
  team.loop(tree.order.size(), Block, body);
}
}
