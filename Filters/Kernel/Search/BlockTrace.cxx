// SPDX-License-Identifier: BSD-3-Clause
#include "BlockTrace.h"

#include "Descents.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Beams of fewer rays are not parted into groups.
constexpr std::uint32_t FewestRaysInGroup = 8;

/// Beams of one apex and width may go together.
bool together(const BeamFrame& one, const BeamFrame& two)
{
  return one.origin == two.origin && one.halfBeamwidth == two.halfBeamwidth;
}

/// Leaves that the cone of a beam may meet, as roots; given up when there are too many.
class LeafVisitor
{
public:
  LeafVisitor(const std::vector<std::uint32_t>& order, BeamRoots& roots)
    : Order(order.data())
    , Roots(roots)
  {
  }
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    this->Triangles += count;
    this->Roots.addLeaf(static_cast<std::uint32_t>(triangles - this->Order), count);
    return !this->tooMany();
  }
  /// More triangles than that are cheaper ray by ray.
  bool tooMany() const { return this->Triangles > 2048; }

private:
  const std::uint32_t* Order;
  BeamRoots& Roots;
  std::uint32_t Triangles = 0;
};

template <typename Real>
class BlockTrace
{
public:
  BlockTrace(
    const CollisionTree& tree, const BeamBlock& block, TraceMode mode, BlockWorkspace& work)
    : Tree(tree)
    , Block(block)
    , Mode(mode)
    , Work(work)
    , Rays(tree, block, work.rays)
  {
  }

  void run()
  {
    this->Work.beams.clear();
    this->BeamsOfPacket = 1;
    const BeamFrame* before = nullptr;
    std::uint32_t most = 0;
    for (std::uint32_t b = 0; b < this->Block.size; ++b)
    {
      if (this->Block.rays[b] == 0)
      {
        continue;
      }
      if (this->Mode == TraceMode::SingleRays)
      {
        this->Rays.rayByRay(b);
        continue;
      }
      const BeamFrame& frame = this->Block.frames[b];
      if (before && !together(*before, frame))
      {
        this->groups(most);
        most = 0;
      }
      before = &frame;
      most = std::max(most, this->Block.rays[b]);
      this->Work.beams.push_back(b);
    }
    this->groups(most);
  }

private:
  /// All beams of one apex and width. @param most rays of a beam
  void groups(std::uint32_t most)
  {
    std::vector<std::uint32_t>& beams = this->Work.beams;
    this->BeamsOfPacket = std::max<std::size_t>(1, RayPacket::Width / std::max(1u, most));
    if (most < FewestRaysInGroup)
    {
      this->consecutive();
    }
    else
    {
      this->inGroups();
    }
    beams.clear();
  }

  void inGroups()
  {
    std::vector<std::uint32_t>& beams = this->Work.beams;
    orderBeams(this->Block.frames, beams, this->Work.keys);
    const std::size_t clusters = this->Mode == TraceMode::Beams ? 1 : ConeLanes::Width;
    const std::size_t size = clusters * this->BeamsOfPacket;
    for (std::size_t first = 0; first < beams.size(); first += size)
    {
      this->group({ &beams[first], std::min(size, beams.size() - first) });
    }
  }

  /// Packets of beams as they come, which in a scan are neighbours: with so few rays that is
  /// cheaper than to look who else is near.
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
    if (this->Tree.wide.nodes.empty() || this->Mode == TraceMode::Packets)
    {
      for (int k = 0; k < cones.count; ++k)
      {
        this->withoutRoots(clusters[k]);
      }
      return;
    }
    const int number = cones.count;
    const Vec3& apex = this->Block.frames[all.beams[0]].origin;
    const std::int64_t visited = findRoots(this->Tree.wide, apex, this->Work.group);
    if (visited < 0)
    {
      this->apart(all, number);
      return;
    }
    const auto share = static_cast<std::uint64_t>(visited) / all.count;
    for (std::size_t k = 0; k < all.count; ++k)
    {
      this->Work.rays.found.counters[all.beams[k]].nodesVisited += share;
    }
    for (int k = 0; k < number; ++k)
    {
      const BeamRoots& roots = this->Work.group.roots[k];
      if (!roots.nodes.empty())
      {
        this->Rays.packets(clusters[k], &roots);
      }
    }
  }

  /// A group whose beams lie too far apart to go together.
  void apart(const BeamCluster& all, int clusters)
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

  void withoutRoots(const BeamCluster& cluster)
  {
    if (!this->Tree.wide.nodes.empty() || cluster.count > 1)
    {
      this->Rays.packets(cluster, nullptr);
      return;
    }
    const std::uint32_t b = cluster.beams[0];
    BeamRoots& roots = this->Work.group.roots[0];
    roots.clear();
    LeafVisitor visitor(this->Tree.order, roots);
    const BeamVolumeTest cone(this->Block.frames[b]);
    this->Work.rays.found.counters[b].nodesVisited += std::visit([&](const auto& volumes)
      { return descend(this->Tree, volumes, cone, visitor, this->Work.stack); },
      this->Tree.volumes());
    if (visitor.tooMany())
    {
      this->Rays.rayByRay(b);
    }
    else if (!roots.nodes.empty())
    {
      this->Rays.packets(cluster, &roots);
    }
  }

  const CollisionTree& Tree;
  const BeamBlock& Block;
  TraceMode Mode;
  BlockWorkspace& Work;
  BlockRays<Real> Rays;
  std::size_t BeamsOfPacket = 1;
};
}

template <typename Real>
void traceBlock(
  const CollisionTree& tree, const BeamBlock& block, TraceMode mode, BlockWorkspace& work)
{
  BlockTrace<Real>(tree, block, mode, work).run();
}

template void traceBlock<float>(const CollisionTree&, const BeamBlock&, TraceMode, BlockWorkspace&);
template void traceBlock<double>(
  const CollisionTree&, const BeamBlock&, TraceMode, BlockWorkspace&);
}
