// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file UpperLayers.h
 * @brief Divides the large nodes of a tree, layer by layer, with many threads at each of them.
 *
 * The boxes of a layer's nodes are cut into chunks. For the surface area heuristic every chunk
 * fills bins of its own; merged, they say where a node is divided and how many boxes of each chunk
 * go to each side, so that all chunks are copied at once. Other rules divide different nodes in
 * parallel.
 */
#ifndef avianlidar_UpperLayers_h
#define avianlidar_UpperLayers_h

#include "ParallelLoop.h"
#include "TreeDraft.h"

namespace avianlidar
{
/// Divide all nodes of more than `largest` triangles (which is not less than a leaf may hold).
/// @param rest the nodes that are left, in the order of their boxes
/// @return false if somebody said stop
bool divideUpperLayers(TreeDraft& draft, std::size_t largest, ParallelTeam& team,
  const KeepGoing& keepGoing, std::vector<DraftEntry>& rest);
}

#endif
