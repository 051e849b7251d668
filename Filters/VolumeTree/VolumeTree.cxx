// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeTree.h"

#include "BeamVolumeTest.h"
#include "CollisionTreeBuilder.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace avianlidar
{
namespace
{
/// The smallest boxes of all nodes.
std::vector<AABB> boxesOfNodes(const CollisionTree& tree)
{
  std::vector<AABB> boxes(tree.nodes.size());
  // Children come after their parents.
  for (std::size_t i = tree.nodes.size(); i-- > 0;)
  {
    const TreeNode& node = tree.nodes[i];
    boxes[i] = node.isLeaf()
      ? fitToTriangles<AABB>(*tree.mesh, tree.order.data() + node.first, node.count)
      : merge(boxes[node.first], boxes[node.first + 1]);
  }
  return boxes;
}

/// Visit the leaves whose volume `probe` meets, the nearer child first.
/// @param probe `bool meets(const Volume&, double& nearest) const`
/// @return number of nodes whose volume was tested
template <class Volume, class Probe>
std::uint64_t descend(const CollisionTree& tree, const std::vector<Volume>& volumes,
  const Probe& probe, TreeLeaves& leaves, TraversalStack& stack)
{
  std::uint64_t visited = 1;
  double nearest = 0.0;
  stack.clear();
  if (tree.nodes.empty() || !probe.meets(volumes[0], nearest))
  {
    return visited;
  }
  stack.push_back({ 0, 0, 0, nearest, 0, 0 });
  while (!stack.empty())
  {
    const DescentEntry entry = stack.back();
    stack.pop_back();
    // An equal bound may still hold a hit of equal range and lower number.
    if (entry.nearest > leaves.limit())
    {
      continue;
    }
    const TreeNode& node = tree.nodes[entry.node];
    if (node.isLeaf())
    {
      if (!leaves.leaf(tree.order.data() + node.first, node.count))
      {
        break;
      }
      continue;
    }
    DescentEntry first{ node.first, 0, 0, 0.0, 0, 0 };
    DescentEntry second{ node.first + 1, 0, 0, 0.0, 0, 0 };
    const bool meetsFirst = probe.meets(volumes[first.node], first.nearest);
    const bool meetsSecond = probe.meets(volumes[second.node], second.nearest);
    visited += 2;
    if (meetsFirst && meetsSecond)
    {
      if (second.nearest < first.nearest)
      {
        std::swap(first, second);
      }
      stack.push_back(second);
      stack.push_back(first);
    }
    else if (meetsFirst || meetsSecond)
    {
      stack.push_back(meetsFirst ? first : second);
    }
  }
  return visited;
}

template <class Volume>
class Volumes final : public OtherVolumes
{
public:
  explicit Volumes(std::vector<Volume> volumes)
    : OfNodes(std::move(volumes))
  {
  }

  std::uint64_t descendCone(const CollisionTree& tree, const BeamFrame& frame, TreeLeaves& leaves,
    TraversalStack& stack) const override
  {
    return descend(tree, this->OfNodes, BeamVolumeTest(frame), leaves, stack);
  }

  std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
    const Vec3& direction, double angularMargin, TreeLeaves& leaves,
    TraversalStack& stack) const override
  {
    return descend(
      tree, this->OfNodes, RayVolumeTest(apex, origin, direction, angularMargin), leaves, stack);
  }

  const std::vector<Volume> OfNodes;
};

/// A copy of the tree whose wide tree is replaced.
template <class Volume>
std::shared_ptr<const CollisionTree> with(const CollisionTree& tree, std::vector<Volume> volumes)
{
  auto other = std::make_shared<CollisionTree>(tree);
  other->wide = {};
  other->other = std::make_shared<Volumes<Volume>>(std::move(volumes));
  return other;
}

/// Fit a volume to the triangles of each node. @return empty if `keepGoing` returned false
template <class Volume>
std::vector<Volume> fitAll(const CollisionTree& tree, const KeepGoing& keepGoing, int threads)
{
  // A node's triangles are adjacent in the order: where they begin, and how many they are.
  const std::vector<TreeNode>& nodes = tree.nodes;
  std::vector<TreeNode> ranges(nodes);
  for (std::size_t i = nodes.size(); i-- > 0;)
  {
    if (!nodes[i].isLeaf())
    {
      const TreeNode& first = ranges[nodes[i].first];
      ranges[i] = { first.first, first.count + ranges[nodes[i].first + 1].count };
    }
  }
  std::vector<Volume> volumes(nodes.size());
  const auto body = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      volumes[i] =
        fitToTriangles<Volume>(*tree.mesh, tree.order.data() + ranges[i].first, ranges[i].count);
    }
  };
  bool finished = false;
  ParallelTeam::run(
    threads, [&](ParallelTeam& team) { finished = team.loop(nodes.size(), 16, body, keepGoing); });
  return finished ? volumes : std::vector<Volume>();
}

/// Replace the boxes of `tree`; null if `keepGoing` returned false.
template <class Volume>
std::shared_ptr<const CollisionTree> fitted(
  const CollisionTree& tree, const KeepGoing& keepGoing, int threads)
{
  std::vector<Volume> volumes = fitAll<Volume>(tree, keepGoing, threads);
  return volumes.size() == tree.nodes.size() ? with(tree, std::move(volumes)) : nullptr;
}
}

std::shared_ptr<const CollisionTree> buildVolumeTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing, int threads)
{
  const int volume = static_cast<int>(options.boundingVolume);
  if (volume < 0 || volume > 2)
  {
    throw std::invalid_argument(
      "bounding volume is " + std::to_string(volume) + ", expected 0 to 2");
  }
  if (options.boundingVolume == BoundingVolumeType::AABB)
  {
    return buildCollisionTree(std::move(mesh), options, keepGoing, threads);
  }
  // Fitting takes most of the time.
  constexpr double Built = 0.2;
  const auto part = [&keepGoing](double from, double to)
  {
    return keepGoing ? KeepGoing([&keepGoing, from, to](double done)
                         { return keepGoing(std::min(to, from + (to - from) * done)); })
                     : KeepGoing();
  };
  TreeOptions boxes = options;
  boxes.boundingVolume = BoundingVolumeType::AABB;
  const auto built = buildCollisionTree(std::move(mesh), boxes, part(0.0, Built), threads);
  if (!built)
  {
    return nullptr;
  }
  CollisionTree tree = *built;
  tree.options = options;
  const int team = loopThreads(threads);
  return options.boundingVolume == BoundingVolumeType::OBB
    ? fitted<OBB>(tree, part(Built, 1.0), team)
    : fitted<BoundingSphere>(tree, part(Built, 1.0), team);
}

std::shared_ptr<const CollisionTree> withPlainBoxes(const CollisionTree& tree)
{
  return with(tree, boxesOfNodes(tree));
}

TreeVolumes volumesOf(const CollisionTree& tree)
{
  if (const auto* oriented = dynamic_cast<const Volumes<OBB>*>(tree.other.get()))
  {
    return oriented->OfNodes;
  }
  if (const auto* spheres = dynamic_cast<const Volumes<BoundingSphere>*>(tree.other.get()))
  {
    return spheres->OfNodes;
  }
  return boxesOfNodes(tree);
}
}
