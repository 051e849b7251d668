// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Traversal.h
 * @brief Descent of a collision tree, front to back: the same for beams and single rays, and for
 * every kind of volume.
 */
#ifndef avianlidar_Traversal_h
#define avianlidar_Traversal_h

#include "CollisionTree.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace avianlidar
{
struct TraversalEntry
{
  std::uint32_t node;
  double nearest;
};

/// Kept between descents, so that no descent allocates.
using TraversalStack = std::vector<TraversalEntry>;

/// Visit the leaves whose volume `probe` meets, the nearer child first.
/// @param probe `bool meets(const Volume&, double& nearest) const`
/// @param visitor `double limit() const`: nodes whose lower bound is greater are left out;
///   `bool leaf(const std::uint32_t* triangles, std::uint32_t count)`: false ends the descent
/// @return number of nodes whose volume was tested
template <class Volume, class Probe, class Visitor>
std::uint64_t descend(const CollisionTree& tree, const std::vector<Volume>& volumes,
  const Probe& probe, Visitor& visitor, TraversalStack& stack)
{
  std::uint64_t visited = 1;
  double nearest = 0.0;
  stack.clear();
  if (tree.nodes.empty() || !probe.meets(volumes[0], nearest))
  {
    return visited;
  }
  stack.push_back({ 0, nearest });
  while (!stack.empty())
  {
    TraversalEntry entry = stack.back();
    stack.pop_back();
    // An equal bound may still hold a hit of equal range and lower number.
    if (entry.nearest > visitor.limit())
    {
      continue;
    }
    const TreeNode& node = tree.nodes[entry.node];
    if (node.isLeaf())
    {
      if (!visitor.leaf(tree.order.data() + node.first, node.count))
      {
        break;
      }
      continue;
    }
    TraversalEntry first{ node.first, 0.0 };
    TraversalEntry second{ node.first + 1, 0.0 };
    const bool meetsFirst = probe.meets(volumes[first.node], first.nearest);
    const bool meetsSecond = probe.meets(volumes[second.node], second.nearest);
    visited += 2;
    if (meetsFirst && meetsSecond)
    {
      if (second.nearest < first.nearest)
      {
        std::swap(first, second);
      }
      stack.push_back(second);
      stack.push_back(first);
    }
    else if (meetsFirst || meetsSecond)
    {
      stack.push_back(meetsFirst ? first : second);
    }
  }
  return visited;
}
}

#endif
