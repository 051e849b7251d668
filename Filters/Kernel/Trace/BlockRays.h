// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockRays.h
 * @brief Traces the rays of a block's beams: in packets from the entry points of their beams on, or
 * one by one. A beam may be pre-tested before it gets all its rays (BeamPreTest).
 *
 * Source: none.
 * Valid: hits do not depend on packets or order. A beam that its pre-test ends has no hits.
 * Test: TestBeamGroup.cxx, TestPacketOrder.cxx, TestPlaneIntegrationScan.cxx.
 */
#ifndef avianlidar_BlockRays_h
#define avianlidar_BlockRays_h

#include "BeamTracer.h"
#include "PacketOrder.h"
#include "RayPacket.h"
#include "Traversal.h"
#include "WideTree.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// A beam is pre-tested after so many packets of its rays, or after all if they are fewer.
constexpr std::size_t PacketsBeforePreTest = 2;

/// From so many rays on, a beam is pre-tested before they are drawn: drawing them takes longer.
constexpr std::size_t RaysAfterPreTest = 1000;

/// Workspace kept between blocks, so that no beam allocates.
struct BlockRaysWorkspace
{
  PacketWorkspace packets;
  RayPacket packet;
  PacketOrder order;
  /// Triangles hit by the rays of the first packets.
  std::uint32_t met[PacketsBeforePreTest * RayPacket::Width];
  BlockHits found;
  std::vector<std::uint32_t> triangles; ///< hits of the rays of all beams of a block
  std::size_t used = 0;                 ///< entries of `triangles` in use
};

/// Neighbouring beams of one apex, by their numbers in the block.
struct BeamCluster
{
  const std::uint32_t* beams = nullptr;
  std::size_t count = 0;
};

/// Pre-tests of the beams of one block. The constructor's arguments must outlive it.
class BlockPreTest
{
public:
  /// @param counters one per beam of the block
  BlockPreTest(const CollisionTree& tree, const BeamBlock& block,
    std::vector<TraceCounters>& counters, TraversalStack& stack);

  /// Pre-test a beam. @param triangles hit by some of its rays; `count` is 0 before any ray
  /// @param entryPoints null: the whole tree @return true if the beam needs no rays
  bool run(std::uint32_t beam, const EntryPoints* entryPoints, const std::uint32_t* triangles,
    std::size_t count);

  /// True if the beam that was pre-tested last needed no rays. Its neighbour is then pre-tested
  /// before any ray is drawn.
  bool filledBefore() const { return this->FilledBefore; }

private:
  class Visitor;

  const CollisionTree& Tree;
  const BeamBlock& Block;
  std::vector<TraceCounters>& Counters;
  TraversalStack& Stack;
  bool FilledBefore = false;
};

/// The rays of one block; hits and costs go to `work.found`. The constructor's arguments must
/// outlive it.
class BlockRays
{
public:
  BlockRays(const CollisionTree& tree, const BeamBlock& block, BlockRaysWorkspace& work);

  /// Trace all rays of a beam, each by a descent of its own.
  void rayByRay(std::uint32_t beam);

  /// Trace all rays of a cluster in packets. The rays of several beams must fit into one packet.
  /// @param entryPoints of the cluster; null: the whole tree
  void packets(const BeamCluster& cluster, const EntryPoints* entryPoints);

private:
  void packetsOfBeam(std::uint32_t b, const EntryPoints* entryPoints);
  void packetOfBeams(const BeamCluster& cluster, const EntryPoints* entryPoints);
  void trace(const EntryPoints* entryPoints, std::uint32_t beam);

  /// room(): where the triangles of the next beam are written; keep(): makes them its hits.
  std::uint32_t* room() { return this->Work.triangles.data() + this->Work.used; }
  void keep(std::uint32_t beam, std::size_t count)
  {
    this->Work.found.triangles[beam] = this->room();
    this->Work.used += count;
  }
  TraceCounters& counters(std::uint32_t beam) { return this->Work.found.counters[beam]; }

  const CollisionTree& Tree;
  const BeamBlock& Block;
  BlockRaysWorkspace& Work;
  BlockPreTest PreTest;
};
}

#endif
