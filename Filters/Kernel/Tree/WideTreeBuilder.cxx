// SPDX-License-Identifier: BSD-3-Clause
#include "WideTreeBuilder.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
/// Levels of wide nodes that are collapsed before the rest is handed out: up to 8^3 pieces of work.
constexpr std::uint32_t UpperLevels = 3;

/// A lane of an upper node whose subtree is still to be collapsed.
struct Pending
{
  std::uint32_t number;
  int lane;
  std::uint32_t root; ///< binary node
};

/// A leaf takes one lane and no node.
constexpr WideTreeCost NoCost{};

AVIANLIDAR_ALWAYS_INLINE const WideTreeCost& costOf(const WideTreeInput& input, std::uint32_t node)
{
  return input.nodes[node].isLeaf() ? NoCost : input.costs[input.nodes[node].first / 2];
}

/// Sums of costs of two children that share up to 2 to 8 lanes: the least of all ways to share
/// them. Element 0 is of no meaning.
AVIANLIDAR_ALWAYS_INLINE WideTreeCost shared(const WideTreeCost& first, const WideTreeCost& second)
{
  constexpr int Width = WideNode::Width;
  constexpr float Never = std::numeric_limits<float>::max();
  float shifted[2 * Width];
  for (int i = 0; i < Width; ++i)
  {
    shifted[i] = Never;
    shifted[Width + i] = second.least[i];
  }
  WideTreeCost result;
  for (float& cost : result.least)
  {
    cost = Never;
  }
  for (int j = 1; j < Width; ++j)
  {
    for (int i = 0; i < Width; ++i)
    {
      const float sum = first.least[j - 1] + shifted[Width + i - j];
      result.least[i] = sum < result.least[i] ? sum : result.least[i];
    }
  }
  return result;
}

/// Collapses one subtree; nodes are laid out depth first.
class Collapser
{
public:
  Collapser(const WideTreeInput& input, std::uint32_t levels)
    : Input(input)
    , Levels(levels)
  {
  }

  std::uint32_t collapse(std::uint32_t root, std::uint32_t level)
  {
    this->depth = std::max(this->depth, level);
    const auto number = static_cast<std::uint32_t>(this->collapsed.size());
    this->collapsed.emplace_back();
    std::uint32_t children[WideNode::Width];
    const int count = this->childrenOf(root, children);
    for (int lane = 0; lane < WideNode::Width; ++lane)
    {
      if (lane < count)
      {
        this->setLane(this->collapsed[number], lane, children[lane]);
      }
      else
      {
        clearLane(this->collapsed[number], lane);
      }
    }
    for (int lane = 0; lane < count; ++lane)
    {
      if (this->Input.nodes[children[lane]].isLeaf())
      {
        continue;
      }
      if (level + 1 == this->Levels)
      {
        this->pending.push_back({ number, lane, children[lane] });
        continue;
      }
      const std::uint32_t child = this->collapse(children[lane], level + 1);
      this->collapsed[number].first[lane] = child;
    }
    return number;
  }

  std::vector<WideNode> collapsed;
  std::vector<Pending> pending;
  std::uint32_t depth = 0; ///< of the deepest node

private:
  /// The binary node's descendants that become the children of a wide node.
  int childrenOf(std::uint32_t root, std::uint32_t* children) const
  {
    children[0] = root;
    return this->Input.nodes[root].isLeaf() ? 1 : this->divide(root, WideNode::Width, children);
  }

  /// Give up to `lanes` lanes to the children of a node.
  int divide(std::uint32_t node, int lanes, std::uint32_t* children) const
  {
    const std::uint32_t child = this->Input.nodes[node].first;
    const float* const first = costOf(this->Input, child).least;
    const float* const second = costOf(this->Input, child + 1).least;
    int toFirst = 1;
    for (int j = 2; j < lanes; ++j)
    {
      if (first[j - 1] + second[lanes - j - 1] < first[toFirst - 1] + second[lanes - toFirst - 1])
      {
        toFirst = j;
      }
    }
    const int count = this->place(child, toFirst, children);
    return count + this->place(child + 1, lanes - toFirst, children + count);
  }

  /// A node takes one lane, or its children take several where that costs less.
  int place(std::uint32_t node, int lanes, std::uint32_t* children) const
  {
    const float* const costs = costOf(this->Input, node).least;
    if (costs[lanes - 1] < costs[0])
    {
      return this->divide(node, lanes, children);
    }
    children[0] = node;
    return 1;
  }

  void setLane(WideNode& node, int lane, std::uint32_t child) const
  {
    const LaneBox& box = this->Input.boxes[child];
    const Lanes center = 0.5f * box.twiceCenter();
    // Sums of two floats that are rounded once.
    const Lanes half = roundedUp(larger(box.above - center, box.below + center));
    node.x[lane] = center[0];
    node.y[lane] = center[1];
    node.z[lane] = center[2];
    node.halfX[lane] = half[0];
    node.halfY[lane] = half[1];
    node.halfZ[lane] = half[2];
    node.first[lane] = this->Input.nodes[child].first;
    node.count[lane] = this->Input.nodes[child].count;
  }

  static void clearLane(WideNode& node, int lane)
  {
    node.x[lane] = node.y[lane] = node.z[lane] = 0.0f;
    node.halfX[lane] = node.halfY[lane] = node.halfZ[lane] = 0.0f;
    node.first[lane] = NoChild;
    node.count[lane] = 0;
  }

  const WideTreeInput Input;
  const std::uint32_t Levels;
};

AVIANLIDAR_MULTIVERSION void setCostsOf(
  const WideTreeInput& input, double unit, std::uint32_t begin, std::uint32_t end)
{
  for (std::uint32_t node = end; node-- > begin;)
  {
    if (input.nodes[node].isLeaf())
    {
      continue;
    }
    const std::uint32_t child = input.nodes[node].first;
    WideTreeCost cost = shared(costOf(input, child), costOf(input, child + 1));
    const float whole =
      static_cast<float>(input.boxes[node].halfArea() * unit) + cost.least[WideNode::Width - 1];
    for (float& least : cost.least)
    {
      least = least < whole ? least : whole;
    }
    cost.least[0] = whole;
    input.costs[child / 2] = cost;
  }
}

/// Copy collapsed nodes to their place in the whole tree.
void place(const std::vector<WideNode>& collapsed, std::uint32_t offset, WideNode* to)
{
  for (const WideNode& node : collapsed)
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

void WideTreeInput::setCosts(std::uint32_t begin, std::uint32_t end) const
{
  // Relative to the root's, areas are floats.
  const double whole = this->boxes[0].halfArea();
  setCostsOf(*this, whole > 0.0 ? 1.0 / whole : 0.0, begin, end);
}

WideTree buildWideTree(const WideTreeInput& input, const TriangleBoxes& scene, ParallelTeam& team,
  const KeepGoing& keepGoing)
{
  WideTree tree;
  if (scene.count == 0)
  {
    return tree;
  }
  Collapser upper(input, UpperLevels);
  upper.collapse(0, 0);
  const std::vector<Pending>& pending = upper.pending;
  std::vector<std::vector<WideNode>> parts(pending.size());
  std::vector<std::uint32_t> depths(pending.size());
  const auto collapsePart = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      Collapser collapser(input, std::numeric_limits<std::uint32_t>::max());
      collapser.collapse(pending[i].root, UpperLevels);
      parts[i] = std::move(collapser.collapsed);
      depths[i] = collapser.depth;
    }
  };
  if (!team.loop(pending.size(), 1, collapsePart, keepGoing))
  {
    return tree;
  }
  std::vector<std::uint32_t> offsets(pending.size());
  auto size = static_cast<std::uint32_t>(upper.collapsed.size());
  tree.depth = upper.depth;
  for (std::size_t i = 0; i < pending.size(); ++i)
  {
    offsets[i] = size;
    upper.collapsed[pending[i].number].first[pending[i].lane] = size;
    size += static_cast<std::uint32_t>(parts[i].size());
    tree.depth = std::max(tree.depth, depths[i]);
  }
  tree.reference = scene.reference;
  tree.extent = scene.extent;
  tree.nodes.resize(size);
  std::copy(upper.collapsed.begin(), upper.collapsed.end(), tree.nodes.begin());
  const auto placePart = [&](std::size_t begin, std::size_t end, int)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      place(parts[i], offsets[i], tree.nodes.data() + offsets[i]);
    }
  };
  team.loop(pending.size(), 1, placePart);
  return tree;
}
}
