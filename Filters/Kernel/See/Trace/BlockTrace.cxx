// SPDX-License-Identifier: BSD-3-Clause
#include "BlockTrace.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// Least number of rays of a beam in a group.
constexpr std::uint32_t FewestRaysInGroup = 8;

/// Largest number of triangles against which a beam's rays are tested together. With more
/// triangles, tracing ray by ray is faster.
constexpr std::size_t MostPotential = 2048;

class BlockTrace
{
public:
  BlockTrace(
    const SceneTriangles& scene, const BeamBlock& block, TraceMode mode, BlockWorkspace& work)
    : Tree(scene.tree())
    , Block(block)
    , Mode(mode)
    , Work(work)
    , Rays(scene, block, work.rays)
  {
  }

  void run()
  {
    const std::uint32_t rays = this->Block.rays;
    if (this->Mode != TraceMode::Automatic)
    {
      for (std::uint32_t b = 0; b < this->Block.size; ++b)
      {
        this->Mode == TraceMode::SingleRays ? this->Rays.rayByRay(b) : this->traceAlone(b);
      }
      return;
    }
    GroupRule rule;
    rule.beamsOfCluster = std::max<std::size_t>(1, RayPacket::Width / rays);
    rule.sorts = rule.together = rays >= FewestRaysInGroup;
    rule.evenAlone = true;
    this->Work.groups.begin(this->Tree, this->Block.frames, this->Block.size, rule);
    BeamCluster cluster;
    while (this->Work.groups.next(cluster))
    {
      for (std::size_t k = 0; k < cluster.count; ++k)
      {
        this->Work.rays.found.counters[cluster.beams[k]].nodesVisited += cluster.nodesVisited;
      }
      if (this->Tree.other && cluster.count == 1 && rule.together)
      {
        this->traceAlone(cluster.beams[0]);
      }
      else if (!cluster.entries || !cluster.entries->nodes.empty())
      {
        this->Rays.packets(cluster);
      }
    }
  }

private:
  /// Find the triangles that one beam may meet, then trace its rays against all of them.
  void traceAlone(std::uint32_t b)
  {
    EntryPoints& entryPoints = this->Work.potential;
    const PotentialTriangles found = findPotential(
      this->Tree, this->Block.frames[b], MostPotential, entryPoints, this->Work.groups.stack());
    this->Work.rays.found.counters[b].nodesVisited += found.nodesVisited;
    if (found.count > MostPotential)
    {
      this->Rays.rayByRay(b);
    }
    else if (found.count > 0)
    {
      this->Rays.packets({ &b, 1, &entryPoints, 0 });
    }
  }

  const CollisionTree& Tree;
  const BeamBlock& Block;
  TraceMode Mode;
  BlockWorkspace& Work;
  BlockRays Rays;
};
}

void traceBlock(
  const SceneTriangles& scene, const BeamBlock& block, TraceMode mode, BlockWorkspace& work)
{
  BlockTrace(scene, block, mode, work).run();
}
}
