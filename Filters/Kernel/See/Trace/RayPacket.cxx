// SPDX-License-Identifier: BSD-3-Clause
#include "RayPacket.h"

#include "Descents.h"
#include "Multiversion.h"
#include "PacketRanges.h"
#include "RayPacketTriangles.h"
#include "TriangleTest.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// BeamFrame::direction() for rays of one beam, in single precision.
AVIANLIDAR_MULTIVERSION void roundedLanes(
  const BeamFrame& frame, const double* x, const double* y, int end, PacketView& view)
{
  const Vec3 e1 = frame.e1;
  const Vec3 e2 = frame.e2;
  const Vec3 axis = frame.axis;
  const double t = frame.tanHalf;
#pragma omp simd
  for (int i = 0; i < end; ++i)
  {
    view.direction[0][i] = static_cast<float>(axis.x + t * (x[i] * e1.x + y[i] * e2.x));
    view.direction[1][i] = static_cast<float>(axis.y + t * (x[i] * e1.y + y[i] * e2.y));
    view.direction[2][i] = static_cast<float>(axis.z + t * (x[i] * e1.z + y[i] * e2.z));
  }
}

/// Descent of a packet. The members of an entry are rays. The bound of an entry is a range over
/// |D|.
class PacketSearch : public WidePolicy
{
public:
  PacketSearch(const CollisionTree& tree, PacketState& state)
    : Tree(tree)
    , Mesh(*tree.mesh)
    , State(state)
    , Packet(*state.packet)
    , Ranges(state)
  {
  }

  /// Begin a packet. @return false if its rays lie too far apart, or exceed single precision
  bool begin()
  {
    PacketState& s = this->State;
    const BeamFrame* widest = &this->Packet.frameOf(0);
    for (int i = 1; !this->Packet.beam && i < this->Packet.count; ++i)
    {
      if (this->Packet.frame[i] != widest && this->Packet.frame[i]->tanHalf > widest->tanHalf)
      {
        widest = this->Packet.frame[i];
      }
    }
    setDirections(this->Packet, s.view);
    s.view.frustum.spread = static_cast<float>(HitMarginBeam * widest->tanHalf + 2.0 * HitMargin);
    const double longest = 1.0 / widest->cosHalf;
    if (!s.view.frustum.setApex(this->Tree.wide, widest->origin) ||
      !s.view.set(this->Packet.count, longest))
    {
      return false;
    }
    this->Scale = static_cast<float>((1.0 - 1e-6) / longest);
    s.exact.begin(this->Tree, widest->origin);
    s.known.begin(this->Tree, *widest);
    s.filled = 0;
    s.missing = 0;
    s.farthest = FloatInfinity;
    this->beginBest();
    return true;
  }

  PacketCost run(const EntryPoints* entryPoints, TraversalStack& stack)
  {
    const RayBits all = ~RayBits(0) >> (64 - this->Packet.count);
    this->Cost.nodes =
      descendWide(this->Tree.wide, DescentStart{ entryPoints, all, this->Scale }, *this, stack);
    std::copy(this->State.best.triangle, this->State.best.triangle + this->Packet.count,
      this->Packet.triangle);
    return this->Cost;
  }

  float limit() const { return this->State.farthest; }

  template <class Push>
  void open(const WideNode& node, RayBits rays, Push push)
  {
    PacketChild children[WideNode::Width];
    const int count = meetChildren(this->State.view, node, rays, children);
    for (int i = 0; i < count; ++i)
    {
      const PacketChild& child = children[i];
      push(child.lane, child.rays, child.nearest);
      this->prefetch(node.first[child.lane], node.count[child.lane]);
    }
  }

  /// Triangles are tested eight at a time.
  bool end(const DescentEntry& leaf)
  {
    for (std::uint32_t k = 0; k < leaf.count; ++k)
    {
      this->take(leaf.node + k, leaf.members);
      if (this->State.filled == PacketTriangles::Width)
      {
        this->test();
        if (leaf.nearest > this->State.farthest)
        {
          break;
        }
      }
    }
    return true;
  }

  void afterEnds()
  {
    if (this->State.filled > 0)
    {
      this->test();
    }
  }

private:
  /// Prefetch a node, or the corners of a leaf's triangles.
  void prefetch(std::uint32_t first, std::uint32_t count) const
  {
    if (count > 0)
    {
      const std::uint32_t most = std::min<std::uint32_t>(count, PacketTriangles::Width);
      for (std::uint32_t k = first; k < first + most; ++k)
      {
        if (!this->State.known.find(k))
        {
          for (const std::uint32_t point : this->Mesh.triangles[this->Tree.order[k]])
          {
            __builtin_prefetch(&this->Mesh.points[point]);
          }
        }
      }
      return;
    }
    const auto* node = reinterpret_cast<const char*>(&this->Tree.wide.nodes[first]);
    for (std::size_t line = 0; line < sizeof(WideNode); line += 64)
    {
      __builtin_prefetch(node + line);
    }
  }

  void take(std::uint32_t position, RayBits rays)
  {
    PacketState& s = this->State;
    const ApexTriangle* seen = s.known.find(position);
    if (!seen)
    {
      s.positions[s.missing] = position;
      seen = &s.fresh[s.missing++];
    }
    s.triangles.seen[s.filled] = seen;
    s.triangles.rays[s.filled++] = rays;
  }

  void test()
  {
    PacketState& s = this->State;
    this->Cost.triangles += static_cast<std::uint64_t>(s.filled);
    if (s.missing > 0)
    {
      s.known.see(s.positions, s.missing, s.fresh);
    }
    bool undecided = false;
    RayBits changed = testTriangles(s.view, s.filled, s.triangles, s.best, undecided);
    for (int k = 0; undecided && k < s.filled; ++k)
    {
      const std::uint32_t triangle = s.triangles.seen[k]->number;
      changed |= this->Ranges.compare(s.triangles.level[k], triangle);
      changed |= this->Ranges.decide(s.triangles.unsure[k], triangle);
    }
    for (int k = 0; k < s.missing; ++k)
    {
      s.known.keep(s.fresh[k]);
    }
    s.filled = 0;
    s.missing = 0;
    if (changed != 0)
    {
      shortenRays(s.best, changed, s.view);
      s.farthest = *std::max_element(std::begin(s.view.farthest), std::end(s.view.farthest));
    }
  }

  void beginBest()
  {
    PacketState& s = this->State;
    const int count = this->Packet.count;
    const int end = padded(count);
    std::fill(s.best.triangle, s.best.triangle + count, NoTriangle);
    for (float* const bound : { s.best.low, s.best.high })
    {
      std::fill(bound, bound + count, 0.0f);
      std::fill(bound + count, bound + end, FloatInfinity); // padding never has a nearer hit
    }
  }

  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  PacketState& State;
  RayPacket& Packet;
  PacketRanges Ranges;
  PacketCost Cost;
  float Scale = 0.0f; ///< factor from distances to lower bounds of ranges over |D|
};

/// Descent of one ray.
std::uint64_t traceAlone(
  const CollisionTree& tree, RayPacket& packet, int ray, PacketWorkspace& work)
{
  const BeamFrame& frame = packet.frameOf(ray);
  const Vec3 direction = packet.direction(ray);
  const BeamPlaneMap map(frame);
  const SceneTriangles scene(tree);
  BeamRayVisitor visitor(scene, frame, map);
  Hit hit;
  visitor.setRay(packet.x[ray], packet.y[ray], direction, hit);
  const std::uint64_t nodes = descendRay(
    tree, frame.origin, Vec3(0.0), direction, HitMarginBeam * frame.tanHalf, visitor, work.stack);
  packet.triangle[ray] = hit.triangle;
  return nodes;
}
}

PacketCost tracePacket(const CollisionTree& tree, RayPacket& packet, PacketWorkspace& work,
  const EntryPoints* entryPoints)
{
  PacketCost cost;
  std::fill(packet.triangle, packet.triangle + packet.count, NoTriangle);
  if (tree.empty())
  {
    return cost;
  }
  work.state.packet = &packet;
  PacketSearch search(tree, work.state);
  if ((entryPoints || !tree.other) && search.begin())
  {
    return search.run(entryPoints, work.stack);
  }
  for (int i = 0; i < packet.count; ++i)
  {
    cost.nodes += traceAlone(tree, packet, i, work);
  }
  return cost;
}

void setDirections(RayPacket& packet, PacketView& view)
{
  const int end = padded(packet.count);
  for (int i = packet.count; i < end; ++i)
  {
    packet.x[i] = packet.x[0];
    packet.y[i] = packet.y[0];
    packet.frame[i] = packet.beam ? nullptr : packet.frame[0];
  }
  if (packet.beam)
  {
    roundedLanes(*packet.beam, packet.x, packet.y, end, view);
    return;
  }
  for (int i = 0; i < end; ++i)
  {
    const Vec3 d = packet.frame[i]->direction(packet.x[i], packet.y[i]);
    for (int k = 0; k < 3; ++k)
    {
      view.direction[k][i] = static_cast<float>(d[k]);
    }
  }
}
}
