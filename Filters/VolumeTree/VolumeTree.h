// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VolumeTree.h
 * @brief The paper's binary tree of AABBs, OBBs or spheres in double precision, and its descent:
 * what the paper compares. The kernel's own tree has eight boxes a node.
 *
 * Source: paper, Sec. 3.1 and 3.2.
 * Differs: see CollisionTree.h; the descent is front to back.
 * Valid: visits every leaf whose volumes the cone or ray meets within the limit. A volume whose
 * lower bound equals the limit is visited, as it may hold a hit of equal range and lower number.
 * Test: TestCollisionTreeBuilder.cxx, TestBeamTracer.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_VolumeTree_h
#define avianlidar_VolumeTree_h

#include "BoundingVolume.h"
#include "CollisionTree.h"

#include <memory>
#include <variant>
#include <vector>

namespace avianlidar
{
using TreeVolumes = std::variant<std::vector<AABB>, std::vector<OBB>, std::vector<BoundingSphere>>;

/// As buildCollisionTree(), for every TreeOptions::boundingVolume; that of AABBs is the kernel's.
std::shared_ptr<const CollisionTree> buildVolumeTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing = {}, int threads = 0);

/// The same tree with two AABBs a node, in double precision, instead of eight in single.
std::shared_ptr<const CollisionTree> withPlainBoxes(const CollisionTree& tree);

/// The volumes of all nodes, in scene coordinates, conservative for all triangles below; the boxes
/// of a wide tree are computed from the triangles.
std::shared_ptr<const TreeVolumes> volumesOf(const CollisionTree& tree);
}

#endif
