// SPDX-License-Identifier: BSD-3-Clause
#include "RayPacket.h"

#include "PacketRanges.h"
#include "RayPacketBoxes.h"
#include "RayPacketTriangles.h"
#include "TraceVisitors.h"
#include "TriangleTest.h"

#include <algorithm>
#include <limits>
#include <variant>

namespace avianlidar
{
namespace
{
constexpr int Width = RayPacket::Width;
constexpr int Children = WideNode::Width;
constexpr float Infinity = std::numeric_limits<float>::infinity();
using Entry = PacketState::Entry;

/// Set in Entry::node: a node of the roots, not of the tree.
constexpr std::uint32_t FromRoots = 0x80000000u;

/// Ask for memory that is needed soon.
inline void prefetch(const void* address)
{
#if defined(__GNUC__)
  __builtin_prefetch(address);
#else
  static_cast<void>(address);
#endif
}

/// One packet down the folded tree.
template <typename Real>
class PacketSearch
{
public:
  PacketSearch(const CollisionTree& tree, PacketState& state)
    : Tree(tree)
    , Mesh(*tree.mesh)
    , State(state)
    , Packet(*state.packet)
    , Ranges(*tree.mesh, state)
  {
  }

  /// False if the rays lie too far apart, or the apex too far away.
  bool begin(const BeamRoots* roots)
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
    const Vec3 offset = widest->origin - this->Tree.wide.reference;
    s.view.apex[0] = static_cast<float>(offset.x);
    s.view.apex[1] = static_cast<float>(offset.y);
    s.view.apex[2] = static_cast<float>(offset.z);
    s.view.spread = static_cast<float>(HitMarginBeam * widest->tanHalf + 2.0 * HitMargin);
    const double longest = 1.0 / widest->cosHalf;
    if (!wideningFor(this->Tree.wide, offset, s.view.widening) ||
      !s.view.set(this->Packet.count, longest))
    {
      return false;
    }
    const std::size_t beginnings = roots ? roots->nodes.size() : 1;
    s.entries.resize(
      std::max<std::size_t>(s.entries.size(), Children * (this->Tree.wide.depth + 2) + beginnings));
    s.top = s.entries.data();
    const RayBits all = ~RayBits(0) >> (64 - this->Packet.count);
    if (roots)
    {
      s.roots = roots->nodes.data();
      const auto shortest = static_cast<float>((1.0 - 1e-6) / longest);
      for (std::size_t k = beginnings; k > 0; --k)
      {
        *s.top++ = { FromRoots | static_cast<std::uint32_t>(k - 1), 0, all,
          roots->nearest[k - 1] * shortest };
      }
    }
    else
    {
      *s.top++ = { 0, 0, all, 0.0f };
    }
    s.exact.begin(this->Mesh, widest->origin);
    s.known.begin(this->Tree, *widest);
    s.filled = 0;
    s.missing = 0;
    s.unsettled = 0;
    s.unitKnown = 0;
    s.farthest = Infinity;
    this->beginBest();
    return true;
  }

  PacketCost run()
  {
    PacketState& s = this->State;
    PacketCost cost;
    Entry* const bottom = s.entries.data();
    while (s.top != bottom)
    {
      const Entry entry = *--s.top;
      if (entry.nearest > s.farthest)
      {
        continue;
      }
      if (entry.count > 0)
      {
        ++s.top;
        this->takeLeaves();
        cost.triangles += static_cast<std::uint64_t>(s.filled);
        this->test();
      }
      else
      {
        this->open(entry);
        cost.nodes += Children;
      }
    }
    return cost;
  }

private:
  /// Children of a node that some of the rays meet, the nearest on top.
  void open(const Entry& entry)
  {
    PacketState& s = this->State;
    const WideNode& node =
      entry.node & FromRoots ? s.roots[entry.node & ~FromRoots] : this->Tree.wide.nodes[entry.node];
    PacketChild children[Children];
    const int count = meetChildren(s.view, node, entry.rays, children);
    Entry* const first = s.top;
    for (int i = 0; i < count; ++i)
    {
      const PacketChild& child = children[i];
      Entry* place = s.top++;
      while (place != first && place[-1].nearest < child.nearest)
      {
        *place = place[-1];
        --place;
      }
      *place = { node.first[child.lane], node.count[child.lane], child.rays, child.nearest };
      this->askFor(*place);
    }
  }

  /// Memory that the entry needs: nodes, and corners of a leaf's triangles.
  void askFor(const Entry& entry) const
  {
    if (entry.count > 0)
    {
      const std::uint32_t most = std::min<std::uint32_t>(entry.count, PacketTriangles::Width);
      for (std::uint32_t k = entry.node; k < entry.node + most; ++k)
      {
        if (!this->State.known.find(k))
        {
          for (const std::uint32_t point : this->Tree.leafTriangles[k].corners)
          {
            prefetch(&this->Mesh.points[point]);
          }
        }
      }
      return;
    }
    const auto* node = reinterpret_cast<const char*>(&this->Tree.wide.nodes[entry.node]);
    for (std::size_t line = 0; line < sizeof(WideNode); line += 64)
    {
      prefetch(node + line);
    }
  }

  /// Triangles of the leaves on top, as many as are tested at once.
  void takeLeaves()
  {
    PacketState& s = this->State;
    const Entry* const bottom = s.entries.data();
    while (s.top != bottom && s.top[-1].count > 0 && s.filled < PacketTriangles::Width)
    {
      Entry& leaf = s.top[-1];
      if (leaf.nearest <= s.farthest)
      {
        const auto room = static_cast<std::uint32_t>(PacketTriangles::Width - s.filled);
        const std::uint32_t taken = std::min(room, leaf.count);
        for (std::uint32_t k = 0; k < taken; ++k)
        {
          this->take(leaf.node + k, leaf.rays);
        }
        leaf.node += taken;
        leaf.count -= taken;
        if (leaf.count > 0)
        {
          return;
        }
      }
      --s.top;
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
    if (s.missing > 0)
    {
      s.known.see(s.positions, s.missing, s.fresh);
    }
    bool undecided = false;
    RayBits changed = testTriangles(s.view, s.filled, s.triangles, s.best, undecided);
    s.unsettled |= changed;
    for (int k = 0; undecided && k < s.filled; ++k)
    {
      if (s.triangles.level[k] != 0)
      {
        changed |= this->Ranges.compareLevel(s.triangles.level[k], s.triangles.seen[k]->number);
      }
      if (s.triangles.unsure[k] != 0)
      {
        changed |= this->Ranges.decide(s.triangles.unsure[k], s.triangles.seen[k]->number);
      }
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
    std::fill(s.best.low, s.best.low + count, 0.0f);
    std::fill(s.best.high, s.best.high + count, 0.0f);
    std::fill(s.best.low + count, s.best.low + end, Infinity); // nothing is nearer than padding
    std::fill(s.best.high + count, s.best.high + end, Infinity);
  }

  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  PacketState& State;
  RayPacket& Packet;
  PacketRanges<Real> Ranges;
};

/// One ray down the tree as it stands, folded or not.
template <typename Real>
std::uint64_t traceAlone(
  const CollisionTree& tree, RayPacket& packet, int ray, PacketWorkspace& work)
{
  const BeamFrame& frame = packet.frameOf(ray);
  const Vec3 direction = packet.direction(ray);
  const BeamPlaneMap map(frame);
  BeamRayVisitor<Real> visitor(*tree.mesh, frame, map);
  Hit hit = packet.hit(ray);
  visitor.setRay(
    static_cast<Real>(packet.x[ray]), static_cast<Real>(packet.y[ray]), direction, hit);
  const double margin = HitMarginBeam * frame.tanHalf;
  WideRay query;
  if (!tree.wide.nodes.empty() &&
    query.set(tree.wide, frame.origin, Vec3(0.0), direction, margin + 2.0 * HitMargin))
  {
    const std::uint64_t nodes = descendWide(tree, query, visitor, work.stack);
    packet.setHit(ray, hit);
    return nodes;
  }
  const RayVolumeTest probe(frame.origin, Vec3(0.0), direction, margin);
  const std::uint64_t nodes = std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, work.stack); },
    tree.volumes());
  packet.setHit(ray, hit);
  return nodes;
}
}

template <typename Real>
PacketCost tracePacket(
  const CollisionTree& tree, RayPacket& packet, PacketWorkspace& work, const BeamRoots* roots)
{
  PacketCost cost;
  std::fill(packet.triangle, packet.triangle + packet.count, NoTriangle);
  std::fill(packet.range, packet.range + packet.count, Hit().range);
  if (tree.nodes.empty())
  {
    return cost;
  }
  work.state.packet = &packet;
  PacketSearch<Real> search(tree, work.state);
  if ((roots || !tree.wide.nodes.empty()) && search.begin(roots))
  {
    cost = search.run();
    PacketRanges<Real>(*tree.mesh, work.state).settle();
    return cost;
  }
  for (int i = 0; i < packet.count; ++i)
  {
    cost.nodes += traceAlone<Real>(tree, packet, i, work);
  }
  return cost;
}

template PacketCost tracePacket<float>(
  const CollisionTree&, RayPacket&, PacketWorkspace&, const BeamRoots*);
template PacketCost tracePacket<double>(
  const CollisionTree&, RayPacket&, PacketWorkspace&, const BeamRoots*);
}
