// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SplitRule.h
 * @brief How the triangles of a node are divided between its two children (paper, Sec. 3.1,
 * Algorithm 1, line 9).
 *
 * The rules see nothing but the triangles' boxes and their centres, in single precision relative to
 * the middle of the scene: triangles that are smaller than the roundings there may be divided in
 * another way than exact centres would be, which costs a little time and changes no hit. All are
 * deterministic.
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
/// @param depth of the node, root 0: chooses the axis of SplitRule::Median
/// @return size of the first part, in [1, count - 1]. Where a rule finds nothing to divide by
/// (equal centres), the list is halved as it stands.
std::size_t splitTriangles(SplitRule rule, LaneBox* from, LaneBox* to, std::size_t count,
  const LaneBox& centers, std::uint32_t depth);
}

#endif
