// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockRays.h
 * @brief Traces the rays of a block's beams: in packets from entry points, or one by one.
 *
 * Source: none.
 * Valid: hits depend neither on packets nor on the order of rays.
 * Test: TestBeamGroup.cxx, TestPacketOrder.cxx.
 */
#ifndef avianlidar_BlockRays_h
#define avianlidar_BlockRays_h

#include "BeamGroup.h"
#include "BeamTracer.h"
#include "PacketOrder.h"
#include "RayPacket.h"
#include "Traversal.h"
#include "WideTree.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Workspace kept between blocks, so that no beam allocates.
struct BlockRaysWorkspace
{
  PacketWorkspace packets;
  RayPacket packet;
  PacketOrder order;
  BlockHits found;
  std::vector<std::uint32_t> triangles; ///< triangles that the rays of all beams of a block hit
  std::size_t used = 0;                 ///< entries of `triangles` in use
};

/// Traces the rays of one block, and puts hits and costs into `work.found`. The constructor's
/// arguments must outlive the object.
class BlockRays
{
public:
  BlockRays(const SceneTriangles& scene, const BeamBlock& block, BlockRaysWorkspace& work);

  /// Trace all rays of a beam, with one descent for each ray.
  void rayByRay(std::uint32_t beam);

  /// Trace all rays of a cluster in packets. If the cluster has several beams, the rays of all
  /// beams must fit into one packet.
  void packets(const BeamCluster& cluster);

private:
  void packetsOfBeam(std::uint32_t b, const EntryPoints* entryPoints);
  void packetOfBeams(const BeamCluster& cluster);
  void trace(const EntryPoints* entryPoints, std::uint32_t beam);

  /// Memory for the hits of the next beam, which commitHits() assigns to a beam.
  std::uint32_t* nextHits() { return this->Work.triangles.data() + this->Work.used; }
  void commitHits(std::uint32_t beam, std::size_t count)
  {
    this->Work.found.triangles[beam] = this->nextHits();
    this->Work.used += count;
  }
  TraceCounters& counters(std::uint32_t beam) { return this->Work.found.counters[beam]; }

  const SceneTriangles& Scene;
  const CollisionTree& Tree;
  const BeamBlock& Block;
  BlockRaysWorkspace& Work;
};
}

#endif
