// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Traversal.h
 * @brief Descent of a collision tree, front to back: the same for beams and single rays, and for
 * every kind of volume.
 */
#ifndef avianlidar_Traversal_h
#define avianlidar_Traversal_h

#include "CollisionTree.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace avianlidar
{
struct TraversalEntry
{
  std::uint32_t node;  ///< or, in the folded tree, first entry of a leaf
  std::uint32_t count; ///< triangles of that leaf; else 0
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
  stack.push_back({ 0, 0, nearest });
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
    TraversalEntry first{ node.first, 0, 0.0 };
    TraversalEntry second{ node.first + 1, 0, 0.0 };
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
/// The same over the folded tree. @param query WideCone or WideRay
template <class Query, class Visitor>
std::uint64_t descendWide(
  const CollisionTree& tree, const Query& query, Visitor& visitor, TraversalStack& stack)
{
  constexpr int Width = WideNode::Width;
  // Every level leaves at most seven entries behind.
  stack.resize(std::max<std::size_t>(stack.size(), Width * (tree.wide.depth + 2)));
  TraversalEntry* const bottom = stack.data();
  TraversalEntry* top = bottom;
  *top++ = { 0, 0, 0.0 };
  std::uint64_t visited = 0;
  while (top != bottom)
  {
    const TraversalEntry entry = *--top;
    if (entry.nearest > visitor.limit())
    {
      continue;
    }
    if (entry.count > 0)
    {
      if (!visitor.leaf(tree.order.data() + entry.node, entry.count))
      {
        break;
      }
      continue;
    }
    const WideNode& node = tree.wide.nodes[entry.node];
    alignas(64) float nearest[Width];
    query.distances(node, nearest);
    visited += Width;
    TraversalEntry* const first = top;
    for (int i = 0; i < Width; ++i)
    {
      if (nearest[i] < std::numeric_limits<float>::infinity() && node.first[i] != NoChild)
      {
        // Kept sorted, the nearest on top.
        TraversalEntry* place = top++;
        while (place != first && place[-1].nearest < nearest[i])
        {
          *place = place[-1];
          --place;
        }
        *place = { node.first[i], node.count[i], nearest[i] };
      }
    }
  }
  return visited;
}
}

#endif
