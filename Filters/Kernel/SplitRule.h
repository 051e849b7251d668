// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SplitRule.h
 * @brief How the triangles of a node are divided between its two children (paper, Sec. 3.1,
 * Algorithm 1, line 9).
 *
 * The rules see nothing but the triangles' boxes and their centres. All are deterministic.
 */
#ifndef avianlidar_SplitRule_h
#define avianlidar_SplitRule_h

#include "CollisionTree.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Reorder `order[0 .. count)` (numbers of boxes; count >= 2) so that its first part goes to the
/// first child.
/// @param depth of the node, root 0: chooses the axis of SplitRule::Median
/// @return size of the first part, in [1, count - 1]. Where a rule finds nothing to divide by
/// (equal centres), the list is halved as it stands.
std::size_t splitTriangles(SplitRule rule, const std::vector<AABB>& boxes, std::uint32_t* order,
  std::size_t count, std::uint32_t depth);
}

#endif
