// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Traversal.h
 * @brief descendWide(), the descent of the wide tree, front to back, for a ray, a cone, a packet of
 * rays or a group of beams.
 *
 * Template arguments define the descent: a policy, or a query and a visitor.
 *
 * Source: none.
 * Valid: the descent visits every leaf whose volumes the policy meets within the limit. A volume
 * whose lower bound equals the limit is visited, as it may hold a hit of equal range and lower
 * triangle number.
 * Test: TestBeamTracer.cxx, TestBeamGroup.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_Traversal_h
#define avianlidar_Traversal_h

#include "CollisionTree.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace avianlidar
{
/// Start of a descent of the wide tree.
struct DescentStart
{
  const EntryPoints* entryPoints = nullptr; ///< null: the root of the tree
  std::uint64_t members = 0;                ///< rays or beams of every entry, one bit each
  float scale = 1.0f; ///< factor from the entry points' distances to the policy's distances
};

/// Base of most policies of descendWide(). A policy also has:
///   `limit() const`: range, m; volumes whose lower bound is greater are left out;
///   `open(node, members, push)`: calls `push(lane, members, nearest)` for each child that is met;
///   `bool end(entry)`: visits a leaf; false ends the descent.
struct WidePolicy
{
  /// True if the descent goes no deeper than this entry.
  static bool isEnd(const DescentEntry& entry) { return entry.count > 0; }
  /// Called before each inner node is opened, and at the end of the descent.
  void afterEnds() {}
};

/// Descent of the wide tree, the nearest child first.
/// @return number of boxes tested
template <class Policy>
std::uint64_t descendWide(
  const WideTree& tree, const DescentStart& start, Policy& policy, TraversalStack& stack)
{
  constexpr std::size_t Width = WideNode::Width;
  // Flag in DescentEntry::node: the node belongs to the entry points, not to the tree.
  constexpr std::uint32_t FromEntryPoints = 0x80000000u;
  const std::size_t beginnings = start.entryPoints ? start.entryPoints->nodes.size() : 1;
  // Every level leaves at most seven entries on the stack.
  stack.resize(std::max(stack.size(), Width * (tree.depth + 2) + beginnings));
  DescentEntry* const bottom = stack.data();
  DescentEntry* top = bottom;
  for (auto k = static_cast<std::uint32_t>(beginnings); k > 0; --k)
  {
    *top++ = start.entryPoints ? DescentEntry{ FromEntryPoints | (k - 1), 0, start.members,
      start.entryPoints->nearest[k - 1] * start.scale, 0, 0 }
                               : DescentEntry{ 0, 0, start.members, 0.0, 0, 0 };
  }
  std::uint64_t visited = 0;
  while (top != bottom)
  {
    // The entry was mostly written just before, so a copy would have to wait for the write.
    const DescentEntry& entry = *--top;
    if (policy.isEnd(entry))
    {
      if (!(entry.nearest > policy.limit()) && !policy.end(entry))
      {
        return visited;
      }
      continue;
    }
    policy.afterEnds();
    if (entry.nearest > policy.limit())
    {
      continue;
    }
    const std::uint32_t parent = entry.node;
    const WideNode& node = (parent & FromEntryPoints) != 0
      ? start.entryPoints->nodes[parent & ~FromEntryPoints]
      : tree.nodes[parent];
    visited += Width;
    DescentEntry* const first = top;
    const auto push = [&](std::uint32_t lane, std::uint64_t members, float nearest)
    {
      // Entries are kept sorted, the nearest entry on top.
      DescentEntry* place = top++;
      while (place != first && place[-1].nearest < nearest)
      {
        *place = place[-1];
        --place;
      }
      *place = { node.first[lane], node.count[lane], members, nearest, parent, lane };
    };
    policy.open(node, entry.members, push);
  }
  policy.afterEnds();
  return visited;
}

/// Policy of one cone or ray (WideCone or WideRay). The visitor must have the members of
/// TreeLeaves.
template <class Query, class Visitor>
class QueryPolicy : public WidePolicy
{
public:
  QueryPolicy(const CollisionTree& tree, const Query& query, Visitor& visitor)
    : Order(tree.order.data())
    , Boxes(query)
    , Leaves(visitor)
  {
  }

  double limit() const { return this->Leaves.limit(); }

  template <class Push>
  void open(const WideNode& node, std::uint64_t, Push push)
  {
    alignas(64) float nearest[WideNode::Width];
    this->Boxes.distances(node, nearest);
    for (std::uint32_t i = 0; i < WideNode::Width; ++i)
    {
      if (nearest[i] < std::numeric_limits<float>::infinity() && node.first[i] != NoChild)
      {
        push(i, 0, nearest[i]);
      }
    }
  }

  bool end(const DescentEntry& entry)
  {
    return this->Leaves.leaf(this->Order + entry.node, entry.count);
  }

private:
  const std::uint32_t* Order;
  const Query& Boxes;
  Visitor& Leaves;
};

/// Descent of one cone or ray. @param entryPoints null: the descent begins at the root of the tree
template <class Query, class Visitor>
std::uint64_t descendWide(const CollisionTree& tree, const Query& query, Visitor& visitor,
  TraversalStack& stack, const EntryPoints* entryPoints = nullptr)
{
  QueryPolicy<Query, Visitor> policy(tree, query, visitor);
  return descendWide(tree.wide, DescentStart{ entryPoints }, policy, stack);
}
}

#endif
