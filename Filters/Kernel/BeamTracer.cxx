// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTracer.h"

#include "BeamGroup.h"
#include "BeamVolumeTest.h"
#include "RayPacket.h"
#include "TraceVisitors.h"
#include "Traversal.h"
#include "TriangleTest.h"

#include <algorithm>
#include <numeric>
#include <variant>

namespace avianlidar
{
namespace
{
/// Kept between blocks, so that no beam allocates.
struct BlockWorkspace
{
  TraversalStack stack;
  GroupWorkspace group;
  PacketWorkspace packets;
  RayPacket packet;
  std::vector<GroupedBeam> beams;
  std::vector<GroupedBeam> beamsOfFewRays;
  BlockHits found;
  std::vector<Hit> hits; ///< of all beams of a block
  std::size_t used = 0;
  std::vector<std::uint32_t> order; ///< of the rays of a beam: neighbours together
  std::vector<double> x, y;         ///< of the rays of a beam

  /// Where the hits of the next beam go; kept if `used` is moved beyond them.
  Hit* room() { return this->hits.data() + this->used; }

  /// Rays in compact packets. Beams of equally many rays mostly have them in the same strata, so
  /// the order found for one serves all.
  const std::vector<std::uint32_t>& orderOf(const BeamRays& rays)
  {
    if (this->order.size() != rays.size())
    {
      this->order.resize(rays.size());
      std::iota(this->order.begin(), this->order.end(), 0u);
      this->halve(rays, 0, rays.size());
    }
    return this->order;
  }

  /// First ray, in that order, of one of so many packets: whole groups of sixteen, evenly.
  std::size_t beginOf(std::size_t packet, std::size_t packets) const
  {
    const std::size_t groups = (this->order.size() + PacketGroup - 1) / PacketGroup;
    return std::min(this->order.size(), packet * groups / packets * PacketGroup);
  }

private:
  void halve(const BeamRays& rays, std::size_t begin, std::size_t end)
  {
    constexpr std::size_t Width = PacketGroup;
    if (end - begin <= Width)
    {
      return;
    }
    const auto from = this->order.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to = this->order.begin() + static_cast<std::ptrdiff_t>(end);
    const auto extent = [&](const std::vector<double>& v)
    {
      const auto range = std::minmax_element(
        from, to, [&v](std::uint32_t a, std::uint32_t b) { return v[a] < v[b]; });
      return v[*range.second] - v[*range.first];
    };
    const std::vector<double>& v = extent(rays.x) >= extent(rays.y) ? rays.x : rays.y;
    const std::size_t packets = (end - begin + Width - 1) / Width;
    const std::size_t middle = begin + packets / 2 * Width;
    std::nth_element(from, this->order.begin() + static_cast<std::ptrdiff_t>(middle), to,
      [&v](std::uint32_t a, std::uint32_t b) { return v[a] < v[b] || (v[a] == v[b] && a < b); });
    this->halve(rays, begin, middle);
    this->halve(rays, middle, end);
  }
};
}

struct BeamTracer::Workspace
{
  TraversalStack stack;
  BlockWorkspace block;
  std::vector<std::uint32_t> cone; ///< S_potential of the current beam
  bool coneKnown = false;
};

namespace
{
/// Sets of at most this many triangles are searched one by one, larger ones through the tree.
constexpr std::size_t SmallSet = 16;

/// A cone down the tree, folded or not.
template <class Visitor>
std::uint64_t descendCone(
  const CollisionTree& tree, const BeamVolumeTest& probe, Visitor& visitor, TraversalStack& stack)
{
  WideCone cone;
  if (!tree.wide.nodes.empty() && cone.set(tree.wide, probe))
  {
    return descendWide(tree, cone, visitor, stack);
  }
  return std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, stack); },
    tree.volumes());
}

/// One ray down the tree. `origin` is relative to the apex.
template <class Visitor>
std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
  const Vec3& direction, double angularMargin, Visitor& visitor, TraversalStack& stack)
{
  WideRay ray;
  if (!tree.wide.nodes.empty() &&
    ray.set(tree.wide, apex, origin, direction, angularMargin + 2.0 * HitMargin))
  {
    return descendWide(tree, ray, visitor, stack);
  }
  const RayVolumeTest probe(apex, origin, direction, angularMargin);
  return std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, stack); },
    tree.volumes());
}

/// Fewer rays than that do not fill a packet of their own: packets hold rays of several beams.
constexpr std::size_t FewestRaysInPacket = 8;

/// Beams of one apex and width may share a group.
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
  bool tooMany() const { return this->Triangles > 256; }

private:
  const std::uint32_t* Order;
  BeamRoots& Roots;
  std::uint32_t Triangles = 0;
};

/// All beams of a block with one precision.
template <typename Real>
class BlockTrace
{
public:
  BlockTrace(const CollisionTree& tree, const BeamBlock& block, BlockWorkspace& work)
    : Tree(tree)
    , Block(block)
    , Work(work)
  {
  }

  void batch()
  {
    this->Work.beams.clear();
    this->Work.beamsOfFewRays.clear();
    const BeamFrame* before = nullptr;
    for (std::uint32_t b = 0; b < this->Block.size; ++b)
    {
      const BeamFrame& frame = this->Block.frames[b];
      if (before && !together(*before, frame))
      {
        this->groups();
      }
      before = &frame;
      if (this->Block.rays[b] > 0)
      {
        const bool few = this->Block.rays[b] < FewestRaysInPacket;
        (few ? this->Work.beamsOfFewRays : this->Work.beams)
          .push_back({ static_cast<float>(frame.axis.x), static_cast<float>(frame.axis.y),
            static_cast<float>(frame.axis.z), b });
      }
    }
    this->groups();
  }

  void each(std::uint32_t b)
  {
    const BeamFrame& frame = this->Block.frames[b];
    const std::uint32_t count = this->Block.rays[b];
    if (count == 0)
    {
      return;
    }
    const BeamRays& rays = this->Block.source(b);
    Hit* const hits = this->Work.room();
    std::fill(hits, hits + count, Hit());
    const BeamPlaneMap map(frame);
    BeamRayVisitor<Real> visitor(*this->Tree.mesh, frame, map);
    for (std::uint32_t i = 0; i < count; ++i)
    {
      const Vec3 direction = unitDirection(frame.direction(rays.x[i], rays.y[i]));
      visitor.setRay(
        static_cast<Real>(rays.x[i]), static_cast<Real>(rays.y[i]), direction, hits[i]);
      this->counters(b).nodesVisited += descendRay(this->Tree, frame.origin, Vec3(0.0), direction,
        HitMarginBeam * frame.tanHalf, visitor, this->Work.stack);
    }
    if (std::any_of(hits, hits + count, [](const Hit& hit) { return hit.valid(); }))
    {
      this->keep(b, hits, count);
    }
  }

private:
  TraceCounters& counters(std::uint32_t b) { return this->Work.found.counters[b]; }

  void keep(std::uint32_t b, const Hit* hits, std::size_t count)
  {
    this->Work.found.hits[b] = hits;
    this->Work.used += count;
  }

  void groups()
  {
    std::vector<GroupedBeam>& beams = this->Work.beams;
    forEachGroup(beams.data(), beams.size(), ConeLanes::Width,
      [this](GroupedBeam* some, std::size_t count) { this->group(some, count); });
    beams.clear();
    std::vector<GroupedBeam>& few = this->Work.beamsOfFewRays;
    forEachGroup(few.data(), few.size(), RayPacket::Width,
      [this](GroupedBeam* some, std::size_t count) { this->shared(some, count); });
    few.clear();
  }

  /// Packets of the rays of several beams.
  void shared(const GroupedBeam* beams, std::size_t count)
  {
    RayPacket& packet = this->Work.packet;
    packet.beam = nullptr;
    packet.count = 0;
    std::size_t beginOfPacket = this->Work.used;
    for (std::size_t k = 0; k < count; ++k)
    {
      const std::uint32_t b = beams[k].beam;
      const BeamRays& rays = this->Block.source(b);
      this->keep(b, this->Work.room(), rays.size());
      for (std::size_t i = 0; i < rays.size(); ++i)
      {
        packet.frame[packet.count] = &this->Block.frames[b];
        packet.x[packet.count] = rays.x[i];
        packet.y[packet.count] = rays.y[i];
        packet.hit[packet.count++] = Hit();
        if (packet.count == RayPacket::Width)
        {
          this->tracePacket(nullptr, b);
          std::copy(packet.hit, packet.hit + packet.count, &this->Work.hits[beginOfPacket]);
          beginOfPacket += packet.count;
          packet.count = 0;
        }
      }
    }
    if (packet.count > 0)
    {
      this->tracePacket(nullptr, beams[count - 1].beam);
      std::copy(packet.hit, packet.hit + packet.count, &this->Work.hits[beginOfPacket]);
    }
    for (std::size_t k = 0; k < count; ++k)
    {
      const std::uint32_t b = beams[k].beam;
      const Hit* const hits = this->Work.found.hits[b];
      if (std::none_of(
            hits, hits + this->Block.rays[b], [](const Hit& hit) { return hit.valid(); }))
      {
        this->Work.found.hits[b] = nullptr;
      }
    }
  }

  void tracePacket(const BeamRoots* roots, std::uint32_t beam)
  {
    RayPacket& packet = this->Work.packet;
    setDirections(packet);
    const PacketCost cost =
      avianlidar::tracePacket<Real>(this->Tree, packet, this->Work.packets, roots);
    this->counters(beam).nodesVisited += cost.nodes;
    this->counters(beam).candidates += cost.triangles;
  }

  /// One descent for every beam: trees that have no folded form.
  void alone(std::uint32_t b)
  {
    BeamRoots& roots = this->Work.group.roots[0];
    roots.clear();
    LeafVisitor visitor(this->Tree.order, roots);
    const BeamVolumeTest cone(this->Block.frames[b]);
    this->counters(b).nodesVisited += std::visit([&](const auto& volumes)
      { return descend(this->Tree, volumes, cone, visitor, this->Work.stack); },
      this->Tree.volumes());
    if (visitor.tooMany())
    {
      this->each(b);
    }
    else if (!roots.nodes.empty())
    {
      this->packets(b, &roots);
    }
  }

  void group(GroupedBeam* beams, std::size_t count)
  {
    if (this->Tree.wide.nodes.empty())
    {
      for (std::size_t k = 0; k < count; ++k)
      {
        this->alone(beams[k].beam);
      }
      return;
    }
    GroupWorkspace& work = this->Work.group;
    work.cones.count = 0;
    for (std::size_t k = 0; k < count; ++k)
    {
      work.cones.add(this->Block.frames[beams[k].beam]);
    }
    work.cones.close();
    const Vec3& apex = this->Block.frames[beams[0].beam].origin;
    const std::int64_t visited = findRoots(this->Tree.wide, apex, work);
    if (visited < 0 && count > 1)
    {
      // Too far apart to go together.
      forEachGroup(beams, count, (count + 1) / 2,
        [this](GroupedBeam* some, std::size_t size) { this->group(some, size); });
      return;
    }
    const auto share = static_cast<std::uint64_t>(std::max<std::int64_t>(0, visited)) / count;
    for (std::size_t k = 0; k < count; ++k)
    {
      this->counters(beams[k].beam).nodesVisited += share;
      if (visited < 0)
      {
        this->packets(beams[k].beam, nullptr);
      }
      else if (!work.roots[k].nodes.empty())
      {
        this->packets(beams[k].beam, &work.roots[k]);
      }
    }
  }

  void packets(std::uint32_t b, const BeamRoots* roots)
  {
    const BeamRays& rays = this->Block.source(b);
    const std::size_t count = rays.size();
    const std::vector<std::uint32_t>& order = this->Work.orderOf(rays);
    // In the order of the memory first: the rays may come from far.
    this->Work.x.assign(rays.x.begin(), rays.x.end());
    this->Work.y.assign(rays.y.begin(), rays.y.end());
    Hit* const hits = this->Work.room();
    RayPacket& packet = this->Work.packet;
    packet.beam = &this->Block.frames[b];
    std::fill(packet.frame, packet.frame + RayPacket::Width, packet.beam);
    const std::size_t packets = (count + RayPacket::Width - 1) / RayPacket::Width;
    bool any = false;
    for (std::size_t k = 0; k < packets; ++k)
    {
      const std::size_t first = this->Work.beginOf(k, packets);
      packet.count = static_cast<int>(this->Work.beginOf(k + 1, packets) - first);
      for (int i = 0; i < packet.count; ++i)
      {
        packet.x[i] = this->Work.x[order[first + i]];
        packet.y[i] = this->Work.y[order[first + i]];
        packet.hit[i] = Hit();
      }
      this->tracePacket(roots, b);
      for (int i = 0; i < packet.count; ++i)
      {
        hits[order[first + i]] = packet.hit[i];
        any = any || packet.hit[i].valid();
      }
    }
    if (any)
    {
      this->keep(b, hits, count);
    }
  }

  const CollisionTree& Tree;
  const BeamBlock& Block;
  BlockWorkspace& Work;
};

template <typename Real>
void traceAll(const CollisionTree& tree, const BeamBlock& block, bool batch, BlockWorkspace& work)
{
  BlockTrace<Real> trace(tree, block, work);
  if (batch)
  {
    trace.batch();
    return;
  }
  for (std::uint32_t b = 0; b < block.size; ++b)
  {
    trace.each(b);
  }
}
}

BeamTracer::BeamTracer(const CollisionTree& tree, Precision precision)
  : Tree(tree)
  , Arithmetic(precision)
  , Work(std::make_unique<Workspace>())
{
}

BeamTracer::~BeamTracer() = default;

void BeamTracer::setBeam(const BeamFrame& frame)
{
  this->Frame = frame;
  this->Counters = {};
  this->Work->coneKnown = false;
}

void BeamTracer::trace(const BeamRays& rays, bool batch, std::vector<Hit>& hits)
{
  const auto count = static_cast<std::uint32_t>(rays.size());
  const BeamBlock block{ &this->Frame, 1, &count,
    [&rays](std::size_t) -> const BeamRays& { return rays; } };
  const BlockHits& found = this->traceBlock(block, batch);
  if (found.hits[0])
  {
    hits.assign(found.hits[0], found.hits[0] + count);
  }
  else
  {
    hits.assign(count, Hit());
  }
  const TraceCounters& now = found.counters[0];
  this->Counters.nodesVisited += now.nodesVisited;
  this->Counters.raysTraced += now.raysTraced;
  this->Counters.candidates = std::max(this->Counters.candidates, now.candidates);
}

const BlockHits& BeamTracer::traceBlock(const BeamBlock& block, bool batch)
{
  BlockWorkspace& work = this->Work->block;
  work.found.hits.assign(block.size, nullptr);
  work.found.counters.assign(block.size, TraceCounters());
  std::size_t rays = 0;
  for (std::size_t b = 0; b < block.size; ++b)
  {
    work.found.counters[b].raysTraced = block.rays[b];
    rays += block.rays[b];
  }
  work.hits.resize(std::max(work.hits.size(), rays));
  work.used = 0;
  if (this->Tree.nodes.empty())
  {
    return work.found;
  }
  if (this->Arithmetic == Precision::Single)
  {
    traceAll<float>(this->Tree, block, batch, work);
  }
  else
  {
    traceAll<double>(this->Tree, block, batch, work);
  }
  return work.found;
}

Hit BeamTracer::traceFromApex(const Vec3& direction, bool coneOnly)
{
  return this->traceFrom(Vec3(0.0), direction, 0.0, NoTriangle, coneOnly);
}

Hit BeamTracer::traceFrom(const Vec3& origin, const Vec3& direction, double minimumRange,
  std::uint32_t ignore, bool coneOnly, double maximumRange)
{
  const Vec3 d = unitDirection(direction);
  // From the apex the ranges must have the bits that trace() gives them.
  const double margin = origin == Vec3(0.0) ? beamRayMargin(this->Frame) : 0.0;
  FreeRayVisitor visitor(*this->Tree.mesh, this->Frame.origin, origin, d, margin);
  visitor.minimum = minimumRange;
  visitor.maximum = maximumRange;
  visitor.ignore1 = ignore;
  this->search(visitor, origin, d, margin, coneOnly);
  return visitor.nearest;
}

bool BeamTracer::occluded(const Vec3& from, const Vec3& to, double margin, std::uint32_t ignore1,
  std::uint32_t ignore2, bool coneOnly)
{
  const Vec3 between = to - from;
  const double length = safeLength(between);
  if (!(length > 2.0 * margin))
  {
    return false;
  }
  const Vec3 d = unitDirection(between);
  FreeRayVisitor visitor(*this->Tree.mesh, this->Frame.origin, from, d, 0.0);
  visitor.minimum = margin;
  visitor.maximum = length - margin;
  visitor.ignore1 = ignore1;
  visitor.ignore2 = ignore2;
  visitor.anyHit = true;
  this->search(visitor, from, d, 0.0, coneOnly);
  return visitor.nearest.valid();
}

template <class Visitor>
void BeamTracer::search(
  Visitor& visitor, const Vec3& origin, const Vec3& d, double margin, bool coneOnly)
{
  ++this->Counters.raysTraced;
  if (this->Tree.nodes.empty())
  {
    return;
  }
  const std::vector<std::uint32_t>& set = this->Work->cone;
  if (coneOnly && this->Work->coneKnown && set.size() <= SmallSet)
  {
    visitor.leaf(set.data(), static_cast<std::uint32_t>(set.size()));
    return;
  }
  this->Counters.nodesVisited +=
    descendRay(this->Tree, this->Frame.origin, origin, d, margin, visitor, this->Work->stack);
}

const std::vector<std::uint32_t>& BeamTracer::coneTriangles()
{
  Workspace& work = *this->Work;
  if (!work.coneKnown)
  {
    work.cone.clear();
    if (!this->Tree.nodes.empty())
    {
      ConeVisitor visitor(work.cone);
      this->Counters.nodesVisited +=
        descendCone(this->Tree, BeamVolumeTest(this->Frame), visitor, work.stack);
    }
    this->Counters.candidates =
      std::max<std::uint64_t>(this->Counters.candidates, work.cone.size());
    work.coneKnown = true;
  }
  return work.cone;
}

SeenTriangle seeTriangle(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin)
{
  SeenTriangle seen;
  seen.corners = cornersFrom(mesh, triangle, origin);
  seen.plane = planeOf(seen.corners);
  if (seen.plane.normal != Vec3(0.0))
  {
    seen.normal = (seen.plane.height > 0.0 ? -1.0 : 1.0) * unitDirection(seen.plane.normal);
  }
  return seen;
}

LocalTriangle localTriangle(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin)
{
  const SeenTriangle seen = seeTriangle(mesh, triangle, origin);
  return { seen.corners.a, seen.corners.b, seen.corners.c, seen.normal };
}

double rangeOnTriangle(const SeenTriangle& triangle, const BeamFrame& frame, const Vec3& d)
{
  const double range = rangeOf(triangle.corners, triangle.plane, d, beamRayMargin(frame));
  return range > 0.0 ? range : triangle.plane.height / glm::dot(triangle.plane.normal, d);
}

double rangeOnTriangle(
  const TriangleMesh& mesh, std::uint32_t triangle, const BeamFrame& frame, double x, double y)
{
  return rangeOnTriangle(
    seeTriangle(mesh, triangle, frame.origin), frame, unitDirection(frame.direction(x, y)));
}
}
