// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTreeBuilder.h
 * @brief Builds the collision tree of boxes, eight children a node, with several threads.
 *
 * 1. Boxes of all triangles in single precision (TriangleBoxes.h).
 * 2. Large ranges of boxes are divided layer by layer, one thread for each range. Boxes are copied
 *    back and forth between two arrays: those of a range are in the array of its depth's parity.
 * 3. Each range that is left is divided down to the leaves, on one thread.
 * 4. Up to eight ranges become the children of a node, so that the sum of the areas of all nodes is
 *    least.
 * 5. Faces that coincide are found (CoincidentFaces.h).
 *
 * Source: paper, Algorithm 1; T. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal
 * on GPUs Through Compressed Wide BVHs", HPG 2017, Sec. 3.1.
 * Differs: Algorithm 1 makes two children a node (VolumeTree.h). Here leaves hold several
 * triangles, the surface area heuristic is added (SplitRule.h), and several threads work.
 * Valid: the tree has the same bits for any number of threads, as the limit between large and
 * small ranges depends on the number of triangles alone. Cost O(n log n); peak about 150 bytes a
 * triangle.
 * Test: TestCollisionTreeBuilder.cxx, TestWideTree.cxx.
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

/// Throws std::invalid_argument if there is no mesh, or an option is out of range.
void checkTreeInput(const TriangleMesh* mesh, const TreeOptions& options);
}

#endif
