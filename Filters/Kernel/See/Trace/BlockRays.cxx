// SPDX-License-Identifier: BSD-3-Clause
#include "BlockRays.h"

#include "Descents.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
BlockRays::BlockRays(const SceneTriangles& scene, const BeamBlock& block, BlockRaysWorkspace& work)
  : Scene(scene)
  , Tree(scene.tree())
  , Block(block)
  , Work(work)
{
}

void BlockRays::rayByRay(std::uint32_t b)
{
  const BeamFrame& frame = this->Block.frames[b];
  const BeamRays& rays = this->Block.raysOf(b);
  std::uint32_t* const triangles = this->nextHits();
  const BeamPlaneMap map(frame);
  BeamRayVisitor visitor(this->Scene, frame, map);
  bool any = false;
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    const Vec3 direction = unitDirection(frame.direction(rays.x[i], rays.y[i]));
    Hit hit;
    visitor.setRay(rays.x[i], rays.y[i], direction, hit);
    this->counters(b).nodesVisited += descendRay(this->Tree, frame.origin, Vec3(0.0), direction,
      HitMarginBeam * frame.tanHalf, visitor, this->Work.packets.stack);
    triangles[i] = hit.triangle;
    any = any || hit.valid();
  }
  if (any)
  {
    this->commitHits(b, rays.size());
  }
}

void BlockRays::packets(const BeamCluster& cluster)
{
  if (cluster.count == 1)
  {
    this->packetsOfBeam(cluster.beams[0], cluster.entries);
  }
  else
  {
    this->packetOfBeams(cluster);
  }
}

void BlockRays::packetsOfBeam(std::uint32_t b, const EntryPoints* entryPoints)
{
  const BeamRays& rays = this->Block.raysOf(b);
  const std::size_t count = rays.size();
  const std::vector<std::uint32_t>& order =
    this->Block.inOrder ? this->Work.order.asTheyCome(count) : this->Work.order.of(count);
  std::uint32_t* const triangles = this->nextHits();
  RayPacket& packet = this->Work.packet;
  packet.beam = &this->Block.frames[b];
  bool any = false;
  // Packets hold whole groups of sixteen rays, about the same number of groups in each packet.
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
    this->trace(entryPoints, b);
    for (int i = 0; i < packet.count; ++i)
    {
      triangles[order[begin + i]] = packet.triangle[i];
      any |= packet.triangle[i] != NoTriangle;
    }
    begin = end;
  }
  if (any)
  {
    this->commitHits(b, count);
  }
}

/// Trace beams of few rays, which fit into one packet.
void BlockRays::packetOfBeams(const BeamCluster& cluster)
{
  RayPacket& packet = this->Work.packet;
  packet.beam = nullptr;
  packet.count = 0;
  for (std::size_t k = 0; k < cluster.count; ++k)
  {
    const std::uint32_t b = cluster.beams[k];
    const BeamRays& rays = this->Block.raysOf(b);
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      packet.frame[packet.count] = &this->Block.frames[b];
      packet.x[packet.count] = rays.x[i];
      packet.y[packet.count++] = rays.y[i];
    }
  }
  this->trace(cluster.entries, cluster.beams[0]);
  const std::uint32_t* triangles = packet.triangle;
  for (std::size_t k = 0; k < cluster.count; ++k)
  {
    const std::uint32_t rays = this->Block.rays;
    std::copy(triangles, triangles + rays, this->nextHits());
    if (std::any_of(triangles, triangles + rays, [](std::uint32_t t) { return t != NoTriangle; }))
    {
      this->commitHits(cluster.beams[k], rays);
    }
    triangles += rays;
  }
}

/// Trace the packet. @param beam the beam whose counters get the cost
void BlockRays::trace(const EntryPoints* entryPoints, std::uint32_t beam)
{
  RayPacket& packet = this->Work.packet;
  const PacketCost cost = tracePacket(this->Tree, packet, this->Work.packets, entryPoints);
  this->counters(beam).nodesVisited += cost.nodes;
  this->counters(beam).candidates += cost.triangles;
}
}
