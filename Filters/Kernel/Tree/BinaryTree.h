// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BinaryTree.h
 * @brief The binary tree of Algorithm 1, from which wide nodes (CollisionTreeBuilder.h) or other
 * volumes (VolumeTree.h) are made.
 *
 * Boxes of all triangles (TriangleBoxes.h) are divided layer by layer. They are copied back and
 * forth between two arrays, as a rule cannot divide them in place.
 *
 * Source: paper, Algorithm 1.
 * Differs: a leaf holds up to maximumLeafSize triangles (Algorithm 1: one), the surface area
 * heuristic is added (SplitRule.h), and several threads work.
 * Valid: as TriangleBoxes.h. The same tree for any number of threads. Cost O(n log n).
 * Test: TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_BinaryTree_h
#define avianlidar_BinaryTree_h

#include "CollisionTree.h"
#include "ParallelLoop.h"
#include "TriangleBoxes.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace avianlidar
{
/// node_i = {B_i, F_i, p_i1, p_i2} of Eq. 14 without its volume.
struct BinaryNode
{
  std::uint32_t begin; ///< triangles below it: [begin, begin + count) of the order
  std::uint32_t count;
  std::uint32_t depth;    ///< root 0
  std::uint32_t children; ///< number of the first, the second follows; 0: a leaf, or not divided
};

/// Nodes are numbered breadth first, as in Algorithm 1 (0-based): the children of a node are
/// adjacent and follow all nodes of their parent's layer.
struct BinaryTree
{
  std::vector<BinaryNode> nodes;    ///< empty for an empty mesh
  std::vector<LaneBox> boxes;       ///< of all nodes
  std::vector<std::uint32_t> order; ///< triangle numbers, leaf by leaf, rising in a leaf
  Vec3 reference{ 0.0 };            ///< of the boxes, see TriangleBoxes
  double extent = 0.0;

  /// Divide all triangles down to the leaves, or to a depth. Throws std::invalid_argument as
  /// makeTriangleBoxes().
  /// @return false if `keepGoing` returned false
  bool divide(const TriangleMesh& mesh, const TreeOptions& options, int threads,
    const KeepGoing& keepGoing, std::uint32_t deepest = std::numeric_limits<std::uint32_t>::max());
};
}

#endif
