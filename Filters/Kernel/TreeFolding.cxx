// SPDX-License-Identifier: BSD-3-Clause
#include "TreeFolding.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// Levels of wide nodes that are folded before the rest is handed out: up to 8^3 pieces of work.
constexpr std::uint32_t UpperLevels = 3;

/// A lane of an upper node whose subtree is still to be folded.
struct Pending
{
  std::uint32_t number;
  int lane;
  std::uint32_t root; ///< binary node
};

/// Folds one subtree; nodes are laid out depth first.
class Folder
{
public:
  Folder(const TreeNode* nodes, const LaneBox* boxes, std::uint32_t levels)
    : Nodes(nodes)
    , Boxes(boxes)
    , Levels(levels)
  {
  }

  std::uint32_t fold(std::uint32_t root, std::uint32_t depth)
  {
    this->depth = std::max(this->depth, depth);
    const auto number = static_cast<std::uint32_t>(this->folded.size());
    this->folded.emplace_back();
    std::uint32_t children[WideNode::Width];
    const int count = this->childrenOf(root, children);
    for (int lane = 0; lane < WideNode::Width; ++lane)
    {
      if (lane < count)
      {
        this->setLane(this->folded[number], lane, children[lane]);
      }
      else
      {
        clearLane(this->folded[number], lane);
      }
    }
    for (int lane = 0; lane < count; ++lane)
    {
      if (this->Nodes[children[lane]].isLeaf())
      {
        continue;
      }
      if (depth + 1 == this->Levels)
      {
        this->pending.push_back({ number, lane, children[lane] });
        continue;
      }
      const std::uint32_t child = this->fold(children[lane], depth + 1);
      this->folded[number].first[lane] = child;
    }
    return number;
  }

  std::vector<WideNode> folded;
  std::vector<Pending> pending;
  std::uint32_t depth = 0; ///< of the deepest node

private:
  /// The binary node's descendants, the largest opened first until there are eight.
  int childrenOf(std::uint32_t root, std::uint32_t* children) const
  {
    constexpr double Closed = -1.0; // leaves
    double area[WideNode::Width];
    const auto areaOf = [this](std::uint32_t node)
    { return this->Nodes[node].isLeaf() ? Closed : this->Boxes[node].halfArea(); };
    children[0] = root;
    area[0] = areaOf(root);
    int count = 1;
    while (count < WideNode::Width)
    {
      const int best = static_cast<int>(std::max_element(area, area + count) - area);
      if (area[best] < 0.0)
      {
        break;
      }
      const std::uint32_t first = this->Nodes[children[best]].first;
      children[best] = first;
      area[best] = areaOf(first);
      children[count] = first + 1;
      area[count++] = areaOf(first + 1);
    }
    return count;
  }

  void setLane(WideNode& node, int lane, std::uint32_t child) const
  {
    const LaneBox& box = this->Boxes[child];
    const Lanes center = 0.5f * box.twiceCenter();
    // Sums of two floats that are rounded once.
    const Lanes half = roundedUp(larger(box.above - center, box.below + center));
    node.x[lane] = center[0];
    node.y[lane] = center[1];
    node.z[lane] = center[2];
    node.halfX[lane] = half[0];
    node.halfY[lane] = half[1];
    node.halfZ[lane] = half[2];
    node.first[lane] = this->Nodes[child].first;
    node.count[lane] = this->Nodes[child].count;
  }

  static void clearLane(WideNode& node, int lane)
  {
    node.x[lane] = node.y[lane] = node.z[lane] = 0.0f;
    node.halfX[lane] = node.halfY[lane] = node.halfZ[lane] = 0.0f;
    node.first[lane] = NoChild;
    node.count[lane] = 0;
  }

  const TreeNode* Nodes;
  const LaneBox* Boxes;
  std::uint32_t Levels;
};

/// Copy folded nodes to their place in the whole tree.
void place(const std::vector<WideNode>& folded, std::uint32_t offset, WideNode* to)
{
  for (const WideNode& node : folded)
  {
    *to = node;
    for (int lane = 0; lane < WideNode::Width; ++lane)
    {
      to->first[lane] += node.count[lane] == 0 && node.first[lane] != NoChild ? offset : 0;
    }
    ++to;
  }
}
}

WideTree foldTree(const TreeNode* nodes, const LaneBox* boxes, const TriangleBoxes& scene,
  int threads, const KeepGoing& keepGoing)
{
  WideTree tree;
  if (scene.count == 0 || !(scene.extent < LargestWideExtent))
  {
    return tree;
  }
  Folder upper(nodes, boxes, UpperLevels);
  upper.fold(0, 0);
  const std::vector<Pending>& pending = upper.pending;
  std::vector<std::vector<WideNode>> parts(pending.size());
  std::vector<std::uint32_t> depths(pending.size());
  const auto foldPart = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      Folder folder(nodes, boxes, std::numeric_limits<std::uint32_t>::max());
      folder.fold(pending[i].root, UpperLevels);
      parts[i] = std::move(folder.folded);
      depths[i] = folder.depth;
    }
  };
  if (!parallelFor(pending.size(), 1, threads, foldPart, keepGoing))
  {
    return tree;
  }
  std::vector<std::uint32_t> offsets(pending.size());
  auto size = static_cast<std::uint32_t>(upper.folded.size());
  tree.depth = upper.depth;
  for (std::size_t i = 0; i < pending.size(); ++i)
  {
    offsets[i] = size;
    upper.folded[pending[i].number].first[pending[i].lane] = size;
    size += static_cast<std::uint32_t>(parts[i].size());
    tree.depth = std::max(tree.depth, depths[i]);
  }
  tree.reference = scene.reference;
  tree.extent = scene.extent;
  tree.nodes.resize(size);
  std::copy(upper.folded.begin(), upper.folded.end(), tree.nodes.begin());
  const auto placePart = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      place(parts[i], offsets[i], tree.nodes.data() + offsets[i]);
    }
  };
  parallelFor(pending.size(), 1, threads, placePart);
  return tree;
}

WideTree foldTree(const CollisionTree& tree, int threads)
{
  const TriangleBoxes scene = makeTriangleBoxes(*tree.mesh, threads);
  std::vector<LaneBox> boxes(tree.nodes.size());
  // Children come after their parents.
  for (std::size_t i = tree.nodes.size(); i-- > 0;)
  {
    const TreeNode& node = tree.nodes[i];
    boxes[i].clear();
    if (!node.isLeaf())
    {
      boxes[i].include(boxes[node.first]);
      boxes[i].include(boxes[node.first + 1]);
    }
    for (std::uint32_t k = 0; k < node.count; ++k)
    {
      boxes[i].include(scene.boxes[tree.order[node.first + k]]);
    }
  }
  return foldTree(tree.nodes.data(), boxes.data(), scene, threads);
}
}
