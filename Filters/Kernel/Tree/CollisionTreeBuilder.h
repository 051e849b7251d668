// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTreeBuilder.h
 * @brief Builds the collision detection tree (paper, Algorithm 1) with several threads.
 *
 * 1. Boxes of all triangles in single precision (TriangleBoxes.h).
 * 2. Large nodes, layer by layer, many threads at each node (UpperLayers.h); what is smaller is
 *    divided by one thread, depth first, in its cache. The boxes are copied to and fro between two
 *    arrays, a node's boxes being in the array of its depth's parity.
 * 3. Nodes are numbered breadth first as in Algorithm 1; volumes are fitted or the tree is folded.
 *
 * What is small depends on the number of triangles alone: the tree is the same, bit for bit, for
 * any number of threads. Cost: O(n log n), about 150 bytes a triangle at the peak.
 */
#ifndef avianlidar_CollisionTreeBuilder_h
#define avianlidar_CollisionTreeBuilder_h

#include "CollisionTree.h"
#include "ParallelLoop.h"

namespace avianlidar
{
/// Build a tree over all triangles of `mesh` (degenerate ones included: they are never hit but keep
/// their number).
/// @param keepGoing called now and then with the fraction done on the calling thread; returning
/// false stops the work
/// @param threads > 0, or 0 for loopThreads(0)
/// @return null if `keepGoing` said stop. Throws std::invalid_argument naming the option if it is
/// out of range, or the triangle whose corner is missing or not finite. Deterministic.
std::shared_ptr<const CollisionTree> buildCollisionTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing = {}, int threads = 0);
}

#endif
