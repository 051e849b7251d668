// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file WideTreeBuilder.h
 * @brief Folds a binary tree to one of eight children a node (see WideTree.h).
 */
#ifndef avianlidar_WideTreeBuilder_h
#define avianlidar_WideTreeBuilder_h

#include "CollisionTree.h"
#include "TriangleBoxes.h"

namespace avianlidar
{
/// What it costs to fold a subtree: a descent visits a wide node as often as its box is met, that
/// is, in proportion to its area, and tests its eight children at once. T. Ylitie, T. Karras, S.
/// Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
/// Sec. 3.1, with the leaves given.
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

/// Fold a binary tree so that the sum of the areas of the wide nodes is least.
///
/// Nodes of the upper levels come first, then, one after the other, what hangs below them, which is
/// folded by several threads: the result is the same for any number of them.
/// @return empty if coordinates are too large for single precision (extent beyond 1e15 m), there
/// are no triangles, or somebody said stop
WideTree buildWideTree(const WideTreeInput& input, const TriangleBoxes& scene, ParallelTeam& team,
  const KeepGoing& keepGoing = {});

/// The same for a tree that is there, of which only nodes and order are used.
WideTree buildWideTree(const CollisionTree& tree, ParallelTeam& team);
}

#endif
