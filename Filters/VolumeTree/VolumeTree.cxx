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

class Volumes final : public OtherVolumes
{
public:
  explicit Volumes(TreeVolumes volumes)
    : ofNodes(std::make_shared<const TreeVolumes>(std::move(volumes)))
  {
  }

  std::uint64_t descendCone(const CollisionTree& tree, const BeamFrame& frame, TreeLeaves& leaves,
    TraversalStack& stack) const override
  {
    return this->descendWith(tree, BeamVolumeTest(frame), leaves, stack);
  }

  std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
    const Vec3& direction, double angularMargin, TreeLeaves& leaves,
    TraversalStack& stack) const override
  {
    return this->descendWith(
      tree, RayVolumeTest(apex, origin, direction, angularMargin), leaves, stack);
  }

  const std::shared_ptr<const TreeVolumes> ofNodes;

private:
  template <class Probe>
  std::uint64_t descendWith(
    const CollisionTree& tree, const Probe& probe, TreeLeaves& leaves, TraversalStack& stack) const
  {
    return std::visit([&](const auto& volumes)
      { return descend(tree, volumes, probe, leaves, stack); },
      *this->ofNodes);
  }
};

/// Fit volumes to the triangles of all nodes. @return false if `keepGoing` returned false
template <class Volume>
bool fit(const CollisionTree& tree, const KeepGoing& keepGoing, int threads, TreeVolumes& fitted)
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
  constexpr std::size_t Block = 16;
  const bool finished = parallelFor(nodes.size(), Block, threads, body, keepGoing);
  fitted = std::move(volumes);
  return finished;
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
  const auto tree = buildBinaryTree(mesh, options, part(0.0, 0.5 * Built), threads);
  const auto boxes =
    tree ? buildCollisionTree(mesh, TreeOptions{}, part(0.5 * Built, Built), threads) : nullptr;
  if (!boxes)
  {
    return nullptr;
  }
  tree->planeOwners = boxes->planeOwners;
  tree->planeDepth = boxes->planeDepth;
  TreeVolumes volumes;
  const bool finished = options.boundingVolume == BoundingVolumeType::OBB
    ? fit<OBB>(*tree, part(Built, 1.0), threads, volumes)
    : fit<BoundingSphere>(*tree, part(Built, 1.0), threads, volumes);
  tree->other = std::make_shared<Volumes>(std::move(volumes));
  return finished ? tree : nullptr;
}

std::shared_ptr<const CollisionTree> withPlainBoxes(const CollisionTree& tree)
{
  const auto plain = std::make_shared<CollisionTree>(tree);
  plain->wide = {};
  plain->other = std::make_shared<Volumes>(boxesOfNodes(tree));
  return plain;
}

std::shared_ptr<const TreeVolumes> volumesOf(const CollisionTree& tree)
{
  const auto* const kept = dynamic_cast<const Volumes*>(tree.other.get());
  return kept ? kept->ofNodes : std::make_shared<const TreeVolumes>(boxesOfNodes(tree));
}
}
