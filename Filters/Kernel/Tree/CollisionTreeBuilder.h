// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTreeBuilder.h
 * @brief Builds the collision detection tree with several threads.
 *
 * 1. Boxes of all triangles in single precision (TriangleBoxes.h).
 * 2. Large nodes are divided layer by layer, many threads at each node; smaller ones by one
 *    thread, depth first, in its cache (TreeDraft.h). Boxes are copied back and forth between two
 *    arrays: a node's boxes are in the array of its depth's parity.
 * 3. Nodes are numbered breadth first; the wide tree is built.
 *
 * Source: paper, Algorithm 1.
 * Differs: leaves of several triangles, the surface area heuristic (SplitRule.h), several threads,
 * and halving below depth 96, so that no tree becomes a list.
 * Valid: the tree has the same bits for any number of threads, as the limit between large and
 * small nodes depends on the number of triangles alone. Cost O(n log n); peak about 150 bytes a
 * triangle.
 * Test: TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_CollisionTreeBuilder_h
#define avianlidar_CollisionTreeBuilder_h

#include "CollisionTree.h"
#include "ParallelLoop.h"

namespace avianlidar
{
/// Build a tree over all triangles of `mesh` (degenerate ones included: they are never hit but keep
/// their number).
/// @param keepGoing called repeatedly with the fraction done on the calling thread; returning false
/// stops the work
/// @param threads > 0, or 0 for loopThreads(0)
/// @return null if `keepGoing` returned false. Throws std::invalid_argument naming the option if it
/// is out of range, or the triangle whose corner is missing or not finite. Deterministic.
std::shared_ptr<const CollisionTree> buildCollisionTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing = {}, int threads = 0);

/// The same without a wide tree, which nothing descends before it has other volumes.
std::shared_ptr<CollisionTree> buildBinaryTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing = {}, int threads = 0);
}

#endif
