// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TreeSerialization.h
 * @brief A collision tree as flat arrays of numbers, for field data and files, and back with full
 * validation.
 *
 * Source: none.
 * Valid: the restored tree has the same bits. A tree that restoreTree() accepts cannot give a
 * wrong hit; restoreTransferred() trusts trees of boxes from another process of this program.
 * Test: TestTreeSerialization.cxx, InstructionSets.cxx.
 */
#ifndef avianlidar_TreeSerialization_h
#define avianlidar_TreeSerialization_h

#include "CollisionTree.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
struct FlatTree
{
  /// Two per node, breadth first: TreeNode::first and TreeNode::count.
  std::vector<std::uint32_t> nodes;
  /// Per node, scene coordinates, m. AABB: lower, upper (6). OBB: center, three axes, half extents
  /// (15). Sphere: center, radius (4).
  std::vector<double> volumes;
  std::vector<std::uint32_t> order;
  TreeOptions options;
  std::uint64_t checksum = 0; ///< of the mesh
};

/// Numbers per node in FlatTree::volumes.
std::size_t numbersPerVolume(BoundingVolumeType type);

FlatTree flattenTree(const CollisionTree& tree);

/// The tree that flattenTree() was given, bit for bit. Checks the checksum, the options, all sizes,
/// that the nodes are numbered as Algorithm 1 does (which rules out cycles and orphans), that
/// leaves hold each triangle once, that volumes are finite and well formed, and that every volume
/// holds all triangles below it. Takes O(n): no node may lie deeper than MaximumTreeDepth
/// (TreeDraft.h). Throws std::invalid_argument with a sentence that names what is wrong and where.
/// @param threads > 0, or 0 for loopThreads(0)
std::shared_ptr<const CollisionTree> restoreTree(
  std::shared_ptr<const TriangleMesh> mesh, const FlatTree& flat, int threads = 0);

/// The same for another process of this program that has the mesh: boxes are left out (`volumes` is
/// empty), as they follow from the triangles. 8 bytes a node and 4 a triangle.
FlatTree flattenForTransfer(const CollisionTree& tree);

/// The tree that flattenForTransfer() was given, bit for bit. Trees of boxes are taken as they come
/// in O(n), only their sizes are checked; others as by restoreTree(). @param threads > 0, or 0 for
/// loopThreads(0)
std::shared_ptr<const CollisionTree> restoreTransferred(
  std::shared_ptr<const TriangleMesh> mesh, FlatTree flat, int threads);
}

#endif
