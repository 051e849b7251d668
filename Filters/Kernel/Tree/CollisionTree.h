// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTree.h
 * @brief The collision detection tree: structure only.
 *
 * Nodes are numbered breadth first (0-based): the children of a node are adjacent and follow all
 * nodes of their parent's layer. Builders are in CollisionTreeBuilder.h, the descent is in
 * Traversal.h.
 *
 * Source: paper, Sec. 3.1, Eq. 14 and the numbering of Algorithm 1.
 * Differs: a leaf holds up to maximumLeafSize triangles (Algorithm 1: one). Volumes stand in an
 * array of their own; boxes are kept in the wide tree alone.
 * Valid: at most 2^31 - 1 triangles.
 * Test: TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_CollisionTree_h
#define avianlidar_CollisionTree_h

#include "BoundingVolume.h"
#include "ParallelLoop.h"
#include "TriangleMesh.h"
#include "TriangleTest.h"
#include "WideTree.h"

#include <cstdint>
#include <memory>
#include <mutex>
#include <variant>
#include <vector>

namespace avianlidar
{
enum class SplitRule
{
  Halves = 0,              ///< "BVH" of the paper: first and second half of the list
  Median = 1,              ///< "k-D": median along axes that alternate with depth
  PrincipalPlane = 2,      ///< "BSP": plane through the mean, normal to the principal axis
  SurfaceAreaHeuristic = 3 ///< binned surface area heuristic (Wald 2007)
};

enum class BoundingVolumeType
{
  AABB = 0,
  OBB = 1,
  Sphere = 2
};

struct TreeOptions
{
  SplitRule splitRule = SplitRule::SurfaceAreaHeuristic;
  BoundingVolumeType boundingVolume = BoundingVolumeType::AABB;
  int maximumLeafSize = 4; ///< triangles, >= 1; 1 is Algorithm 1
};

/// node_i = {B_i, F_i, p_i1, p_i2} of Eq. 14 without its volume, which is in an array of its own.
struct TreeNode
{
  /// Inner node: its first child (the second is first + 1); leaf: first entry of `order`.
  std::uint32_t first;
  std::uint32_t count; ///< 0: inner node; else triangles of the leaf
  bool isLeaf() const { return this->count > 0; }
};

/// A triangle in a leaf, as a descent needs it.
struct alignas(16) LeafTriangle
{
  std::uint32_t corners[3]; ///< numbers of points
  std::uint32_t number;     ///< of the triangle
};

using TreeVolumes = std::variant<std::vector<AABB>, std::vector<OBB>, std::vector<BoundingSphere>>;

/// Immutable once built; shared by any number of threads and scans.
struct CollisionTree
{
  std::shared_ptr<const TriangleMesh> mesh;
  TreeOptions options;
  std::vector<TreeNode> nodes;             ///< empty for an empty mesh
  std::vector<std::uint32_t> order;        ///< triangle numbers, leaf by leaf
  std::vector<LeafTriangle> leafTriangles; ///< one for each entry of `order`
  std::uint64_t checksum = 0;              ///< of the mesh
  WideTree wide; ///< boxes eight at a time in single precision; empty unless they are AABBs
  /// One per node, in scene coordinates, conservative for all its triangles; none where the wide
  /// tree holds the boxes (see withVolumes()).
  TreeVolumes keptVolumes;

  /// Depth of each node, root 0.
  std::vector<std::uint32_t> depths() const;

  /// The volumes, one per node, for code that does not use the wide tree: boxes are made at the
  /// first call and kept. May be called by many threads.
  const TreeVolumes& volumes() const;

private:
  mutable std::once_flag Once;
  mutable TreeVolumes Late;
};

/// Fill `leafTriangles` from order and mesh.
void collectLeafTriangles(CollisionTree& tree, ParallelTeam& team);

/// The boxes of all nodes, computed from the triangles: the smallest, in double precision.
std::vector<AABB> boxesOfNodes(const CollisionTree& tree);

/// Call `f` with the vector of the volumes of all nodes, which the tree need not hold afterwards.
template <class F>
void withVolumes(const CollisionTree& tree, F&& f)
{
  if (tree.wide.nodes.empty())
  {
    std::visit(f, tree.keptVolumes);
  }
  else
  {
    f(boxesOfNodes(tree));
  }
}
}

#endif
