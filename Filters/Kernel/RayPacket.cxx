// SPDX-License-Identifier: BSD-3-Clause
#include "RayPacket.h"

#include "RangeLanes.h"
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

  /// Exact ranges of the rays whose nearest triangle is known and nothing else.
  void settle() { this->settle(this->State.unsettled); }

private:
  /// The same for some of them.
  void settle(RayBits left)
  {
    PacketState& s = this->State;
    s.unsettled &= ~left;
    this->findUnitDirections(left);
    // Mostly a few triangles have most of the rays; where many have one each, all go together.
    constexpr int FewTriangles = 6;
    for (int n = 0; n < FewTriangles && left != 0; ++n)
    {
      left &= ~this->settleTriangle(s.best.triangle[__builtin_ctzll(left)], left);
    }
    this->settleRays(left);
  }

  const Vec3& apex() const { return this->Packet.frameOf(0).origin; }

  /// Of at least these rays.
  void findUnitDirections(RayBits rays)
  {
    PacketState& s = this->State;
    RayBits left = rays & ~s.unitKnown;
    for (int begin = 0; left != 0; begin += PacketGroup, left >>= PacketGroup)
    {
      if ((left & 0xffffu) != 0)
      {
        unitDirections(this->Packet, begin, s.unit);
        s.unitKnown |= RayBits(0xffffu) << begin;
      }
    }
  }

  /// @return the rays of `left` that hit the triangle; their ranges are found
  RayBits settleTriangle(std::uint32_t triangle, RayBits left)
  {
    return this->rangesOn(
      triangle, left, this->State.best.triangle, this->Packet.triangle, this->Packet.range);
  }

  /// Ranges of the rays of `left` whose `owner` is the triangle, if the plane's range stands.
  /// @return these rays
  RayBits rangesOn(std::uint32_t triangle, RayBits left, const std::uint32_t* owner,
    std::uint32_t* hit, double* range)
  {
    PacketState& s = this->State;
    const auto& [number, corners, plane] = s.exact[triangle];
    const BeamFrame* const beam = this->Packet.beam;
    const PlaneView view =
      beam ? viewOfCone(plane, beam->axis, beam->sinHalf, beam->cosHalf) : PlaneView::Any;
    RayBits all = 0;
    for (int begin = 0; begin < this->Packet.count; begin += PacketGroup)
    {
      const auto rays = static_cast<std::uint32_t>(left >> begin & 0xffffu);
      if (rays != 0)
      {
        all |= static_cast<RayBits>(planeHits(view, corners, plane, rays, owner + begin, number,
                 s.unit.x + begin, s.unit.y + begin, s.unit.z + begin, hit + begin, range + begin))
          << begin;
      }
    }
    return all;
  }

  /// Rays that surely hit the triangle about as far away as what they hit before: which is nearer?
  /// @return those whose nearest hit has changed
  RayBits compareLevel(RayBits rays, std::uint32_t triangle)
  {
    PacketState& s = this->State;
    this->settle(rays & s.unsettled);
    this->findUnitDirections(rays);
    alignas(64) std::uint32_t hit[Width];
    alignas(64) double range[Width];
    std::fill(hit, hit + Width, triangle);
    this->rangesOn(triangle, rays, hit, hit, range);
    RayBits changed = 0;
    for (RayBits rest = rays; rest != 0; rest &= rest - 1)
    {
      const int ray = __builtin_ctzll(rest);
      Hit nearest = this->Packet.hit(ray);
      keepNearest(nearest, range[ray], triangle);
      if (nearest.triangle == triangle && range[ray] > 0.0)
      {
        this->Packet.setHit(ray, nearest);
        this->setBest(ray);
        changed |= RayBits(1) << ray;
      }
    }
    return changed;
  }

  void settleRays(RayBits rays)
  {
    if (rays == 0)
    {
      return;
    }
    PacketState& s = this->State;
    for (RayBits rest = rays; rest != 0; rest &= rest - 1)
    {
      const int ray = __builtin_ctzll(rest);
      for (int c = 0; c < 3; ++c)
      {
        const Vec3 p = this->Mesh.corner(s.best.triangle[ray], c) - this->apex();
        s.winners.corner[c][0][ray] = p.x;
        s.winners.corner[c][1][ray] = p.y;
        s.winners.corner[c][2][ray] = p.z;
      }
    }
    alignas(64) double range[Width];
    rangesOnTriangles(s.winners, padded(this->Packet.count), s.unit.x, s.unit.y, s.unit.z, range);
    for (RayBits rest = rays; rest != 0; rest &= rest - 1)
    {
      const int ray = __builtin_ctzll(rest);
      this->Packet.setHit(ray, { s.best.triangle[ray], range[ray] });
    }
  }

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
        changed |= this->compareLevel(s.triangles.level[k], s.triangles.seen[k]->number);
      }
      if (s.triangles.unsure[k] != 0)
      {
        changed |= this->decide(s.triangles.unsure[k], s.triangles.seen[k]->number);
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

  /// Best of a ray whose nearest hit is known exactly, or that has none.
  void setBest(int ray)
  {
    PacketState& s = this->State;
    const Hit hit = this->Packet.hit(ray);
    const Vec3 d = this->Packet.frameOf(ray).direction(this->Packet.x[ray], this->Packet.y[ray]);
    const auto inverse = static_cast<float>(std::sqrt(glm::dot(d, d)) / hit.range);
    constexpr float Rounding = 4.0f * static_cast<float>(RoundOffSingle);
    s.best.low[ray] = inverse * (1.0f - Rounding);
    s.best.high[ray] = inverse * (1.0f + Rounding);
    s.best.triangle[ray] = hit.triangle;
  }

  double exactRange(int ray, std::uint32_t triangle)
  {
    const ExactTriangles::Triangle& t = this->State.exact[triangle];
    return rangeOf(
      t.corners, t.plane, this->Packet.direction(ray), beamRayMargin(this->Packet.frameOf(ray)));
  }

  /// The exact functions for one triangle and the rays that it may be the nearest hit of.
  /// @return rays that hit it
  RayBits decide(RayBits rays, std::uint32_t triangle)
  {
    BeamTriangle<Real> seen;
    const BeamFrame* frame = nullptr;
    RayBits hits = 0;
    for (RayBits rest = rays; rest != 0; rest &= rest - 1)
    {
      const int ray = __builtin_ctzll(rest);
      if (&this->Packet.frameOf(ray) != frame)
      {
        frame = &this->Packet.frameOf(ray);
        const ExactTriangles::Triangle& t = this->State.exact[triangle];
        if (!seen.set(BeamPlaneMap(*frame), t.corners, t.plane.sides))
        {
          break;
        }
      }
      if (seen.accepts(
            static_cast<Real>(this->Packet.x[ray]), static_cast<Real>(this->Packet.y[ray])) &&
        this->decideRange(ray, triangle))
      {
        hits |= RayBits(1) << ray;
      }
    }
    return hits;
  }

  /// A ray whose edge functions were accepted; false if it does not hit the triangle.
  bool decideRange(int ray, std::uint32_t triangle)
  {
    const double range = this->exactRange(ray, triangle);
    if (!(range > 0.0))
    {
      return false;
    }
    PacketState& s = this->State;
    Hit hit = this->Packet.hit(ray);
    const RayBits bit = RayBits(1) << ray;
    if (s.unsettled & bit)
    {
      const std::uint32_t known = s.best.triangle[ray];
      hit = { known, this->exactRange(ray, known) };
      s.unsettled &= ~bit;
    }
    keepNearest(hit, range, triangle);
    this->Packet.setHit(ray, hit);
    this->setBest(ray);
    return true;
  }

  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  PacketState& State;
  RayPacket& Packet;
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
    search.settle();
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
