// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTreeBuilder.h"

#include "BinaryTree.h"
#include "CoincidentFaces.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>

namespace avianlidar
{
namespace
{
constexpr int Width = WideNode::Width;

/// Element k - 1: least sum of the areas of the wide nodes below a node of the binary tree if the
/// node takes up to k lanes of the wide node above. A descent visits a node in proportion to its
/// area and tests its eight children at once.
using Costs = std::array<float, Width>;

std::vector<Costs> costsOf(const BinaryTree& tree)
{
  std::vector<Costs> costs(tree.nodes.size(), Costs{});
  // Areas in this unit remain within the range of floats.
  const double unit = tree.extent > 0.0 ? 1.0 / (tree.extent * tree.extent) : 0.0;
  for (std::size_t i = tree.nodes.size(); i-- > 0;)
  {
    const std::uint32_t children = tree.nodes[i].children;
    if (children == 0)
    {
      continue;
    }
    // The two children share the lanes in the way that costs least.
    const Costs& first = costs[children];
    const Costs& second = costs[children + 1];
    Costs least;
    least.fill(std::numeric_limits<float>::max());
    for (int k = 1; k < Width; ++k)
    {
      for (int j = 0; j < k; ++j)
      {
        least[k] = std::min(least[k], first[j] + second[k - 1 - j]);
      }
    }
    const float whole = static_cast<float>(tree.boxes[i].halfArea() * unit) + least[Width - 1];
    for (int k = 0; k < Width; ++k)
    {
      costs[i][k] = std::min(least[k], whole);
    }
  }
  return costs;
}

void setLane(WideNode& node, int lane, const LaneBox& box)
{
  const Lanes center = 0.5f * box.twiceCenter();
  // Each half length is a sum of two floats with one rounding. roundedUp() covers this rounding.
  const Lanes half = roundedUp(larger(box.above - center, box.below + center));
  node.x[lane] = center[0];
  node.y[lane] = center[1];
  node.z[lane] = center[2];
  node.halfX[lane] = half[0];
  node.halfY[lane] = half[1];
  node.halfZ[lane] = half[2];
}

/// Makes the wide nodes from a binary tree.
class WideBuilder
{
public:
  WideBuilder(const BinaryTree& from, WideTree& to)
    : From(from)
    , To(to)
    , Least(costsOf(from))
  {
    this->addNode(0, 0);
    to.nodes.shrink_to_fit();
    to.reference = from.reference;
    to.extent = from.extent;
  }

private:
  /// List the binary nodes, at or below a binary node, that take up to `lanes` lanes of a wide
  /// node.
  /// @return number of these nodes
  int lanesOf(std::uint32_t number, int lanes, std::uint32_t* list) const
  {
    const std::uint32_t children = this->From.nodes[number].children;
    const Costs& own = this->Least[number];
    if (children == 0 || (lanes < Width && !(own[lanes - 1] < own[0])))
    {
      list[0] = number;
      return 1;
    }
    const Costs& first = this->Least[children];
    const Costs& second = this->Least[children + 1];
    int toFirst = 1;
    for (int j = 2; j < lanes; ++j)
    {
      if (first[j - 1] + second[lanes - j - 1] < first[toFirst - 1] + second[lanes - toFirst - 1])
      {
        toFirst = j;
      }
    }
    const int count = this->lanesOf(children, toFirst, list);
    return count + this->lanesOf(children + 1, lanes - toFirst, list + count);
  }

  /// Add the wide node below a node of the binary tree, and all wide nodes below it, depth first.
  /// @return number of the wide node
  std::uint32_t addNode(std::uint32_t whole, std::uint32_t level)
  {
    const auto number = static_cast<std::uint32_t>(this->To.nodes.size());
    this->To.depth = std::max(this->To.depth, level);
    this->To.nodes.emplace_back().clear();
    std::uint32_t lanes[Width];
    const int count = this->lanesOf(whole, Width, lanes);
    for (int i = 0; i < count; ++i)
    {
      const BinaryNode& lane = this->From.nodes[lanes[i]];
      const bool isLeaf = lane.children == 0;
      const std::uint32_t first = isLeaf ? lane.begin : this->addNode(lanes[i], level + 1);
      WideNode& node = this->To.nodes[number];
      setLane(node, i, this->From.boxes[lanes[i]]);
      node.count[i] = isLeaf ? lane.count : 0;
      node.first[i] = first;
    }
    return number;
  }

  const BinaryTree& From;
  WideTree& To;
  std::vector<Costs> Least; ///< costs of each node of the binary tree
};
}

void checkTreeInput(const TriangleMesh* mesh, const TreeOptions& options)
{
  const int rule = static_cast<int>(options.splitRule);
  if (!mesh)
  {
    throw std::invalid_argument("no mesh");
  }
  if (rule < 0 || rule > 3)
  {
    throw std::invalid_argument("split rule is " + std::to_string(rule) + ", expected 0 to 3");
  }
  if (options.maximumLeafSize < 1)
  {
    throw std::invalid_argument(
      "maximum leaf size is " + std::to_string(options.maximumLeafSize) + ", expected at least 1");
  }
}

std::shared_ptr<const CollisionTree> buildCollisionTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing, int threads)
{
  checkTreeInput(mesh.get(), options);
  if (options.boundingVolume != BoundingVolumeType::AABB)
  {
    throw std::invalid_argument("bounding volume is " +
      std::to_string(static_cast<int>(options.boundingVolume)) +
      ", expected 0 (boxes); buildVolumeTree() makes the others");
  }
  const auto tree = std::make_shared<CollisionTree>();
  tree->mesh = std::move(mesh);
  tree->options = options;
  tree->checksum = tree->mesh->checksum();
  // Starting a parallel loop takes about as long as making the boxes of a few hundred triangles.
  constexpr std::size_t LeastPerThread = 1024;
  const std::size_t useful = std::max<std::size_t>(1, tree->mesh->size() / LeastPerThread);
  const int team =
    static_cast<int>(std::min(useful, static_cast<std::size_t>(loopThreads(threads))));
  BinaryTree binary;
  if (!binary.divide(*tree->mesh, options, team, partOf(keepGoing, 0.0, 0.5)))
  {
    return nullptr;
  }
  if (binary.nodes.empty())
  {
    return !keepGoing || keepGoing(1.0) ? tree : nullptr;
  }
  tree->leaves = static_cast<std::uint32_t>((binary.nodes.size() + 1) / 2);
  tree->depth = binary.nodes.back().depth;
  WideBuilder(binary, tree->wide);
  tree->order = std::move(binary.order);
  binary = {};
  // The faces of a leaf are compared one by one, so that a tree with small leaves finds pairs.
  constexpr int MostCompared = 64;
  if (options.maximumLeafSize > MostCompared)
  {
    const auto small = buildCollisionTree(tree->mesh, {}, partOf(keepGoing, 0.55, 1.0), threads);
    tree->planeOwners = small ? small->planeOwners : std::vector<std::uint32_t>();
    tree->planeDepth = small ? small->planeDepth : 0.0;
    return small ? tree : nullptr;
  }
  return findPlaneOwners(*tree, team, partOf(keepGoing, 0.55, 1.0)) ? tree : nullptr;
}
}
