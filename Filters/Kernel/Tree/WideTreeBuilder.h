// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file WideTreeBuilder.h
 * @brief Builds the wide tree: collapses a binary tree to one with eight children a node.
 *
 * Source: T. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through
 * Compressed Wide BVHs", HPG 2017, Sec. 3.1.
 * Differs: leaves are those of the binary tree; nodes are not compressed.
 * Valid: as TriangleBoxes.h. The same bits for any number of threads.
 * Test: TestWideTree.cxx, TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_WideTreeBuilder_h
#define avianlidar_WideTreeBuilder_h

#include "CollisionTree.h"
#include "TriangleBoxes.h"

namespace avianlidar
{
/// Cost of a subtree in the wide tree. A descent visits a wide node as often as its box is met,
/// that is, in proportion to its area, and tests its eight children at once.
struct alignas(32) WideTreeCost
{
  /// [k - 1]: the least sum of the areas of wide nodes if the subtree's nodes take up to k lanes of
  /// the wide node above. With 1 the subtree's root is a wide node itself.
  float least[WideNode::Width];
};

/// A binary tree whose root is node 0 and whose siblings are adjacent.
struct WideTreeInput
{
  const TreeNode* nodes;
  const LaneBox* boxes; ///< relative to the reference of the scene
  WideTreeCost* costs;  ///< of inner nodes, each at half the number of its first child

  /// Fill the costs of the nodes [begin, end), children coming after their parents.
  void setCosts(std::uint32_t begin, std::uint32_t end) const;
};

/// Collapse a binary tree so that the sum of the areas of the wide nodes is least.
///
/// Nodes of the upper levels come first, then the subtrees below them one after the other, which
/// several threads collapse: the result is the same for any number of them.
/// @return empty if there are no triangles, or `keepGoing` returned false
WideTree buildWideTree(const WideTreeInput& input, const TriangleBoxes& scene, ParallelTeam& team,
  const KeepGoing& keepGoing = {});
}

#endif
