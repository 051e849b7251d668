// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SplitRule.h
 * @brief Four rules that divide the triangles of a node between its two children.
 *
 * The rules are deterministic and use only the triangles' boxes and the centres of these boxes. The
 * surface area heuristic makes three passes: the first pass merges each box with one bin on each
 * axis, the second pass finds the best boundary between bins, and the third pass separates the
 * boxes.
 *
 * Source: paper, Sec. 3.1, Algorithm 1, line 9; for the surface area heuristic I. Wald, "On fast
 * Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on Interactive Ray
 * Tracing, 2007.
 * Differs: the surface area heuristic is not in the paper. The number of bins grows with the number
 * of triangles from 4 to 16.
 * Valid: boxes are in single precision relative to the middle of the scene. Small triangles may be
 * divided differently than by exact centres. The difference costs a little time and changes no hit.
 * Test: TestSplitRule.cxx, TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_SplitRule_h
#define avianlidar_SplitRule_h

#include "CollisionTree.h"
#include "TriangleBoxes.h"

#include <cstdint>

namespace avianlidar
{
/// Copy `from[0 .. count)` (count >= 2) to `to`, the boxes of the first child first.
/// @param from may be reordered
/// @param centers box of twice the centres of the boxes
/// @param depth depth of the node (0 for the root), which chooses the axis of SplitRule::Median.
/// From depth 96 on, every rule halves the list, because a rule that splits off single triangles
/// would otherwise turn the tree into a list.
/// @return number of boxes of the first child, in [1, count - 1]. Where a rule cannot divide (equal
/// centres), the list is halved in its given order.
std::size_t splitTriangles(SplitRule rule, LaneBox* from, LaneBox* to, std::size_t count,
  const LaneBox& centers, std::uint32_t depth);
}

#endif
