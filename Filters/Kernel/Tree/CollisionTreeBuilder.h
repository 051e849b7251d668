// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTreeBuilder.h
 * @brief Builds the collision tree of boxes, with eight children per node, by several threads.
 *
 * Up to eight nodes of a binary tree (BinaryTree.h) become the children of a wide node, so that the
 * sum of the areas of all wide nodes is least. Coincident faces are found last (CoincidentFaces.h).
 *
 * Source: T. Ylitie, T. Karras, S. Laine, "Efficient Incoherent Ray Traversal on GPUs Through
 * Compressed Wide BVHs", HPG 2017, Sec. 3.1.
 * Valid: the tree has the same bits for any number of threads. Peak memory is about 150 bytes per
 * triangle.
 * Test: TestCollisionTreeBuilder.cxx, TestWideTree.cxx.
 */
#ifndef avianlidar_CollisionTreeBuilder_h
#define avianlidar_CollisionTreeBuilder_h

#include "CollisionTree.h"
#include "ParallelLoop.h"

namespace avianlidar
{
/// Build a tree over all triangles of `mesh`. Degenerate triangles keep their number and are never
/// hit. Throws std::invalid_argument that names the option out of range, or the triangle with a
/// corner that is missing or not finite.
/// @param keepGoing called on the calling thread with the fraction done; the work stops if the
/// result is false
/// @param threads number of threads, > 0; 0: loopThreads(0)
/// @return null if `keepGoing` returned false
std::shared_ptr<const CollisionTree> buildCollisionTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing = {}, int threads = 0);

/// Throws std::invalid_argument if there is no mesh, or an option is out of range.
void checkTreeInput(const TriangleMesh* mesh, const TreeOptions& options);
}

#endif
