// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TreeVisits.h
 * @brief Where in the collision tree beams go: how many visit each node.
 *
 * Every beam goes down the tree as it was built, with the search's own test of its cone against the
 * volumes (paper, Sec. 3.2) and the search's own descent (Traversal.h), to all that it may meet,
 * hidden or not. That is the search for hits itself in trees of oriented boxes and spheres, and
 * what BeamTracer counts there. Trees of boxes are searched in their folded form, sixteen beams at
 * a time and from the front to the back (Documentation/collision-detection.md): there the counts
 * say where beams lead, not what the search costs.
 */
#ifndef avianlidar_TreeVisits_h
#define avianlidar_TreeVisits_h

#include "CollisionTree.h"
#include "ParallelLoop.h"
#include "ScanBeams.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// One number for each of the first nodes of the tree.
struct TreeVisits
{
  std::vector<std::int64_t> tested; ///< beams that test the volume: those that meet its parent's
  std::vector<std::int64_t> met;    ///< of them, beams whose cone meets it
};

/// Nodes of level `level` and above it: the first so many, as they are numbered breadth first.
std::size_t nodesToLevel(const CollisionTree& tree, std::uint32_t level);

/// Count the visits of all nodes down to `level`, no beam goes deeper. The same for any number of
/// threads and order of the beams.
/// @param beams checked @param halfBeamwidth rad, in (0, pi/3] @param threads > 0, or 0 for
/// loopThreads(0)
/// @return false if keepGoing said stop; `visits` is without meaning then
bool countVisits(const CollisionTree& tree, const ScanBeams& beams, double halfBeamwidth,
  std::uint32_t level, int threads, const KeepGoing& keepGoing, TreeVisits& visits);
}

#endif
