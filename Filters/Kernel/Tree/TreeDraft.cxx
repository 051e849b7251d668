// SPDX-License-Identifier: BSD-3-Clause
#include "TreeDraft.h"

#include "SplitRule.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
constexpr std::uint32_t ChunkSize = 1024; ///< boxes

/// A large node of the current layer.
struct Node
{
  DraftEntry entry;
  LaneExtent extent;
  BinMapping mapping;
  BinChoice choice;
  std::uint32_t first; ///< number of boxes that go to the first child
  LaneExtent children[2];
};

/// A part of a node's boxes, and what becomes of it.
struct Chunk
{
  std::size_t node; ///< of the layer
  std::uint32_t begin;
  std::uint32_t count;
  std::uint32_t toFirst;  ///< how many go to the first child
  std::uint32_t first;    ///< and where to
  std::uint32_t second;   ///< where the others go
  LaneExtent children[2]; ///< of those that go to either
};

AVIANLIDAR_MULTIVERSION void measure(const LaneBox* boxes, std::size_t count, LaneExtent& extent)
{
  extent.clear();
  extent.include(boxes, count);
}

AVIANLIDAR_MULTIVERSION void fillBins(
  const BinMapping& mapping, const LaneBox* boxes, std::size_t count, Bins& bins)
{
  bins.clear(mapping.bins);
  bins.add(mapping, boxes, count);
}

AVIANLIDAR_MULTIVERSION void copyParts(const BinMapping& mapping, const BinChoice& choice,
  const LaneBox* from, std::size_t count, LaneBox* to, std::size_t first, std::size_t second)
{
  part(mapping, choice, from, count, to, first, second);
}

class Divider
{
public:
  Divider(TreeDraft& draft, std::size_t largest, ParallelTeam& team, const KeepGoing& keepGoing)
    : Draft(draft)
    , Largest(largest)
    , Team(team)
    , Continue(keepGoing)
  {
  }

  bool run(std::vector<DraftEntry>& rest)
  {
    std::vector<Node> layer(1);
    layer[0].entry = { 0, static_cast<std::uint32_t>(this->Draft.scene.count), 0, 0 };
    if (!this->measureRoot(layer))
    {
      return false;
    }
    while (true)
    {
      this->keepLarge(layer, rest);
      if (layer.empty())
      {
        return true;
      }
      const SplitRule rule = this->Draft.ruleAt(layer[0].entry.depth);
      if (rule == SplitRule::SurfaceAreaHeuristic ? !this->divideTogether(layer)
                                                  : !this->divideEach(layer, rule))
      {
        return false;
      }
      layer = this->childrenOf(layer);
    }
  }

private:
  /// Nodes that are small are left to the next stage.
  void keepLarge(std::vector<Node>& layer, std::vector<DraftEntry>& rest)
  {
    const auto isSmall = [this](const Node& node) { return node.entry.count <= this->Largest; };
    for (const Node& node : layer)
    {
      this->Draft.nodeBoxes[node.entry.slot] = node.extent.box;
      if (isSmall(node))
      {
        rest.push_back(node.entry);
      }
    }
    layer.erase(std::remove_if(layer.begin(), layer.end(), isSmall), layer.end());
    ++this->Layers;
  }

  void makeChunks(const std::vector<Node>& layer)
  {
    this->Chunks.clear();
    for (std::size_t i = 0; i < layer.size(); ++i)
    {
      const DraftEntry& entry = layer[i].entry;
      for (std::uint32_t at = 0; at < entry.count; at += ChunkSize)
      {
        Chunk chunk{};
        chunk.node = i;
        chunk.begin = entry.first + at;
        chunk.count = std::min(ChunkSize, entry.count - at);
        this->Chunks.push_back(chunk);
      }
    }
  }

  /// Call `f` with the number of each item in parallel.
  template <class F>
  bool forEach(std::size_t count, F&& f) const
  {
    const auto body = [&](std::size_t begin, std::size_t end, int)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        f(i);
      }
    };
    // How many layers there will be is not known.
    const double done = 1.0 - std::pow(0.9, this->Layers);
    return this->Team.loop(count, 1, body,
      this->Continue ? KeepGoing([this, done](double) { return this->Continue(done); })
                     : KeepGoing());
  }

  bool measureRoot(std::vector<Node>& layer)
  {
    this->makeChunks(layer);
    const auto measureChunk = [this](std::size_t i)
    {
      Chunk& chunk = this->Chunks[i];
      measure(this->Draft.boxesAt(0) + chunk.begin, chunk.count, chunk.children[0]);
    };
    if (!this->forEach(this->Chunks.size(), measureChunk))
    {
      return false;
    }
    layer[0].extent.clear();
    for (const Chunk& chunk : this->Chunks)
    {
      layer[0].extent.include(chunk.children[0]);
    }
    return true;
  }

  bool divideTogether(std::vector<Node>& layer)
  {
    this->makeChunks(layer);
    this->ChunkBins.resize(this->Chunks.size());
    const std::uint32_t depth = layer[0].entry.depth;
    const LaneBox* const from = this->Draft.boxesAt(depth);
    LaneBox* const to = this->Draft.boxesAt(depth + 1);
    for (Node& node : layer)
    {
      node.mapping.set(node.extent.centers, node.entry.count);
    }
    const auto fill = [&](std::size_t i)
    {
      const Chunk& chunk = this->Chunks[i];
      fillBins(layer[chunk.node].mapping, from + chunk.begin, chunk.count, this->ChunkBins[i]);
    };
    const auto copy = [&](std::size_t i)
    {
      Chunk& chunk = this->Chunks[i];
      const Node& node = layer[chunk.node];
      if (node.choice.axis < 0)
      {
        std::copy_n(from + chunk.begin, chunk.count, to + chunk.begin);
      }
      else
      {
        copyParts(node.mapping, node.choice, from + chunk.begin, chunk.count, to, chunk.first,
          chunk.second);
      }
      measure(to + chunk.first, chunk.toFirst, chunk.children[0]);
      measure(to + chunk.second, chunk.count - chunk.toFirst, chunk.children[1]);
    };
    if (!this->forEach(this->Chunks.size(), fill))
    {
      return false;
    }
    this->choose(layer);
    if (!this->forEach(this->Chunks.size(), copy))
    {
      return false;
    }
    for (const Chunk& chunk : this->Chunks)
    {
      layer[chunk.node].children[0].include(chunk.children[0]);
      layer[chunk.node].children[1].include(chunk.children[1]);
    }
    return true;
  }

  /// Where each node is divided, and from that where the parts of each chunk go.
  void choose(std::vector<Node>& layer)
  {
    std::size_t end = 0;
    for (std::size_t i = 0; i < layer.size(); ++i)
    {
      Node& node = layer[i];
      Bins sum;
      sum.clear(node.mapping.bins);
      const std::size_t begin = end;
      for (; end < this->Chunks.size() && this->Chunks[end].node == i; ++end)
      {
        sum.add(this->ChunkBins[end], node.mapping.bins);
      }
      node.choice = sum.choose(node.mapping);
      const bool halves = node.choice.axis < 0;
      node.first = halves ? node.entry.count / 2 : sum.below(node.choice);
      node.children[0].clear();
      node.children[1].clear();
      std::uint32_t first = node.entry.first;
      std::uint32_t second = first + node.first;
      for (std::size_t k = begin; k < end; ++k)
      {
        Chunk& chunk = this->Chunks[k];
        chunk.toFirst = halves ? std::min(chunk.count, node.entry.first + node.first - first)
                               : this->ChunkBins[k].below(node.choice);
        chunk.first = first;
        chunk.second = second;
        first += chunk.toFirst;
        second += chunk.count - chunk.toFirst;
      }
    }
  }

  bool divideEach(std::vector<Node>& layer, SplitRule rule)
  {
    const auto divide = [&](std::size_t i)
    {
      Node& node = layer[i];
      const DraftEntry& entry = node.entry;
      LaneBox* const from = this->Draft.boxesAt(entry.depth) + entry.first;
      LaneBox* const to = this->Draft.boxesAt(entry.depth + 1) + entry.first;
      node.first = static_cast<std::uint32_t>(
        splitTriangles(rule, from, to, entry.count, node.extent.centers, entry.depth));
      measure(to, node.first, node.children[0]);
      measure(to + node.first, entry.count - node.first, node.children[1]);
    };
    return this->forEach(layer.size(), divide);
  }

  std::vector<Node> childrenOf(const std::vector<Node>& layer)
  {
    std::vector<Node> children;
    children.reserve(2 * layer.size());
    for (const Node& node : layer)
    {
      const DraftEntry& entry = node.entry;
      const std::uint32_t middle = entry.first + node.first;
      const std::uint32_t slot = 2 * middle;
      this->Draft.nodes[entry.slot] = { slot, 0 };
      this->Draft.upper.push_back(entry.slot);
      Node child{};
      child.extent = node.children[0];
      child.entry = { entry.first, node.first, entry.depth + 1, slot };
      children.push_back(child);
      child.extent = node.children[1];
      child.entry = { middle, entry.count - node.first, entry.depth + 1, slot + 1 };
      children.push_back(child);
    }
    return children;
  }

  TreeDraft& Draft;
  const std::size_t Largest;
  ParallelTeam& Team;
  const KeepGoing& Continue;
  std::vector<Chunk> Chunks;
  std::vector<Bins> ChunkBins;
  int Layers = 0;
};

/// Ascending numbers in a leaf: neighbours in the list are often neighbours in memory.
void writeLeaf(const LaneBox* boxes, std::uint32_t count, std::uint32_t* order)
{
  for (std::uint32_t i = 0; i < count; ++i)
  {
    const std::uint32_t triangle = boxes[i].triangle();
    std::uint32_t place = i;
    for (; place > 0 && order[place - 1] > triangle; --place)
    {
      order[place] = order[place - 1];
    }
    order[place] = triangle;
  }
}
}

bool divideUpperLayers(TreeDraft& draft, std::size_t largest, ParallelTeam& team,
  const KeepGoing& keepGoing, std::vector<DraftEntry>& rest)
{
  Divider divider(draft, largest, team, keepGoing);
  if (!divider.run(rest))
  {
    return false;
  }
  std::sort(rest.begin(), rest.end(),
    [](const DraftEntry& a, const DraftEntry& b) { return a.first < b.first; });
  return true;
}

std::size_t divideSubtree(const TreeDraft& draft, const DraftEntry& root, std::uint32_t* order)
{
  std::uint32_t slot = 2 * root.first + 2;
  const std::uint32_t firstSlot = slot;
  std::vector<DraftEntry> stack{ root };
  while (!stack.empty())
  {
    const DraftEntry entry = stack.back();
    stack.pop_back();
    LaneBox* const from = draft.boxesAt(entry.depth) + entry.first;
    LaneExtent extent;
    measure(from, entry.count, extent);
    draft.nodeBoxes[entry.slot] = extent.box;
    if (draft.isLeaf(entry))
    {
      writeLeaf(from, entry.count, order + entry.first);
      draft.nodes[entry.slot] = { entry.first, entry.count };
      continue;
    }
    LaneBox* const to = draft.boxesAt(entry.depth + 1) + entry.first;
    const auto first = static_cast<std::uint32_t>(splitTriangles(
      draft.ruleAt(entry.depth), from, to, entry.count, extent.centers, entry.depth));
    draft.nodes[entry.slot] = { slot, 0 };
    stack.push_back({ entry.first + first, entry.count - first, entry.depth + 1, slot + 1 });
    stack.push_back({ entry.first, first, entry.depth + 1, slot });
    slot += 2;
  }
  if (draft.wide)
  {
    draft.wideTreeInput().setCosts(firstSlot, slot);
    draft.wideTreeInput().setCosts(root.slot, root.slot + 1);
  }
  return slot - firstSlot;
}
}
