// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTree.h
 * @brief Structure of the collision detection tree.
 *
 * A node has eight boxes (WideTree.h). CollisionTreeBuilder.h builds the tree. Traversal.h descends
 * the tree. The paper's binary trees of boxes and other volumes are outside the kernel
 * (VolumeTree.h). The structure holds such trees as OtherVolumes.
 *
 * Source: paper, Sec. 3.1.
 * Differs: a node has eight children. A leaf holds up to maximumLeafSize triangles (Algorithm 1:
 * one triangle).
 * Valid: at most 2^31 - 1 triangles.
 * Test: TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_CollisionTree_h
#define avianlidar_CollisionTree_h

#include "BeamFrame.h"
#include "TriangleMesh.h"
#include "TriangleTest.h"
#include "WideTree.h"

#include <cstdint>
#include <memory>
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
  Sphere = 2,
  BinaryAABB = 3 ///< AABBs in double precision, two per node, as in the paper
};

struct TreeOptions
{
  SplitRule splitRule = SplitRule::SurfaceAreaHeuristic;
  BoundingVolumeType boundingVolume = BoundingVolumeType::AABB; ///< volume of a node
  int maximumLeafSize = 4; ///< largest number of triangles in a leaf, >= 1; Algorithm 1 has 1
};

/// Entry of the traversal stack: a node or leaf still to be visited.
struct DescentEntry
{
  std::uint32_t node;    ///< number of the node, or first triangle of a leaf of the wide tree
  std::uint32_t count;   ///< number of triangles of a leaf of the wide tree; 0 for other nodes
  std::uint64_t members; ///< bits of the rays or beams that meet the volume (wide tree only)
  double nearest;        ///< lower bound of ranges in the volume, m
  std::uint32_t parent;  ///< number of the parent node (wide tree only)
  std::uint32_t lane;    ///< lane of the parent that holds the entry
};

/// Stack kept between descents, so that a descent does not allocate.
using TraversalStack = std::vector<DescentEntry>;

/// Visitor of the leaves that a descent meets.
class TreeLeaves
{
public:
  virtual ~TreeLeaves() = default;
  /// Largest range, m. Volumes whose lower bound is greater are left out.
  virtual double limit() const = 0;
  /// Visit a leaf. @return false to end the descent
  virtual bool leaf(const std::uint32_t* triangles, std::uint32_t count) = 0;
};

struct CollisionTree;

/// Binary tree of volumes that replaces the boxes of the wide tree. Its descents return the number
/// of visited nodes and are conservative, like the descents of the wide tree.
class OtherVolumes
{
public:
  virtual ~OtherVolumes() = default;
  virtual std::uint64_t descendCone(const CollisionTree& tree, const BeamFrame& frame,
    TreeLeaves& leaves, TraversalStack& stack) const = 0;
  /// Same arguments as descendRay() of Descents.h.
  virtual std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
    const Vec3& direction, double angularMargin, TreeLeaves& leaves,
    TraversalStack& stack) const = 0;
};

/// The tree of a mesh. A finished tree is immutable, so any number of threads and scans may share
/// the tree.
struct CollisionTree
{
  std::shared_ptr<const TriangleMesh> mesh;
  TreeOptions options;
  std::vector<std::uint32_t> order; ///< triangle numbers, leaf by leaf; empty for an empty mesh
  std::uint64_t checksum = 0;       ///< checksum of the mesh
  std::uint32_t leaves = 0;         ///< number of leaves
  /// Depth of the deepest leaf, with 0 for the root, in a binary tree that the rule divides.
  std::uint32_t depth = 0;
  WideTree wide; ///< tree of boxes in single precision; empty with other volumes
  std::shared_ptr<const OtherVolumes> other; ///< null if the tree has boxes
  /// For each triangle, the owner of the plane that the triangle takes (CoincidentFaces.h), or
  /// NoTriangle for a triangle with its own plane; empty if no faces coincide.
  std::vector<std::uint32_t> planeOwners;
  double planeDepth = 0.0; ///< largest distance that rounding puts between coincident triangles, m

  bool empty() const { return this->order.empty(); }

  bool coincides(std::uint32_t triangle) const
  {
    return !this->planeOwners.empty() && this->planeOwners[triangle] != NoTriangle;
  }

  /// Number of the triangle whose plane a triangle takes: the owner or the triangle itself.
  std::uint32_t planeOwner(std::uint32_t triangle) const
  {
    return this->coincides(triangle) ? this->planeOwners[triangle] : triangle;
  }
};

/// Plane that a triangle takes: its own plane or its owner's plane. @param corners relative to the
/// apex
TrianglePlane planeOf(
  const CollisionTree& tree, std::uint32_t triangle, const Corners& corners, const Vec3& apex);
}

#endif
