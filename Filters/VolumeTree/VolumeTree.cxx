// SPDX-License-Identifier: BSD-3-Clause
#include "VolumeTree.h"

#include "BeamVolumeTest.h"
#include "CollisionTreeBuilder.h"
#include "SplitRule.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace avianlidar
{
namespace
{
/// Visit the leaves whose volume `probe` meets, the nearer child first.
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
    // An equal bound may still hold a hit of equal range and lower number.
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

/// Divide the nodes down to a depth, without volumes. @return false if `keepGoing` returned false
bool divide(const TriangleMesh& mesh, const TreeOptions& options, std::uint32_t deepest,
  const KeepGoing& keepGoing, std::vector<BinaryNode>& nodes, std::vector<std::uint32_t>& order)
{
  const TriangleBoxes scene = makeTriangleBoxes(mesh, 1, keepGoing);
  if (mesh.size() == 0)
  {
    return true;
  }
  const auto leafSize = static_cast<std::uint32_t>(options.maximumLeafSize);
  nodes.push_back({ 0, static_cast<std::uint32_t>(mesh.size()), 0, 0 });
  order.resize(mesh.size());
  for (std::size_t i = 0; scene.boxes && i < nodes.size(); ++i)
  {
    const BinaryNode node = nodes[i];
    const auto boxesAt = [&](std::uint32_t depth)
    { return (depth % 2 == 0 ? scene.boxes : scene.room) + node.begin; };
    LaneBox* const boxes = boxesAt(node.depth);
    if (node.count <= leafSize || node.depth >= deepest)
    {
      std::uint32_t* const leaf = order.data() + node.begin;
      std::transform(
        boxes, boxes + node.count, leaf, [](const LaneBox& b) { return b.triangle(); });
      std::sort(leaf, leaf + node.count);
      continue;
    }
    LaneExtent extent;
    extent.clear();
    extent.include(boxes, node.count);
    const auto first = static_cast<std::uint32_t>(splitTriangles(
      options.splitRule, boxes, boxesAt(node.depth + 1), node.count, extent.centers, node.depth));
    nodes[i].children = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back({ node.begin, first, node.depth + 1, 0 });
    nodes.push_back({ node.begin + first, node.count - first, node.depth + 1, 0 });
  }
  return scene.boxes != nullptr;
}

/// Fit volumes to the triangles of all nodes. @return false if `keepGoing` returned false
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
  if (volume < 0 || volume > 2)
  {
    throw std::invalid_argument(
      "bounding volume is " + std::to_string(volume) + ", expected 0 to 2");
  }
  if (options.boundingVolume == BoundingVolumeType::AABB)
  {
    return buildCollisionTree(std::move(mesh), options, keepGoing, threads);
  }
  checkTreeInput(mesh.get(), options);
  // Fitting takes most of the time.
  constexpr double Built = 0.2;
  const auto part = [&keepGoing](double from, double to)
  {
    return keepGoing ? KeepGoing([&keepGoing, from, to](double done)
                         { return keepGoing(std::min(to, from + (to - from) * done)); })
                     : KeepGoing();
  };
  // Faces that coincide are found by boxes.
  const auto boxes = buildCollisionTree(mesh, TreeOptions{}, part(0.0, 0.5 * Built), threads);
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
  constexpr std::uint32_t deepest = std::numeric_limits<std::uint32_t>::max();
  if (!divide(*tree->mesh, options, deepest, part(0.5 * Built, Built), own->nodes, tree->order))
  {
    return nullptr;
  }
  tree->leaves = static_cast<std::uint32_t>((own->nodes.size() + 1) / 2);
  tree->depth = own->nodes.empty() ? 0 : own->nodes.back().depth;
  const bool finished = options.boundingVolume == BoundingVolumeType::OBB
    ? fit(orientedBox, *tree->mesh, tree->order, part(Built, 1.0), threads, *own)
    : fit(boundingSphere, *tree->mesh, tree->order, part(Built, 1.0), threads, *own);
  tree->other = own;
  return finished ? tree : nullptr;
}

std::shared_ptr<const CollisionTree> withPlainBoxes(const CollisionTree& tree)
{
  const auto plain = std::make_shared<CollisionTree>(tree);
  plain->wide = {};
  plain->other = volumesOf(tree);
  return plain;
}

std::shared_ptr<const VolumeTree> volumesOf(const CollisionTree& tree, std::uint32_t deepest)
{
  if (tree.other)
  {
    return std::dynamic_pointer_cast<const VolumeTree>(tree.other);
  }
  const auto boxes = std::make_shared<VolumeTree>();
  std::vector<std::uint32_t> order;
  divide(*tree.mesh, tree.options, deepest, {}, boxes->nodes, order);
  fit(alignedBox, *tree.mesh, order, {}, 0, *boxes);
  return boxes;
}
}
