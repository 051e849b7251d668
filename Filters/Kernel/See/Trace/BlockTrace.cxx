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
    this->Work.beams.clear();
    this->BeamsOfPacket = std::max<std::size_t>(1, RayPacket::Width / this->Block.rays);
    const BeamFrame* before = nullptr;
    for (std::uint32_t b = 0; b < this->Block.size; ++b)
    {
      if (this->Mode == TraceMode::SingleRays)
      {
        this->Rays.rayByRay(b);
        continue;
      }
      if (this->Mode == TraceMode::Beams)
      {
        this->traceAlone(b);
        continue;
      }
      const BeamFrame& frame = this->Block.frames[b];
      if (before && !areTogether(*before, frame))
      {
        this->traceCollected();
      }
      before = &frame;
      this->Work.beams.push_back(b);
    }
    this->traceCollected();
  }

private:
  /// Trace the collected beams, which have one apex and width.
  void traceCollected()
  {
    this->Block.rays < FewestRaysInGroup ? this->consecutive() : this->inGroups();
    this->Work.beams.clear();
  }

  void inGroups()
  {
    std::vector<std::uint32_t>& beams = this->Work.beams;
    orderBeams(this->Block.frames, beams, this->Work.keys);
    const std::size_t size = ConeLanes::Width * this->BeamsOfPacket;
    for (std::size_t first = 0; first < beams.size(); first += size)
    {
      this->group({ &beams[first], std::min(size, beams.size() - first) });
    }
  }

  /// Fill packets in the order of the scan, where neighbours follow each other. With so few rays
  /// the order of the scan is faster than sorting.
  void consecutive()
  {
    const std::vector<std::uint32_t>& beams = this->Work.beams;
    for (std::size_t first = 0; first < beams.size(); first += this->BeamsOfPacket)
    {
      this->Rays.packets(
        { &beams[first], std::min(this->BeamsOfPacket, beams.size() - first) }, nullptr);
    }
  }

  void group(const BeamCluster& all)
  {
    BeamCluster clusters[ConeLanes::Width];
    ConeLanes& cones = this->Work.group.cones;
    cones.count = 0;
    for (std::size_t first = 0; first < all.count; first += this->BeamsOfPacket)
    {
      BeamCluster& cluster = clusters[cones.count];
      cluster = { all.beams + first, std::min(this->BeamsOfPacket, all.count - first) };
      cones.add(this->Block.frames, cluster.beams, cluster.count);
    }
    cones.close();
    if (this->Tree.other)
    {
      for (int k = 0; k < cones.count; ++k)
      {
        this->withoutWideTree(clusters[k]);
      }
      return;
    }
    const int number = cones.count;
    const Vec3& apex = this->Block.frames[all.beams[0]].origin;
    const std::int64_t visited = findEntryPoints(this->Tree.wide, apex, this->Work.group);
    if (visited < 0)
    {
      this->halveGroup(all, number);
      return;
    }
    const auto share = static_cast<std::uint64_t>(visited) / all.count;
    for (std::size_t k = 0; k < all.count; ++k)
    {
      this->Work.rays.found.counters[all.beams[k]].nodesVisited += share;
    }
    for (int k = 0; k < number; ++k)
    {
      const EntryPoints& entryPoints = this->Work.group.entryPoints[k];
      if (!entryPoints.nodes.empty())
      {
        this->Rays.packets(clusters[k], &entryPoints);
      }
    }
  }

  /// Halve a group whose beams lie too far apart.
  void halveGroup(const BeamCluster& all, int clusters)
  {
    if (clusters == 1)
    {
      this->Rays.packets(all, nullptr);
      return;
    }
    const std::size_t half = static_cast<std::size_t>(clusters / 2) * this->BeamsOfPacket;
    this->group({ all.beams, half });
    this->group({ all.beams + half, all.count - half });
  }

  void withoutWideTree(const BeamCluster& cluster)
  {
    if (cluster.count > 1)
    {
      this->Rays.packets(cluster, nullptr);
    }
    else
    {
      this->traceAlone(cluster.beams[0]);
    }
  }

  /// Find the triangles that one beam may meet, then trace its rays against all of them.
  void traceAlone(std::uint32_t b)
  {
    EntryPoints& entryPoints = this->Work.group.entryPoints[0];
    const PotentialTriangles found = findPotential(
      this->Tree, this->Block.frames[b], MostPotential, entryPoints, this->Work.group.stack);
    this->Work.rays.found.counters[b].nodesVisited += found.nodesVisited;
    if (found.count > MostPotential)
    {
      this->Rays.rayByRay(b);
    }
    else if (found.count > 0)
    {
      this->Rays.packets({ &b, 1 }, &entryPoints);
    }
  }

  const CollisionTree& Tree;
  const BeamBlock& Block;
  TraceMode Mode;
  BlockWorkspace& Work;
  BlockRays Rays;
  std::size_t BeamsOfPacket = 1;
};
}

void traceBlock(
  const SceneTriangles& scene, const BeamBlock& block, TraceMode mode, BlockWorkspace& work)
{
  BlockTrace(scene, block, mode, work).run();
}
}
