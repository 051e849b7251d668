// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VolumeTree.h
 * @brief The paper's binary tree of AABBs, OBBs or spheres in double precision, and its descent.
 *
 * The binary tree serves to compare the paper's volumes. The kernel's own tree has eight boxes per
 * node.
 *
 * Source: paper, Sec. 3.1 and 3.2, Eq. 14, Algorithm 1.
 * Differs: a leaf holds up to maximumLeafSize triangles (Algorithm 1: one triangle). The descent is
 * front to back.
 * Valid: the descent visits every leaf whose volumes the cone or ray meets within the limit. A
 * volume whose lower bound equals the limit is visited because it may hold a hit of equal range and
 * lower triangle number.
 * Test: TestCollisionTreeBuilder.cxx, TestBeamTracer.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_VolumeTree_h
#define avianlidar_VolumeTree_h

#include "BinaryTree.h"
#include "BoundingVolume.h"
#include "CollisionTree.h"
#include "ParallelLoop.h"

#include <limits>
#include <memory>
#include <variant>
#include <vector>

namespace avianlidar
{
using TreeVolumes =
  std::variant<std::vector<AlignedBox>, std::vector<OBB>, std::vector<BoundingSphere>>;

struct VolumeTree final : public OtherVolumes
{
  std::vector<BinaryNode> nodes; ///< empty for an empty mesh; numbered as in BinaryTree
  /// Volume of each node in scene coordinates. A volume holds all triangles below the node.
  TreeVolumes volumes;

  std::uint64_t descendCone(const CollisionTree& tree, const BeamFrame& frame, TreeLeaves& leaves,
    TraversalStack& stack) const override;
  std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
    const Vec3& direction, double angularMargin, TreeLeaves& leaves,
    TraversalStack& stack) const override;
};

/// Build a tree as buildCollisionTree() does, with any bounding volume. BoundingVolumeType::AABB
/// gives the kernel's tree with eight boxes per node. Every other volume gives a binary tree.
std::shared_ptr<const CollisionTree> buildVolumeTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing = {}, int threads = 0);

/// Nodes and volumes of a tree. For a wide tree, AABBs are fitted to nodes down to the depth
/// `deepest`.
std::shared_ptr<const VolumeTree> volumesOf(
  const CollisionTree& tree, std::uint32_t deepest = std::numeric_limits<std::uint32_t>::max());
}

#endif
