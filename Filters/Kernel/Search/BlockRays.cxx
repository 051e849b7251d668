// SPDX-License-Identifier: BSD-3-Clause
#include "BlockRays.h"

#include "Descents.h"
#include "TraceVisitors.h"

#include <algorithm>

namespace avianlidar
{
template <typename Real>
BlockRays<Real>::BlockRays(
  const CollisionTree& tree, const BeamBlock& block, BlockRaysWorkspace& work)
  : Tree(tree)
  , Block(block)
  , Work(work)
  , Survey(tree, block, work.found.counters, work.survey)
{
}

template <typename Real>
void BlockRays<Real>::rayByRay(std::uint32_t b)
{
  const BeamFrame& frame = this->Block.frames[b];
  const BeamRays& rays = this->Block.source(b);
  Hit* const hits = this->room();
  std::fill(hits, hits + rays.size(), Hit());
  const BeamPlaneMap map(frame);
  BeamRayVisitor<Real> visitor(*this->Tree.mesh, frame, map);
  bool any = false;
  const std::size_t few = std::min(rays.size(), PacketsBeforeSurvey * RayPacket::Width);
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    const Vec3 direction = unitDirection(frame.direction(rays.x[i], rays.y[i]));
    visitor.setRay(static_cast<Real>(rays.x[i]), static_cast<Real>(rays.y[i]), direction, hits[i]);
    this->counters(b).nodesVisited += descendRay(this->Tree, frame.origin, Vec3(0.0), direction,
      HitMarginBeam * frame.tanHalf, visitor, this->Work.stack);
    any = any || hits[i].valid();
    if (i + 1 == few && any)
    {
      std::transform(hits, hits + few, this->Work.met, [](const Hit& hit) { return hit.triangle; });
      if (this->Survey.run(b, nullptr, this->Work.met, few))
      {
        return;
      }
    }
  }
  if (any)
  {
    this->keep(b, rays.size());
  }
}

template <typename Real>
void BlockRays<Real>::packets(const BeamCluster& cluster, const BeamRoots* roots)
{
  if (cluster.count == 1)
  {
    this->packetsOfBeam(cluster.beams[0], roots);
  }
  else
  {
    this->packetOfBeams(cluster, roots);
  }
}

template <typename Real>
void BlockRays<Real>::packetsOfBeam(std::uint32_t b, const BeamRoots* roots)
{
  const bool first = this->Survey.filledBefore() || this->Block.rays[b] >= RaysAfterSurvey;
  if (first && this->Survey.run(b, roots, nullptr, 0))
  {
    return;
  }
  const BeamRays& rays = this->Block.source(b);
  const std::size_t count = rays.size();
  const std::vector<std::uint32_t>& order =
    this->Block.inOrder ? this->Work.order.asTheyCome(count) : this->Work.order.of(count);
  Hit* const hits = this->room();
  RayPacket& packet = this->Work.packet;
  packet.beam = &this->Block.frames[b];
  bool any = false;
  // Whole groups of sixteen, evenly.
  const std::size_t packets = (count + RayPacket::Width - 1) / RayPacket::Width;
  const std::size_t groups = (count + PacketGroup - 1) / PacketGroup;
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= packets; ++k)
  {
    const std::size_t end = std::min(count, k * groups / packets * PacketGroup);
    packet.count = static_cast<int>(end - begin);
    for (int i = 0; i < packet.count; ++i)
    {
      packet.x[i] = rays.x[order[begin + i]];
      packet.y[i] = rays.y[order[begin + i]];
    }
    this->trace(roots, b);
    for (int i = 0; i < packet.count; ++i)
    {
      hits[order[begin + i]] = packet.hit(i);
      any |= packet.hit(i).valid();
    }
    if (k <= PacketsBeforeSurvey)
    {
      std::copy(packet.triangle, packet.triangle + packet.count, this->Work.met + begin);
    }
    if (any && k == std::min(packets, PacketsBeforeSurvey) &&
      this->Survey.run(b, roots, this->Work.met, end))
    {
      return;
    }
    begin = end;
  }
  if (any)
  {
    this->keep(b, count);
  }
}

/// Beams of few rays, which fit into one packet.
template <typename Real>
void BlockRays<Real>::packetOfBeams(const BeamCluster& cluster, const BeamRoots* roots)
{
  RayPacket& packet = this->Work.packet;
  packet.beam = nullptr;
  packet.count = 0;
  for (std::size_t k = 0; k < cluster.count; ++k)
  {
    const std::uint32_t b = cluster.beams[k];
    const BeamRays& rays = this->Block.source(b);
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      packet.frame[packet.count] = &this->Block.frames[b];
      packet.x[packet.count] = rays.x[i];
      packet.y[packet.count++] = rays.y[i];
    }
  }
  this->trace(roots, cluster.beams[0]);
  int first = 0;
  for (std::size_t k = 0; k < cluster.count; ++k)
  {
    const std::uint32_t b = cluster.beams[k];
    const auto count = static_cast<int>(this->Block.rays[b]);
    Hit* const hits = this->room();
    bool any = false;
    for (int i = 0; i < count; ++i)
    {
      hits[i] = packet.hit(first + i);
      any |= hits[i].valid();
    }
    const auto rays = static_cast<std::size_t>(count);
    if (any && !this->Survey.run(b, roots, packet.triangle + first, rays))
    {
      this->keep(b, rays);
    }
    first += count;
  }
}

/// @param beam that bears the cost
template <typename Real>
void BlockRays<Real>::trace(const BeamRoots* roots, std::uint32_t beam)
{
  RayPacket& packet = this->Work.packet;
  const PacketCost cost = tracePacket<Real>(this->Tree, packet, this->Work.packets, roots);
  this->counters(beam).nodesVisited += cost.nodes;
  this->counters(beam).candidates += cost.triangles;
}

template class BlockRays<float>;
template class BlockRays<double>;
}
