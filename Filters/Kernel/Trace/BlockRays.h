// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockRays.h
 * @brief The rays of a block's beams: in packets from the entry points of their beams on, or one by
 * one.
 */
#ifndef avianlidar_BlockRays_h
#define avianlidar_BlockRays_h

#include "BeamTracer.h"
#include "EntryPoints.h"
#include "PacketOrder.h"
#include "RayPacket.h"
#include "Traversal.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// A beam is pre-tested after so many packets of its rays, or all if they are
/// fewer.
constexpr std::size_t PacketsBeforePreTest = 2;

/// Rays that take so much longer than a pre-test, to be drawn alone, that it comes before them.
constexpr std::size_t RaysAfterPreTest = 1000;

/// Kept between blocks, so that no beam allocates.
struct BlockRaysWorkspace
{
  PacketWorkspace packets;
  RayPacket packet;
  PacketOrder order;
  std::uint32_t met[PacketsBeforePreTest * RayPacket::Width]; ///< triangles
  BlockHits found;
  std::vector<std::uint32_t> triangles; ///< of the rays of all beams of a block
  std::size_t used = 0;                 ///< of `triangles`
};

/// Neighbouring beams of one apex, by their numbers in the block.
struct BeamCluster
{
  const std::uint32_t* beams = nullptr;
  std::size_t count = 0;
};

/// Pre-tests of the beams of one block; what the constructor is given must outlive it.
class BlockPreTest
{
public:
  /// @param counters of each beam of the block
  BlockPreTest(const CollisionTree& tree, const BeamBlock& block,
    std::vector<TraceCounters>& counters, TraversalStack& stack);

  /// After some rays of a beam, which hit these triangles; or, with a `count` of 0, before all.
  /// @param entryPoints null: those of the tree @return true if the beam needs no rays
  bool run(std::uint32_t beam, const EntryPoints* entryPoints, const std::uint32_t* triangles,
    std::size_t count);

  /// The beam that was pre-tested last needed no rays: its neighbour is worth a pre-test before
  /// all.
  bool filledBefore() const { return this->FilledBefore; }

private:
  class Visitor;

  const CollisionTree& Tree;
  const BeamBlock& Block;
  std::vector<TraceCounters>& Counters;
  TraversalStack& Stack;
  bool FilledBefore = false;
};

/// What the constructor is given must outlive it; hits and costs go to `work.found`.
class BlockRays
{
public:
  BlockRays(const CollisionTree& tree, const BeamBlock& block, BlockRaysWorkspace& work);

  /// All rays of a beam, each down the tree by itself.
  void rayByRay(std::uint32_t beam);

  /// All rays of a cluster, in packets; if it has several beams, they must fit into one.
  /// @param entryPoints of the cluster; null: those of the tree
  void packets(const BeamCluster& cluster, const EntryPoints* entryPoints);

private:
  void packetsOfBeam(std::uint32_t b, const EntryPoints* entryPoints);
  void packetOfBeams(const BeamCluster& cluster, const EntryPoints* entryPoints);
  void trace(const EntryPoints* entryPoints, std::uint32_t beam);

  /// Where the triangles of the next beam go, and that they are to stay there.
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
