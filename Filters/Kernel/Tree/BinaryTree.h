// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BinaryTree.h
 * @brief The binary tree of Algorithm 1, for CollisionTreeBuilder.h and VolumeTree.h.
 *
 * Each layer of nodes is divided in one parallel loop. The triangles' boxes (TriangleBoxes.h)
 * alternate between two arrays, because a rule cannot divide boxes in place.
 *
 * Source: paper, Algorithm 1.
 * Differs: a leaf holds up to maximumLeafSize triangles (Algorithm 1: one triangle). The surface
 * area heuristic is added (SplitRule.h). The work is shared among threads.
 * Valid: as for TriangleBoxes.h. Any number of threads builds an identical tree. Time grows as n
 * log n with the number n of triangles.
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
/// Eq. 14, node_i = {B_i, F_i, p_i1, p_i2}, without the volume B_i.
struct BinaryNode
{
  std::uint32_t begin;    ///< first of the node's triangles in BinaryTree::order
  std::uint32_t count;    ///< number of the node's triangles
  std::uint32_t depth;    ///< depth of the node; 0 for the root
  std::uint32_t children; ///< number of the first child; the second child is next; 0: a leaf
};

/// Nodes are numbered breadth first, as in Algorithm 1 but from 0. The children of a node are
/// adjacent and follow all nodes of their parent's layer.
struct BinaryTree
{
  std::vector<BinaryNode> nodes;    ///< nodes, root first; empty for an empty mesh
  std::vector<LaneBox> boxes;       ///< box of each node
  std::vector<std::uint32_t> order; ///< triangle numbers, leaf by leaf; ascending in a leaf
  Vec3 reference{ 0.0 };            ///< origin of the boxes (TriangleBoxes.h), m
  double extent = 0.0;              ///< largest coordinate relative to the reference, m

  /// Divide all triangles down to the leaves, or down to the depth `deepest`. Throws
  /// std::invalid_argument as makeTriangleBoxes() does.
  /// @return false if `keepGoing` returned false
  bool divide(const TriangleMesh& mesh, const TreeOptions& options, int threads,
    const KeepGoing& keepGoing, std::uint32_t deepest = std::numeric_limits<std::uint32_t>::max());
};
}

#endif
