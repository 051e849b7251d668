// SPDX-License-Identifier: BSD-3-Clause
#include "TreeVisits.h"

#include "BeamFrame.h"
#include "BeamVolumeTest.h"
#include "Traversal.h"

#include <algorithm>
#include <limits>
#include <type_traits>

namespace avianlidar
{
namespace
{
/// Beams that a thread takes at a time.
constexpr std::size_t Block = 64;

/// What one thread counts.
struct Counts
{
  std::vector<std::uint32_t> tested;
  std::vector<std::uint32_t> met;
  TraversalStack stack;

  void begin(std::size_t nodes)
  {
    this->tested.resize(nodes);
    this->met.resize(nodes);
  }
};

/// The cone of a beam, which notes what volumes it is tested against.
template <class Volume>
class CountingCone
{
public:
  /// @param inner nodes above the last level
  CountingCone(const BeamFrame& frame, const Volume* first, std::size_t inner, Counts& counts)
    : Cone(frame)
    , First(first)
    , Inner(inner)
    , Found(counts)
  {
  }

  bool meets(const Volume& volume, double& nearest) const
  {
    const auto node = static_cast<std::size_t>(&volume - this->First);
    ++this->Found.tested[node];
    if (!this->Cone.meets(volume, nearest))
    {
      return false;
    }
    ++this->Found.met[node];
    return node < this->Inner;
  }

private:
  BeamVolumeTest Cone;
  const Volume* First;
  std::size_t Inner;
  Counts& Found;
};

struct EveryLeaf
{
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t*, std::uint32_t) const { return true; }
};

void add(const std::vector<std::uint32_t>& counts, std::vector<std::int64_t>& sums)
{
  for (std::size_t i = 0; i < counts.size(); ++i)
  {
    sums[i] += counts[i];
  }
}
}

std::size_t nodesToLevel(const CollisionTree& tree, std::uint32_t level)
{
  const std::vector<std::uint32_t> depths = tree.depths();
  return static_cast<std::size_t>(
    std::upper_bound(depths.begin(), depths.end(), level) - depths.begin());
}

bool countVisits(const CollisionTree& tree, const ScanBeams& beams, double halfBeamwidth,
  std::uint32_t level, int threads, const KeepGoing& keepGoing, TreeVisits& visits)
{
  const std::size_t nodes = nodesToLevel(tree, level);
  const std::size_t inner = level > 0 ? nodesToLevel(tree, level - 1) : 0;
  visits.tested.assign(nodes, 0);
  visits.met.assign(nodes, 0);
  if (nodes == 0)
  {
    return true;
  }
  bool done = false;
  std::vector<Counts> counts(static_cast<std::size_t>(loopThreads(threads)));
  withVolumes(tree,
    [&](const auto& volumes)
    {
      using Volume = typename std::decay_t<decltype(volumes)>::value_type;
      const auto body = [&](std::size_t begin, std::size_t end, int thread)
      {
        Counts& mine = counts[static_cast<std::size_t>(thread)];
        mine.begin(nodes);
        EveryLeaf visitor;
        for (std::size_t i = begin; i < end; ++i)
        {
          const BeamFrame frame =
            makeBeamFrame(beams.origins[i], beams.directions[i], halfBeamwidth);
          const CountingCone<Volume> cone(frame, volumes.data(), inner, mine);
          descend(tree, volumes, cone, visitor, mine.stack);
        }
      };
      done = parallelFor(beams.size(), Block, threads, body, keepGoing);
    });
  for (const Counts& one : counts)
  {
    add(one.tested, visits.tested);
    add(one.met, visits.met);
  }
  return done;
}
}
