// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file LowerSubtree.h
 * @brief Divides one node of a tree down to its leaves, depth first, on one thread.
 */
#ifndef avianlidar_LowerSubtree_h
#define avianlidar_LowerSubtree_h

#include "TreeDraft.h"

namespace avianlidar
{
/// Writes nodes, their boxes and the order of the triangles below `root`.
/// @return number of nodes below it
std::size_t divideSubtree(const TreeDraft& draft, const DraftEntry& root, std::uint32_t* order);
}

#endif
