// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockTrace.h
 * @brief All rays of a block of beams: which beams go together, and how.
 *
 * Beams are parted into groups of sixteen clusters; a cluster has as many beams as fill a packet of
 * rays, mostly one (beams of very few rays fill packets in the order in which they come). A group
 * goes down the wide tree together (BeamGroup.h); from the entry points of a cluster its rays go on
 * in packets (BlockRays.h). Trees that have no wide form are descended by each beam's cone alone,
 * whose leaves are the entry points; TraceMode::Beams does the same with any tree.
 */
#ifndef avianlidar_BlockTrace_h
#define avianlidar_BlockTrace_h

#include "BeamGroup.h"
#include "BeamTracer.h"
#include "BlockRays.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Kept between blocks, so that no beam allocates.
struct BlockWorkspace
{
  GroupWorkspace group;
  std::vector<std::uint32_t> beams; ///< of one apex and width
  std::vector<std::uint64_t> keys;
  BlockRaysWorkspace rays;
};

/// Trace a block into `work.rays.found`, whose hits and counters stand for no hit and no cost yet.
void traceBlock(
  const CollisionTree& tree, const BeamBlock& block, TraceMode mode, BlockWorkspace& work);
}

#endif
