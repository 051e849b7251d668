// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockTrace.h
 * @brief All rays of a block of beams: which beams go together, and how.
 *
 * Beams are parted into groups of sixteen clusters; a cluster has as many beams as fill a packet of
 * rays, mostly one (beams of very few rays fill packets in the order in which they come). A group
 * goes down the folded tree together (BeamGroup.h); from the roots of a cluster its rays go on in
 * packets (RayPacket.h). Trees that have no folded form are descended by each beam's cone alone,
 * whose leaves are the roots.
 */
#ifndef avianlidar_BlockTrace_h
#define avianlidar_BlockTrace_h

#include "BeamGroup.h"
#include "BeamTracer.h"
#include "RayPacket.h"
#include "Traversal.h"

#include <cstdint>
#include <map>
#include <vector>

namespace avianlidar
{
/// A beam is surveyed (BeamSurvey) after so many packets of its rays, or all if they are fewer.
constexpr std::size_t PacketsBeforeSurvey = 2;

/// Kept between blocks, so that no beam allocates.
struct BlockWorkspace
{
  TraversalStack stack;
  GroupWorkspace group;
  PacketWorkspace packets;
  RayPacket packet;
  std::vector<std::uint32_t> beams; ///< of one apex and width
  std::vector<std::uint32_t> nodes; ///< to be looked at in a survey
  std::vector<std::uint64_t> keys;
  std::uint32_t met[PacketsBeforeSurvey * RayPacket::Width]; ///< triangles
  BlockHits found;
  std::vector<Hit> hits; ///< of all beams of a block
  std::size_t used = 0;  ///< of `hits`
  /// Of the rays of a beam, by their number: neighbours together.
  std::map<std::size_t, std::vector<std::uint32_t>> orders;

  /// Rays in compact groups of sixteen. Beams of equally many rays mostly have them in the same
  /// strata, so the order found for one serves all.
  const std::vector<std::uint32_t>& orderOf(const BeamRays& rays);
};

/// Trace a block into `work.found`, whose hits and counters stand for no hit and no cost yet.
/// `Real`: precision of the edge functions.
template <typename Real>
void traceBlock(
  const CollisionTree& tree, const BeamBlock& block, TraceMode mode, BlockWorkspace& work);
}

#endif
