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
 * Differs: a leaf holds up to maximumLeafSize triangles (Algorithm 1: one). Volumes are boxes and
 * stand in the wide tree; other volumes are beside the kernel (OtherVolumes, VolumeTree.h).
 * Valid: at most 2^31 - 1 triangles.
 * Test: TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_CollisionTree_h
#define avianlidar_CollisionTree_h

#include "BeamFrame.h"
#include "ParallelLoop.h"
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

/// node_i = {B_i, F_i, p_i1, p_i2} of Eq. 14 without its volume.
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
  std::vector<TreeNode> nodes;             ///< empty for an empty mesh
  std::vector<std::uint32_t> order;        ///< triangle numbers, leaf by leaf
  std::vector<LeafTriangle> leafTriangles; ///< one for each entry of `order`
  std::uint64_t checksum = 0;              ///< of the mesh
  WideTree wide; ///< boxes eight at a time in single precision; empty with other volumes
  std::shared_ptr<const OtherVolumes> other; ///< null: boxes
  /// For each triangle that coincides with others the one whose plane they take
  /// (CoincidentFaces.h), for the rest NoTriangle; empty if no faces coincide.
  std::vector<std::uint32_t> planeOwners;
  double planeDepth = 0.0; ///< m, most that rounding moves two of them apart

  bool coincides(std::uint32_t triangle) const
  {
    return !this->planeOwners.empty() && this->planeOwners[triangle] != NoTriangle;
  }

  /// Number of the triangle whose plane a triangle takes, or its own.
  std::uint32_t planeOwner(std::uint32_t triangle) const
  {
    return this->coincides(triangle) ? this->planeOwners[triangle] : triangle;
  }

  /// Depth of each node, root 0.
  std::vector<std::uint32_t> depths() const;
};

/// Plane of a triangle, or that which it takes of another. @param corners from the apex
TrianglePlane planeOf(
  const CollisionTree& tree, std::uint32_t triangle, const Corners& corners, const Vec3& apex);

/// Fill `leafTriangles` from order and mesh.
void collectLeafTriangles(CollisionTree& tree, ParallelTeam& team);
}

#endif
