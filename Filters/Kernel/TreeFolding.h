// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TreeFolding.h
 * @brief Folds a binary tree to one of eight children a node (see WideTree.h).
 */
#ifndef avianlidar_TreeFolding_h
#define avianlidar_TreeFolding_h

#include "CollisionTree.h"
#include "TriangleBoxes.h"

namespace avianlidar
{
/// Fold a binary tree whose root is node 0 and whose siblings are adjacent.
///
/// Up to eight descendants of a node, the largest opened first, become the children of one wide
/// node. Nodes of the upper levels come first, then, one after the other, what hangs below them,
/// which is folded by several threads: the result is the same for any number of them.
/// @param boxes one per node, relative to the reference of `scene`
/// @return empty if coordinates are too large for single precision (extent beyond 1e15 m), there
/// are no triangles, or somebody said stop
WideTree foldTree(const TreeNode* nodes, const LaneBox* boxes, const TriangleBoxes& scene,
  int threads, const KeepGoing& keepGoing = {});

/// The same for a tree that is there, of which only nodes and order are used.
WideTree foldTree(const CollisionTree& tree, int threads);
}

#endif
