// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SplitRule.h
 * @brief How the triangles of a node are divided between its two children: four rules.
 *
 * The rules use only the triangles' boxes and their centres. All are deterministic and keep the
 * order of the boxes, except for the median. The surface area heuristic makes one pass over a
 * node's boxes that merges each with one bin on each axis, one over the bins, and one that
 * separates the boxes.
 *
 * Source: paper, Sec. 3.1, Algorithm 1, line 9; for the surface area heuristic I. Wald, "On fast
 * Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on Interactive Ray
 * Tracing, 2007.
 * Differs: the surface area heuristic is not in the paper. Few triangles take few bins, 4 to 16.
 * Valid: boxes are in single precision relative to the middle of the scene. Triangles smaller than
 * the roundings there may be divided differently than exact centres would be; this costs a little
 * time and changes no hit.
 * Test: TestSplitRule.cxx, TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_SplitRule_h
#define avianlidar_SplitRule_h

#include "CollisionTree.h"
#include "TriangleBoxes.h"

#include <cstdint>

namespace avianlidar
{
/// Copy `from[0 .. count)` (count >= 2) to `to` so that its first part goes to the first child.
/// @param from may be reordered
/// @param centers box of twice their centres
/// @param depth of the node, root 0: chooses the axis of SplitRule::Median. From 96 on every rule
/// halves the list: one that peels off a triangle at a time would make a list instead of a tree
/// @return size of the first part, in [1, count - 1]. Where a rule finds nothing to divide by
/// (equal centres), the list is halved as it stands.
std::size_t splitTriangles(SplitRule rule, LaneBox* from, LaneBox* to, std::size_t count,
  const LaneBox& centers, std::uint32_t depth);
}

#endif
