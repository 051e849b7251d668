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
template <class Probe, class Volume>
std::uint64_t descend(const std::vector<BinaryNode>& nodes, const std::vector<Volume>& volumes,
  const std::vector<std::uint32_t>& order, const Probe& probe, TreeLeaves& leaves,
  TraversalStack& stack)
{
  if (nodes.empty())
  {
    return 0;
  }
  // Every level leaves at most one entry on the stack.
  stack.resize(std::max<std::size_t>(stack.size(), nodes.back().depth + 2));
  DescentEntry* const bottom = stack.data();
  DescentEntry* top = bottom;
  const auto push = [&](std::uint32_t node, double nearest)
  {
    top->node = node;
    top->nearest = nearest;
    ++top;
  };
  std::uint64_t visited = 1;
  double nearest = 0.0;
  if (probe.meets(volumes[0], nearest))
  {
    push(0, nearest);
  }
  double limit = leaves.limit();
  while (top != bottom)
  {
    --top;
    // A volume at the limit may still hold a hit of equal range and lower number.
    if (top->nearest > limit)
    {
      continue;
    }
    const BinaryNode& node = nodes[top->node];
    if (node.children == 0)
    {
      if (!leaves.leaf(order.data() + node.begin, node.count))
      {
        break;
      }
      limit = leaves.limit();
      continue;
    }
    visited += 2;
    double second = 0.0;
    const bool meetsFirst = probe.meets(volumes[node.children], nearest);
    const bool meetsSecond = probe.meets(volumes[node.children + 1], second);
    const std::uint32_t first = node.children;
    if (meetsFirst && meetsSecond)
    {
      const bool inOrder = nearest <= second;
      push(first + (inOrder ? 1 : 0), inOrder ? second : nearest);
      push(first + (inOrder ? 0 : 1), inOrder ? nearest : second);
    }
    else if (meetsFirst || meetsSecond)
    {
      push(first + (meetsFirst ? 0 : 1), meetsFirst ? nearest : second);
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
  const BeamVolumeTest probe(frame);
  return std::visit([&](const auto& all)
    { return descend(this->nodes, all, tree.order, probe, leaves, stack); },
    this->volumes);
}

std::uint64_t VolumeTree::descendRay(const CollisionTree& tree, const Vec3& apex,
  const Vec3& origin, const Vec3& direction, double angularMargin, TreeLeaves& leaves,
  TraversalStack& stack) const
{
  constexpr double OfRoot = 2.0; // volumes may extend beyond the root's volume
  return std::visit(
    [&](const auto& all)
    {
      const double size = all.empty() ? 0.0 : OfRoot * sizeFrom(apex, all[0]);
      const RayVolumeTest probe(apex, origin, direction, angularMargin, size);
      return descend(this->nodes, all, tree.order, probe, leaves, stack);
    },
    this->volumes);
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
  const auto fitted = [&](auto make)
  { return fit(make, *tree->mesh, tree->order, rest, threads, *own); };
  const bool finished = options.boundingVolume == BoundingVolumeType::Sphere
    ? fitted(boundingSphere)
    : options.boundingVolume == BoundingVolumeType::OBB ? fitted(orientedBox)
                                                        : fitted(alignedBox);
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
