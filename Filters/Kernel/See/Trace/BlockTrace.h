// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockTrace.h
 * @brief Traces a block of beams: decides which beams are traced together, and in which way.
 *
 * Beams of one apex and width are ordered along a Z-order curve and cut into groups of sixteen
 * clusters. A cluster has as many beams as fill a packet of rays, mostly one beam. Beams of fewer
 * than eight rays form no groups and fill packets in the order in which the beams come. A group
 * descends the wide tree (BeamGroup.h). From the entry points of a cluster, the cluster's rays
 * descend further in packets (BlockRays.h). Without a wide tree, or with TraceMode::Beams, each
 * beam's cone descends by itself. The leaves that the cone meets are then the entry points.
 *
 * Source: paper, Sec. 3.2.
 * Differs: see BeamGroup.h. A cone that meets more than 2048 triangles is traced ray by ray.
 * Valid: as BeamTracer.h.
 * Test: TestBeamGroup.cxx, TestBeamTracer.cxx.
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
/// Workspace kept between blocks, so that no beam allocates.
struct BlockWorkspace
{
  BeamGroups groups;
  EntryPoints potential; ///< triangles that one beam may meet
  BlockRaysWorkspace rays;
};

/// Trace a block, without movers, into `work.rays.found`, which must have no hits and no cost.
void traceBlock(
  const SceneTriangles& scene, const BeamBlock& block, TraceMode mode, BlockWorkspace& work);
}

#endif
