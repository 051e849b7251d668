// SPDX-License-Identifier: BSD-3-Clause
#include "BlockTrace.h"

#include "Descents.h"
#include "TraceVisitors.h"

#include <algorithm>
#include <limits>
#include <numeric>

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
        this->rayByRay(b);
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
  TraceCounters& counters(std::uint32_t b) { return this->Work.found.counters[b]; }

  /// Where the hits of the next beam go, and that they are to stay there.
  Hit* room() { return this->Work.hits.data() + this->Work.used; }
  void keep(std::uint32_t b, std::size_t count)
  {
    this->Work.found.hits[b] = this->room();
    this->Work.used += count;
  }

  /// Triangles of the cone for the survey.
  class SurveyVisitor
  {
  public:
    explicit SurveyVisitor(BeamSurvey& survey)
      : Survey(survey)
    {
    }
    double limit() const { return std::numeric_limits<double>::infinity(); }
    bool leaf(const std::uint32_t* triangles, std::uint32_t count)
    {
      return this->Survey.leaf(triangles, count);
    }

  private:
    BeamSurvey& Survey;
  };

  /// After some rays of a beam, which hit these triangles; or before all if a plane fills the beam
  /// before, its neighbour. @param roots null: those of the tree
  /// @return true if the beam needs no rays
  bool survey(
    std::uint32_t b, const BeamRoots* roots, const std::uint32_t* triangles, std::size_t count)
  {
    BeamSurvey* const survey = this->Block.survey;
    this->FilledBefore = false;
    if (!survey || !survey->begin(b, triangles, count))
    {
      return false;
    }
    TraceCounters& counters = this->counters(b);
    SurveyVisitor visitor(*survey);
    const BeamVolumeTest probe(this->Block.frames[b]);
    WideCone cone;
    if (roots && !this->Tree.wide.nodes.empty() && cone.set(this->Tree.wide, probe))
    {
      counters.nodesVisited += this->surveyRoots(*roots, cone, visitor);
    }
    else
    {
      counters.nodesVisited += descendCone(this->Tree, probe, visitor, this->Work.stack);
    }
    if (!survey->end())
    {
      return false;
    }
    counters.raysTraced = 0;
    this->FilledBefore = true;
    return true;
  }

  /// @return number of boxes tested
  std::uint64_t surveyRoots(const BeamRoots& roots, const WideCone& cone, SurveyVisitor& visitor)
  {
    const CollisionTree& tree = this->Tree;
    std::uint64_t visited = 0;
    std::vector<std::uint32_t>& inner = this->Work.nodes;
    inner.clear();
    // @return false if the survey is at its end
    const auto open = [&](const WideNode& node)
    {
      alignas(64) float nearest[WideNode::Width];
      cone.distances(node, nearest);
      visited += WideNode::Width;
      for (int i = 0; i < WideNode::Width; ++i)
      {
        if (node.first[i] == NoChild || !(nearest[i] < std::numeric_limits<float>::infinity()))
        {
          continue;
        }
        if (node.count[i] == 0)
        {
          inner.push_back(node.first[i]);
        }
        else if (!visitor.leaf(tree.order.data() + node.first[i], node.count[i]))
        {
          return false;
        }
      }
      return true;
    };
    bool more = true;
    for (std::size_t k = 0; more && k < roots.nodes.size(); ++k)
    {
      more = open(roots.nodes[k]);
    }
    while (more && !inner.empty())
    {
      const std::uint32_t node = inner.back();
      inner.pop_back();
      more = open(tree.wide.nodes[node]);
    }
    return visited;
  }

  void rayByRay(std::uint32_t b)
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
      visitor.setRay(
        static_cast<Real>(rays.x[i]), static_cast<Real>(rays.y[i]), direction, hits[i]);
      this->counters(b).nodesVisited += descendRay(this->Tree, frame.origin, Vec3(0.0), direction,
        HitMarginBeam * frame.tanHalf, visitor, this->Work.stack);
      any = any || hits[i].valid();
      if (i + 1 == few && any)
      {
        std::transform(
          hits, hits + few, this->Work.met, [](const Hit& hit) { return hit.triangle; });
        if (this->survey(b, nullptr, this->Work.met, few))
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

  /// Neighbouring beams.
  struct Cluster
  {
    const std::uint32_t* beams;
    std::size_t count;
  };

  /// Packets of beams as they come, which in a scan are neighbours: with so few rays that is
  /// cheaper than to look who else is near.
  void consecutive()
  {
    const std::vector<std::uint32_t>& beams = this->Work.beams;
    for (std::size_t first = 0; first < beams.size(); first += this->BeamsOfPacket)
    {
      this->packets(
        { &beams[first], std::min(this->BeamsOfPacket, beams.size() - first) }, nullptr);
    }
  }

  void group(const Cluster& all)
  {
    Cluster clusters[ConeLanes::Width];
    ConeLanes& cones = this->Work.group.cones;
    cones.count = 0;
    for (std::size_t first = 0; first < all.count; first += this->BeamsOfPacket)
    {
      Cluster& cluster = clusters[cones.count];
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
      this->counters(all.beams[k]).nodesVisited += share;
    }
    for (int k = 0; k < number; ++k)
    {
      const BeamRoots& roots = this->Work.group.roots[k];
      if (!roots.nodes.empty())
      {
        this->packets(clusters[k], &roots);
      }
    }
  }

  /// A group whose beams lie too far apart to go together.
  void apart(const Cluster& all, int clusters)
  {
    if (clusters == 1)
    {
      this->packets(all, nullptr);
      return;
    }
    const std::size_t half = static_cast<std::size_t>(clusters / 2) * this->BeamsOfPacket;
    this->group({ all.beams, half });
    this->group({ all.beams + half, all.count - half });
  }

  void withoutRoots(const Cluster& cluster)
  {
    if (!this->Tree.wide.nodes.empty() || cluster.count > 1)
    {
      this->packets(cluster, nullptr);
      return;
    }
    const std::uint32_t b = cluster.beams[0];
    BeamRoots& roots = this->Work.group.roots[0];
    roots.clear();
    LeafVisitor visitor(this->Tree.order, roots);
    const BeamVolumeTest cone(this->Block.frames[b]);
    this->counters(b).nodesVisited += std::visit([&](const auto& volumes)
      { return descend(this->Tree, volumes, cone, visitor, this->Work.stack); },
      this->Tree.volumes());
    if (visitor.tooMany())
    {
      this->rayByRay(b);
    }
    else if (!roots.nodes.empty())
    {
      this->packets(cluster, &roots);
    }
  }

  void packets(const Cluster& cluster, const BeamRoots* roots)
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

  void packetsOfBeam(std::uint32_t b, const BeamRoots* roots)
  {
    if (this->FilledBefore && this->survey(b, roots, nullptr, 0))
    {
      return;
    }
    const BeamRays& rays = this->Block.source(b);
    const std::size_t count = rays.size();
    const std::vector<std::uint32_t>& order = this->Work.orderOf(rays);
    Hit* const hits = this->room();
    RayPacket& packet = this->Work.packet;
    packet.beam = &this->Block.frames[b];
    bool any = false;
    // Whole groups of sixteen, evenly.
    const std::size_t packets = (count + RayPacket::Width - 1) / RayPacket::Width;
    const std::size_t groups = (count + PacketGroup - 1) / PacketGroup;
    std::size_t first = 0;
    for (std::size_t k = 1; k <= packets; ++k)
    {
      const std::size_t end = std::min(count, k * groups / packets * PacketGroup);
      packet.count = static_cast<int>(end - first);
      for (int i = 0; i < packet.count; ++i)
      {
        packet.x[i] = rays.x[order[first + i]];
        packet.y[i] = rays.y[order[first + i]];
      }
      this->trace(roots, b);
      for (int i = 0; i < packet.count; ++i)
      {
        hits[order[first + i]] = packet.hit(i);
        any |= packet.hit(i).valid();
      }
      if (k <= PacketsBeforeSurvey)
      {
        std::copy(packet.triangle, packet.triangle + packet.count, this->Work.met + first);
      }
      if (any && k == std::min(packets, PacketsBeforeSurvey) &&
        this->survey(b, roots, this->Work.met, end))
      {
        return;
      }
      first = end;
    }
    if (any)
    {
      this->keep(b, count);
    }
  }

  /// Beams of few rays, which fit into one packet.
  void packetOfBeams(const Cluster& cluster, const BeamRoots* roots)
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
      if (any && !this->survey(b, roots, packet.triangle + first, rays))
      {
        this->keep(b, rays);
      }
      first += count;
    }
  }

  /// @param beam that bears the cost
  void trace(const BeamRoots* roots, std::uint32_t beam)
  {
    RayPacket& packet = this->Work.packet;
    const PacketCost cost = tracePacket<Real>(this->Tree, packet, this->Work.packets, roots);
    this->counters(beam).nodesVisited += cost.nodes;
    this->counters(beam).candidates += cost.triangles;
  }

  const CollisionTree& Tree;
  const BeamBlock& Block;
  TraceMode Mode;
  BlockWorkspace& Work;
  std::size_t BeamsOfPacket = 1;
  bool FilledBefore = false; ///< a plane fills the beam that was surveyed last
};

void halve(const BeamRays& rays, std::uint32_t* begin, std::uint32_t* end)
{
  const auto count = static_cast<std::size_t>(end - begin);
  if (count <= PacketGroup)
  {
    return;
  }
  const auto extent = [&](const std::vector<double>& v)
  {
    const auto range = std::minmax_element(
      begin, end, [&v](std::uint32_t a, std::uint32_t b) { return v[a] < v[b]; });
    return v[*range.second] - v[*range.first];
  };
  const std::vector<double>& v = extent(rays.x) >= extent(rays.y) ? rays.x : rays.y;
  const std::size_t groups = (count + PacketGroup - 1) / PacketGroup;
  std::uint32_t* const middle = begin + groups / 2 * PacketGroup;
  std::nth_element(begin, middle, end,
    [&v](std::uint32_t a, std::uint32_t b) { return v[a] < v[b] || (v[a] == v[b] && a < b); });
  halve(rays, begin, middle);
  halve(rays, middle, end);
}
}

const std::vector<std::uint32_t>& BlockWorkspace::orderOf(const BeamRays& rays)
{
  // With a target error, beams take turns of some dozen numbers.
  constexpr std::size_t most = 64;
  if (this->orders.size() > most)
  {
    this->orders.clear();
  }
  std::vector<std::uint32_t>& order = this->orders[rays.size()];
  if (order.empty())
  {
    order.resize(rays.size());
    std::iota(order.begin(), order.end(), 0u);
    halve(rays, order.data(), order.data() + order.size());
  }
  return order;
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
