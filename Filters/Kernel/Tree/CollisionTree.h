// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTree.h
 * @brief The collision detection tree: structure only.
 *
 * Nodes are those of the wide tree, eight boxes each. The paper's binary trees, of boxes and of
 * other volumes, are beside the kernel (OtherVolumes, VolumeTree.h). The builder is in
 * CollisionTreeBuilder.h, the descent in Traversal.h.
 *
 * Source: paper, Sec. 3.1.
 * Differs: eight children a node; a leaf holds up to maximumLeafSize triangles (Algorithm 1: one).
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
  Sphere = 2
};

struct TreeOptions
{
  SplitRule splitRule = SplitRule::SurfaceAreaHeuristic;
  BoundingVolumeType boundingVolume = BoundingVolumeType::AABB; ///< others: see VolumeTree.h
  int maximumLeafSize = 4; ///< triangles, >= 1; 1 is Algorithm 1
};

/// A volume or node still to be visited.
struct DescentEntry
{
  std::uint32_t node;    ///< or, in the wide tree, first entry of a leaf
  std::uint32_t count;   ///< triangles of that leaf; else 0
  std::uint64_t members; ///< of the wide tree: a bit for each ray or beam that meets the volume
  double nearest;        ///< lower bound of ranges in it
  std::uint32_t parent;  ///< of the wide tree: the node whose child this is
  std::uint32_t lane;    ///< of that node
};

/// Kept between descents, so that no descent allocates.
using TraversalStack = std::vector<DescentEntry>;

/// Receives the leaves that a descent meets.
class TreeLeaves
{
public:
  virtual ~TreeLeaves() = default;
  /// Volumes whose lower bound is greater are left out.
  virtual double limit() const = 0;
  /// @return false to end the descent
  virtual bool leaf(const std::uint32_t* triangles, std::uint32_t count) = 0;
};

struct CollisionTree;

/// Volumes of a binary tree instead of the wide tree's boxes. Descents return the number of nodes
/// visited and are conservative, as those of the wide tree.
class OtherVolumes
{
public:
  virtual ~OtherVolumes() = default;
  virtual std::uint64_t descendCone(const CollisionTree& tree, const BeamFrame& frame,
    TreeLeaves& leaves, TraversalStack& stack) const = 0;
  /// As descendRay() of Descents.h.
  virtual std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
    const Vec3& direction, double angularMargin, TreeLeaves& leaves,
    TraversalStack& stack) const = 0;
};

/// Immutable once built; shared by any number of threads and scans.
struct CollisionTree
{
  std::shared_ptr<const TriangleMesh> mesh;
  TreeOptions options;
  std::vector<std::uint32_t> order; ///< triangle numbers, leaf by leaf; empty for an empty mesh
  std::uint64_t checksum = 0;       ///< checksum of the mesh
  std::uint32_t leaves = 0;         ///< number of leaves
  /// Depth of the deepest leaf in a binary tree that the rule divides; the root has depth 0.
  std::uint32_t depth = 0;
  WideTree wide; ///< boxes eight at a time in single precision; empty with other volumes
  std::shared_ptr<const OtherVolumes> other; ///< null: boxes
  /// For each triangle that coincides with others the one whose plane they take
  /// (CoincidentFaces.h), for the rest NoTriangle; empty if no faces coincide.
  std::vector<std::uint32_t> planeOwners;
  double planeDepth = 0.0; ///< m, most that rounding moves two of them apart

  bool empty() const { return this->order.empty(); }

  bool coincides(std::uint32_t triangle) const
  {
    return !this->planeOwners.empty() && this->planeOwners[triangle] != NoTriangle;
  }

  /// Number of the triangle whose plane a triangle takes, or its own.
  std::uint32_t planeOwner(std::uint32_t triangle) const
  {
    return this->coincides(triangle) ? this->planeOwners[triangle] : triangle;
  }
};

/// Plane of a triangle, or that which it takes of another. @param corners from the apex
TrianglePlane planeOf(
  const CollisionTree& tree, std::uint32_t triangle, const Corners& corners, const Vec3& apex);
}

#endif
