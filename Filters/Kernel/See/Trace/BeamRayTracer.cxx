// SPDX-License-Identifier: BSD-3-Clause
#include "BeamRayTracer.h"

#include "Descents.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Least number of rays of a beam in a group.
constexpr std::uint32_t FewestRaysInGroup = 8;

/// Largest number of triangles against which a beam's rays are tested together. With more
/// triangles, tracing ray by ray is faster.
constexpr std::size_t MostPotential = 2048;
}

BeamRayTracer::BeamRayTracer(
  const SceneTriangles& scene, const TracedBeams& beams, BeamRayWorkspace& work)
  : Scene(scene)
  , Tree(scene.tree())
  , Beams(beams)
  , Work(work)
{
}

void BeamRayTracer::trace(TraceMode mode)
{
  if (mode != TraceMode::Automatic)
  {
    for (std::uint32_t b = 0; b < this->Beams.size; ++b)
    {
      mode == TraceMode::SingleRays ? this->rayByRay(b) : this->traceAlone(b);
    }
    return;
  }
  GroupRule rule;
  rule.beamsOfCluster = std::max<std::size_t>(1, RayPacket::Width / this->Beams.rays);
  rule.sorts = rule.together = this->Beams.rays >= FewestRaysInGroup;
  rule.evenAlone = true;
  this->Work.groups.begin(this->Tree, this->Beams.frames, this->Beams.size, rule);
  BeamCluster cluster;
  while (this->Work.groups.next(cluster))
  {
    for (std::size_t k = 0; k < cluster.count; ++k)
    {
      this->counters(cluster.beams[k]).nodesVisited += cluster.nodesVisited;
    }
    if (this->Tree.other && cluster.count == 1 && rule.together)
    {
      this->traceAlone(cluster.beams[0]);
    }
    else if (!cluster.entries || !cluster.entries->nodes.empty())
    {
      this->packets(cluster);
    }
  }
}

/// Find the triangles that one beam may meet, then trace its rays against all of them.
void BeamRayTracer::traceAlone(std::uint32_t b)
{
  EntryPoints& entryPoints = this->Work.potential;
  const PotentialTriangles found = findPotential(
    this->Tree, this->Beams.frames[b], MostPotential, entryPoints, this->Work.groups.stack());
  this->counters(b).nodesVisited += found.nodesVisited;
  if (found.count > MostPotential)
  {
    this->rayByRay(b);
  }
  else if (found.count > 0)
  {
    this->packets({ &b, 1, &entryPoints, 0 });
  }
}

/// Trace all rays of a beam, with one descent for each ray.
void BeamRayTracer::rayByRay(std::uint32_t b)
{
  const BeamFrame& frame = this->Beams.frames[b];
  const BeamRays& rays = this->Beams.raysOf(b);
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

/// Trace all rays of a cluster in packets. If the cluster has several beams, the rays of all beams
/// must fit into one packet.
void BeamRayTracer::packets(const BeamCluster& cluster)
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

void BeamRayTracer::packetsOfBeam(std::uint32_t b, const EntryPoints* entryPoints)
{
  const BeamRays& rays = this->Beams.raysOf(b);
  const std::size_t count = rays.size();
  const std::vector<std::uint32_t>& order =
    this->Beams.inOrder ? this->Work.order.asTheyCome(count) : this->Work.order.of(count);
  std::uint32_t* const triangles = this->nextHits();
  RayPacket& packet = this->Work.packet;
  packet.beam = &this->Beams.frames[b];
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
    this->tracePacketOf(entryPoints, b);
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
void BeamRayTracer::packetOfBeams(const BeamCluster& cluster)
{
  RayPacket& packet = this->Work.packet;
  packet.beam = nullptr;
  packet.count = 0;
  for (std::size_t k = 0; k < cluster.count; ++k)
  {
    const std::uint32_t b = cluster.beams[k];
    const BeamRays& rays = this->Beams.raysOf(b);
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      packet.frame[packet.count] = &this->Beams.frames[b];
      packet.x[packet.count] = rays.x[i];
      packet.y[packet.count++] = rays.y[i];
    }
  }
  this->tracePacketOf(cluster.entries, cluster.beams[0]);
  const std::uint32_t* triangles = packet.triangle;
  for (std::size_t k = 0; k < cluster.count; ++k)
  {
    const std::uint32_t rays = this->Beams.rays;
    std::copy(triangles, triangles + rays, this->nextHits());
    if (std::any_of(triangles, triangles + rays, [](std::uint32_t t) { return t != NoTriangle; }))
    {
      this->commitHits(cluster.beams[k], rays);
    }
    triangles += rays;
  }
}

/// Trace the packet. @param beam the beam whose counters get the cost
void BeamRayTracer::tracePacketOf(const EntryPoints* entryPoints, std::uint32_t beam)
{
  RayPacket& packet = this->Work.packet;
  const PacketCost cost = tracePacket(this->Tree, packet, this->Work.packets, entryPoints);
  this->counters(beam).nodesVisited += cost.nodes;
  this->counters(beam).candidates += cost.triangles;
}
}
