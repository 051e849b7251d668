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

void finishTree(CollisionTree& tree)
{
  if (const auto* boxes = std::get_if<std::vector<AABB>>(&tree.volumes))
  {
    tree.wide = foldTree(tree.nodes, *boxes);
  }
}
}
