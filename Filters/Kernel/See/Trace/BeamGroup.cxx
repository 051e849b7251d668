// SPDX-License-Identifier: BSD-3-Clause
#include "BeamGroup.h"

#include "Descents.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Largest half diagonal of a box that is an entry point, in half-beamwidths.
constexpr double EntryPointSize = 16.0;

/// Largest number of clusters of beams that meet a box that is an entry point. Packets, unlike
/// groups, end at their nearest hits.
constexpr int FewBeams = 3;

/// Spread 16 bits to every other bit of 32.
std::uint32_t spread(std::uint32_t v)
{
  v = (v | v << 8) & 0x00ff00ffu;
  v = (v | v << 4) & 0x0f0f0f0fu;
  v = (v | v << 2) & 0x33333333u;
  return (v | v << 1) & 0x55555555u;
}

/// Descent of a group. The members of an entry are clusters of beams.
class EntryPointSearch : public WidePolicy
{
public:
  EntryPointSearch(const WideTree& tree, GroupWorkspace& work)
    : Tree(tree)
    , Work(work)
    , EntryPointExtent(static_cast<float>(EntryPointSize * work.cones.widest))
  {
  }

  float limit() const { return FloatInfinity; }

  template <class Push>
  void open(const WideNode& node, std::uint64_t beams, Push push)
  {
    ConeChild children[WideNode::Width];
    const int count =
      meetChildren(this->Work.cones, node, static_cast<std::uint32_t>(beams), children);
    for (const ConeChild* child = children; child < children + count; ++child)
    {
      const bool entryPoint = node.count[child->lane] > 0 ||
        child->size <= this->EntryPointExtent || __builtin_popcount(child->cones) <= FewBeams;
      push(child->lane, child->cones | (entryPoint ? IsEntryPoint : 0), child->nearest);
    }
  }

  static bool isEnd(const DescentEntry& entry) { return (entry.members & IsEntryPoint) != 0; }

  bool end(const DescentEntry& entry)
  {
    const WideNode& parent = this->Tree.nodes[entry.parent];
    for (std::uint64_t left = entry.members & ~IsEntryPoint; left != 0; left &= left - 1)
    {
      this->Work.entryPoints[__builtin_ctzll(left)].add(
        parent, static_cast<int>(entry.lane), static_cast<float>(entry.nearest));
    }
    return true;
  }

private:
  /// Bit among the members of an entry whose box is an entry point.
  static constexpr std::uint64_t IsEntryPoint = std::uint64_t{ 1 } << 63;

  const WideTree& Tree;
  GroupWorkspace& Work;
  float EntryPointExtent;
};

/// Makes entry points of leaves, until the entry points hold too many triangles.
class LeafVisitor
{
public:
  LeafVisitor(const std::vector<std::uint32_t>& order, std::size_t most, EntryPoints& entryPoints)
    : Order(order.data())
    , Most(most)
    , Points(entryPoints)
  {
  }
  std::size_t triangles = 0;
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t* first, std::uint32_t count)
  {
    this->triangles += count;
    this->Points.addLeaf(static_cast<std::uint32_t>(first - this->Order), count);
    return this->triangles <= this->Most;
  }

private:
  const std::uint32_t* Order;
  std::size_t Most;
  EntryPoints& Points;
};

/// Find the entry points of the beams in `work.cones`. @return number of boxes tested; -1 if the
/// beams lie too far apart
std::int64_t findEntryPoints(const WideTree& tree, const Vec3& apex, GroupWorkspace& work)
{
  for (int b = 0; b < work.cones.count; ++b)
  {
    work.entryPoints[b].clear();
  }
  if (!work.cones.setFrustum(tree, apex))
  {
    return -1;
  }
  EntryPointSearch search(tree, work);
  const DescentStart start{ nullptr, (1u << work.cones.count) - 1u };
  return static_cast<std::int64_t>(descendWide(tree, start, search, work.stack));
}
}

void orderBeams(
  const BeamFrame* frames, std::vector<std::uint32_t>& beams, std::vector<std::uint64_t>& keys)
{
  if (beams.empty())
  {
    return;
  }
  Vec3 lower = frames[beams[0]].axis;
  Vec3 upper = lower;
  for (const std::uint32_t b : beams)
  {
    lower = glm::min(lower, frames[b].axis);
    upper = glm::max(upper, frames[b].axis);
  }
  const Vec3 extent = upper - lower;
  const int least =
    extent.x < extent.y ? (extent.x < extent.z ? 0 : 2) : (extent.y < extent.z ? 1 : 2);
  const int u = (least + 1) % 3;
  const int v = (least + 2) % 3;
  const double scale = 65535.0 / std::max({ extent[u], extent[v], 1e-30 });
  keys.clear();
  for (const std::uint32_t b : beams)
  {
    const Vec3 place = scale * (frames[b].axis - lower);
    const std::uint32_t key = spread(static_cast<std::uint32_t>(place[u])) |
      spread(static_cast<std::uint32_t>(place[v])) << 1;
    keys.push_back(static_cast<std::uint64_t>(key) << 32 | b);
  }
  std::sort(keys.begin(), keys.end());
  std::transform(keys.begin(), keys.end(), beams.begin(),
    [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
}

PotentialTriangles findPotential(const CollisionTree& tree, const BeamFrame& frame,
  std::size_t most, EntryPoints& entryPoints, TraversalStack& stack)
{
  entryPoints.clear();
  LeafVisitor visitor(tree.order, most, entryPoints);
  const std::uint64_t visited = descendCone(tree, frame, visitor, stack);
  return { visited, visitor.triangles };
}

void BeamGroups::begin(
  const CollisionTree& tree, const BeamFrame* frames, std::size_t count, const GroupRule& rule)
{
  this->Tree = &tree;
  this->Frames = frames;
  this->Rule = rule;
  this->Order.clear();
  this->Groups.clear();
  this->Now = { 0, 0 };
  const std::size_t size =
    rule.beamsOfCluster * (rule.together && !tree.other ? ConeLanes::Width : 1);
  for (std::size_t first = 0; first < count;)
  {
    this->Stretch.clear();
    const BeamFrame& begun = frames[first];
    for (; first < count && areTogether(begun, frames[first]); ++first)
    {
      this->Stretch.push_back(static_cast<std::uint32_t>(first));
    }
    if (rule.sorts)
    {
      orderBeams(frames, this->Stretch, this->Keys);
    }
    for (std::size_t k = 0; k < this->Stretch.size(); k += size)
    {
      this->Groups.push_back({ this->Order.size() + k, std::min(size, this->Stretch.size() - k) });
    }
    this->Order.insert(this->Order.end(), this->Stretch.begin(), this->Stretch.end());
  }
  std::reverse(this->Groups.begin(), this->Groups.end());
}

bool BeamGroups::next(BeamCluster& cluster)
{
  while (this->Now.count == 0)
  {
    if (!this->descend())
    {
      return false;
    }
  }
  const std::size_t count = std::min(this->Rule.beamsOfCluster, this->Now.count);
  cluster = { &this->Order[this->Now.first], count,
    this->HasEntries ? &this->Work.entryPoints[this->Member] : nullptr, this->Share };
  ++this->Member;
  this->Now.first += count;
  this->Now.count -= count;
  return true;
}

/// Descend with the next group, or halve it if its beams lie too far apart. @return false after the
/// last group
bool BeamGroups::descend()
{
  if (this->Groups.empty())
  {
    return false;
  }
  this->Now = this->Groups.back();
  this->Groups.pop_back();
  this->Member = 0;
  this->Share = 0;
  this->HasEntries = false;
  const std::size_t wide = this->Rule.beamsOfCluster;
  const std::size_t clusters = (this->Now.count + wide - 1) / wide;
  if (!this->Rule.together || this->Tree->other || (clusters == 1 && !this->Rule.evenAlone))
  {
    return true;
  }
  const std::uint32_t* const beams = &this->Order[this->Now.first];
  this->Work.cones.count = 0;
  for (std::size_t k = 0; k < this->Now.count; k += wide)
  {
    this->Work.cones.add(this->Frames, beams + k, std::min(wide, this->Now.count - k));
  }
  this->Work.cones.close();
  const std::int64_t visited =
    findEntryPoints(this->Tree->wide, this->Frames[beams[0]].origin, this->Work);
  if (visited >= 0)
  {
    this->HasEntries = true;
    this->Share = static_cast<std::uint64_t>(visited) / this->Now.count;
  }
  else if (clusters > 1)
  {
    const std::size_t half = clusters / 2 * wide;
    this->Groups.push_back({ this->Now.first + half, this->Now.count - half });
    this->Groups.push_back({ this->Now.first, half });
    this->Now.count = 0;
  }
  return true;
}
}
