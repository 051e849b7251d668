// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LeafCorners.h
 * @brief Corners of a leaf's triangles, for descents.
 */
#ifndef avianlidar_LeafCorners_h
#define avianlidar_LeafCorners_h

#include "CollisionTree.h"
#include "TriangleTest.h"

namespace avianlidar
{
/// The corners of the triangle that stands at `position` of the tree's order, relative to `apex`:
/// cornersFrom() of `order[position]`, bit for bit. In a fine mesh it takes half the time, as only
/// the points are scattered in memory.
inline Corners leafCorners(const CollisionTree& tree, std::size_t position, const Vec3& apex)
{
  const Vec3* const points = tree.mesh->points.data();
  const std::uint32_t* const corners = tree.leafTriangles[position].corners;
  return { points[corners[0]] - apex, points[corners[1]] - apex, points[corners[2]] - apex };
}
}

#endif
