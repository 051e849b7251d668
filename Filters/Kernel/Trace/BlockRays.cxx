// SPDX-License-Identifier: BSD-3-Clause
#include "BlockRays.h"

#include "Descents.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
/// Passes the triangles of the cone to the pre-test.
class BlockPreTest::Visitor
{
public:
  explicit Visitor(BeamPreTest& preTest)
    : PreTest(preTest)
  {
  }
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    return this->PreTest.leaf(triangles, count);
  }

private:
  BeamPreTest& PreTest;
};

BlockPreTest::BlockPreTest(const CollisionTree& tree, const BeamBlock& block,
  std::vector<TraceCounters>& counters, TraversalStack& stack)
  : Tree(tree)
  , Block(block)
  , Counters(counters)
  , Stack(stack)
{
}

bool BlockPreTest::run(std::uint32_t beam, const EntryPoints* entryPoints,
  const std::uint32_t* triangles, std::size_t count)
{
  BeamPreTest* const preTest = this->Block.preTest;
  this->FilledBefore = false;
  if (!preTest || !preTest->begin(beam, triangles, count))
  {
    return false;
  }
  TraceCounters& counters = this->Counters[beam];
  Visitor visitor(*preTest);
  const BeamVolumeTest probe(this->Block.frames[beam]);
  WideCone cone;
  if (entryPoints && !this->Tree.wide.nodes.empty() && cone.set(this->Tree.wide, probe))
  {
    counters.nodesVisited += descendWide(this->Tree, cone, visitor, this->Stack, entryPoints);
  }
  else
  {
    counters.nodesVisited += descendCone(this->Tree, probe, visitor, this->Stack);
  }
  if (!preTest->end())
  {
    return false;
  }
  counters.raysTraced = 0;
  this->FilledBefore = true;
  return true;
}

BlockRays::BlockRays(const CollisionTree& tree, const BeamBlock& block, BlockRaysWorkspace& work)
  : Tree(tree)
  , Block(block)
  , Work(work)
  , PreTest(tree, block, work.found.counters, work.packets.stack)
{
}

void BlockRays::rayByRay(std::uint32_t b)
{
  const BeamFrame& frame = this->Block.frames[b];
  const BeamRays& rays = this->Block.source(b);
  std::uint32_t* const triangles = this->room();
  const BeamPlaneMap map(frame);
  BeamRayVisitor visitor(*this->Tree.mesh, frame, map);
  bool any = false;
  const std::size_t few = std::min(rays.size(), PacketsBeforePreTest * RayPacket::Width);
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    const Vec3 direction = unitDirection(frame.direction(rays.x[i], rays.y[i]));
    Hit hit;
    visitor.setRay(rays.x[i], rays.y[i], direction, hit);
    this->counters(b).nodesVisited += descendRay(this->Tree, frame.origin, Vec3(0.0), direction,
      HitMarginBeam * frame.tanHalf, visitor, this->Work.packets.stack);
    triangles[i] = hit.triangle;
    any = any || hit.valid();
    if (i + 1 == few && any && this->PreTest.run(b, nullptr, triangles, few))
    {
      return;
    }
  }
  if (any)
  {
    this->keep(b, rays.size());
  }
}

void BlockRays::packets(const BeamCluster& cluster, const EntryPoints* entryPoints)
{
  if (cluster.count == 1)
  {
    this->packetsOfBeam(cluster.beams[0], entryPoints);
  }
  else
  {
    this->packetOfBeams(cluster, entryPoints);
  }
}

void BlockRays::packetsOfBeam(std::uint32_t b, const EntryPoints* entryPoints)
{
  const bool first = this->PreTest.filledBefore() || this->Block.rays[b] >= RaysAfterPreTest;
  if (first && this->PreTest.run(b, entryPoints, nullptr, 0))
  {
    return;
  }
  const BeamRays& rays = this->Block.source(b);
  const std::size_t count = rays.size();
  const std::vector<std::uint32_t>& order =
    this->Block.inOrder ? this->Work.order.asTheyCome(count) : this->Work.order.of(count);
  std::uint32_t* const triangles = this->room();
  RayPacket& packet = this->Work.packet;
  packet.beam = &this->Block.frames[b];
  bool any = false;
  // Packets take whole groups of sixteen, about the same number each.
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
    if (k <= PacketsBeforePreTest)
    {
      std::copy(packet.triangle, packet.triangle + packet.count, this->Work.met + begin);
    }
    if (any && k == std::min(packets, PacketsBeforePreTest) &&
      this->PreTest.run(b, entryPoints, this->Work.met, end))
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

/// Trace beams of few rays, which fit into one packet.
void BlockRays::packetOfBeams(const BeamCluster& cluster, const EntryPoints* entryPoints)
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
  this->trace(entryPoints, cluster.beams[0]);
  int first = 0;
  for (std::size_t k = 0; k < cluster.count; ++k)
  {
    const std::uint32_t b = cluster.beams[k];
    const auto count = static_cast<int>(this->Block.rays[b]);
    const std::uint32_t* const triangles = packet.triangle + first;
    const auto rays = static_cast<std::size_t>(count);
    std::copy(triangles, triangles + count, this->room());
    const bool any =
      std::any_of(triangles, triangles + count, [](std::uint32_t t) { return t != NoTriangle; });
    if (any && !this->PreTest.run(b, entryPoints, triangles, rays))
    {
      this->keep(b, rays);
    }
    first += count;
  }
}

/// Trace the packet. @param beam whose counters get the cost
void BlockRays::trace(const EntryPoints* entryPoints, std::uint32_t beam)
{
  RayPacket& packet = this->Work.packet;
  const PacketCost cost = tracePacket(this->Tree, packet, this->Work.packets, entryPoints);
  this->counters(beam).nodesVisited += cost.nodes;
  this->counters(beam).candidates += cost.triangles;
}
}
