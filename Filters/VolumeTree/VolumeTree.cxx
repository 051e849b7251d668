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
/// Visit the leaves whose volumes `probe` meets, the nearer child first.
/// @return number of nodes whose volume was tested
std::uint64_t descend(const VolumeTree& tree, const std::vector<std::uint32_t>& order,
  const BeamVolumeTest& probe, TreeLeaves& leaves, TraversalStack& stack)
{
  std::uint64_t visited = 0;
  stack.clear();
  const auto push = [&](std::uint32_t node)
  {
    ++visited;
    double nearest = 0.0;
    if (std::visit([&](const auto& all) { return probe.meets(all[node], nearest); }, tree.volumes))
    {
      stack.push_back({ node, 0, 0, nearest, 0, 0 });
    }
  };
  if (!tree.nodes.empty())
  {
    push(0);
  }
  while (!stack.empty())
  {
    const DescentEntry entry = stack.back();
    stack.pop_back();
    // A volume at the limit may still hold a hit of equal range and lower number.
    if (entry.nearest > leaves.limit())
    {
      continue;
    }
    const BinaryNode& node = tree.nodes[entry.node];
    if (node.children == 0)
    {
      if (!leaves.leaf(order.data() + node.begin, node.count))
      {
        break;
      }
      continue;
    }
    const std::size_t before = stack.size();
    push(node.children + 1);
    push(node.children);
    if (stack.size() == before + 2 && stack[before].nearest < stack[before + 1].nearest)
    {
      std::swap(stack[before], stack[before + 1]);
    }
  }
  return visited;
}

/// Fit a volume to each node's triangles. @return false if `keepGoing` returned false
template <class Volume>
bool fit(Volume (*fitted)(const TriangleList&), const TriangleMesh& mesh,
  const std::vector<std::uint32_t>& order, const KeepGoing& keepGoing, int threads,
  VolumeTree& tree)
{
  std::vector<Volume> volumes(tree.nodes.size());
  const auto body = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      const BinaryNode& node = tree.nodes[i];
      volumes[i] = fitted({ mesh, order.data() + node.begin, node.count });
    }
  };
  constexpr std::size_t Block = 16;
  const bool finished = parallelFor(volumes.size(), Block, threads, body, keepGoing);
  tree.volumes = std::move(volumes);
  return finished;
}
}

std::uint64_t VolumeTree::descendCone(const CollisionTree& tree, const BeamFrame& frame,
  TreeLeaves& leaves, TraversalStack& stack) const
{
  return descend(*this, tree.order, BeamVolumeTest(frame), leaves, stack);
}

std::uint64_t VolumeTree::descendRay(const CollisionTree& tree, const Vec3& apex,
  const Vec3& origin, const Vec3& direction, double angularMargin, TreeLeaves& leaves,
  TraversalStack& stack) const
{
  const BeamVolumeTest probe(apex, origin, direction, angularMargin);
  return descend(*this, tree.order, probe, leaves, stack);
}

std::shared_ptr<const CollisionTree> buildVolumeTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing, int threads)
{
  const int volume = static_cast<int>(options.boundingVolume);
  if (volume < 0 || volume > 3)
  {
    throw std::invalid_argument(
      "bounding volume is " + std::to_string(volume) + ", expected 0 to 3");
  }
  if (options.boundingVolume == BoundingVolumeType::AABB)
  {
    return buildCollisionTree(std::move(mesh), options, keepGoing, threads);
  }
  checkTreeInput(mesh.get(), options);
  // Share of the work before the volumes are fitted.
  constexpr double Built = 0.2;
  // Coincident faces are found by a tree of boxes.
  const auto boxes =
    buildCollisionTree(mesh, TreeOptions{}, partOf(keepGoing, 0.0, 0.5 * Built), threads);
  if (!boxes)
  {
    return nullptr;
  }
  const auto tree = std::make_shared<CollisionTree>();
  const auto own = std::make_shared<VolumeTree>();
  tree->mesh = std::move(mesh);
  tree->options = options;
  tree->checksum = boxes->checksum;
  tree->planeOwners = boxes->planeOwners;
  tree->planeDepth = boxes->planeDepth;
  BinaryTree binary;
  if (!binary.divide(*tree->mesh, options, threads, partOf(keepGoing, 0.5 * Built, Built)))
  {
    return nullptr;
  }
  own->nodes = std::move(binary.nodes);
  tree->order = std::move(binary.order);
  tree->leaves = static_cast<std::uint32_t>((own->nodes.size() + 1) / 2);
  tree->depth = own->nodes.empty() ? 0 : own->nodes.back().depth;
  const KeepGoing rest = partOf(keepGoing, Built, 1.0);
  const bool finished = options.boundingVolume == BoundingVolumeType::Sphere
    ? fit(boundingSphere, *tree->mesh, tree->order, rest, threads, *own)
    : fit(options.boundingVolume == BoundingVolumeType::OBB ? orientedBox : alignedBox, *tree->mesh,
        tree->order, rest, threads, *own);
  tree->other = own;
  return finished ? tree : nullptr;
}

std::shared_ptr<const VolumeTree> volumesOf(const CollisionTree& tree, std::uint32_t deepest)
{
  if (tree.other)
  {
    return std::dynamic_pointer_cast<const VolumeTree>(tree.other);
  }
  const auto boxes = std::make_shared<VolumeTree>();
  BinaryTree binary;
  binary.divide(*tree.mesh, tree.options, 0, {}, deepest);
  boxes->nodes = std::move(binary.nodes);
  fit(alignedBox, *tree.mesh, binary.order, {}, 0, *boxes);
  return boxes;
}
}
