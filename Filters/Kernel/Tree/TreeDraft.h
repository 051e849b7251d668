// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TreeDraft.h
 * @brief A collision tree while it is built: its nodes and boxes, and the two stages that divide
 * them.
 *
 * Stage 1 divides the large nodes layer by layer, with many threads at each of them. The boxes of
 * a layer's nodes are cut into chunks. For the surface area heuristic every chunk fills bins of
 * its own; merged, they decide where a node is divided and how many boxes of each chunk go to each
 * side, so that all chunks are copied at once. Other rules divide different nodes in parallel.
 * Stage 2 divides each node that is left down to its leaves, depth first, on one thread.
 *
 * Source: paper, Algorithm 1.
 * Differs: large nodes are divided by all threads together, and nodes are numbered afterwards
 * (CollisionTreeBuilder.h).
 * Valid: the same bits for any number of threads.
 * Test: TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_TreeDraft_h
#define avianlidar_TreeDraft_h

#include "CollisionTree.h"
#include "ParallelLoop.h"
#include "TriangleBoxes.h"
#include "WideTreeBuilder.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Below this depth every rule halves the list: one that peels off a triangle at a time (sizes in
/// geometric progression) would otherwise make a list instead of a tree.
constexpr std::uint32_t MaximumRuleDepth = 96;

/// A node that is still to be divided.
struct DraftEntry
{
  std::uint32_t first; ///< of its boxes
  std::uint32_t count;
  std::uint32_t depth; ///< root 0
  std::uint32_t slot;
};

/// Nodes have slots rather than numbers: siblings are adjacent, the root is 0. Threads need not
/// agree on slots: of the nodes that divide boxes [f, f + n) depth first, those below the
/// topmost take the slots from 2 f + 2 up to 2 (f + n), and children of upper nodes, the second
/// beginning with box s, take 2 s and 2 s + 1. Slots that stay empty are never touched.
struct TreeDraft
{
  TreeOptions options;
  bool wide = true; ///< a wide tree will be made
  TriangleBoxes scene;
  TreeNode* nodes = nullptr;
  LaneBox* nodeBoxes = nullptr;
  WideTreeCost* costs = nullptr;
  ScratchMemory memory;             ///< of these three
  std::vector<std::uint32_t> upper; ///< slots of upper nodes, parents before their children

  /// Room for the nodes of all triangles of the scene.
  void makeRoom()
  {
    const std::size_t n = this->scene.count;
    this->memory = ScratchMemory(ScratchMemory::bytesOf<TreeNode>(2 * n) +
      ScratchMemory::bytesOf<LaneBox>(2 * n) + ScratchMemory::bytesOf<WideTreeCost>(n));
    this->nodes = this->memory.take<TreeNode>(2 * n);
    this->nodeBoxes = this->memory.take<LaneBox>(2 * n);
    this->costs = this->memory.take<WideTreeCost>(n);
  }

  WideTreeInput wideTreeInput() const { return { this->nodes, this->nodeBoxes, this->costs }; }

  /// Boxes of nodes at this depth.
  LaneBox* boxesAt(std::uint32_t depth) const
  {
    return depth % 2 == 0 ? this->scene.boxes : this->scene.room;
  }

  bool isLeaf(const DraftEntry& entry) const
  {
    return entry.count <= static_cast<std::uint32_t>(this->options.maximumLeafSize);
  }

  SplitRule ruleAt(std::uint32_t depth) const
  {
    return depth < MaximumRuleDepth ? this->options.splitRule : SplitRule::Halves;
  }
};

/// Stage 1: divide all nodes of more than `largest` triangles (not less than a leaf may hold).
/// @param rest the nodes that are left, in the order of their boxes
/// @return false if `keepGoing` returned false
bool divideUpperLayers(TreeDraft& draft, std::size_t largest, ParallelTeam& team,
  const KeepGoing& keepGoing, std::vector<DraftEntry>& rest);

/// Stage 2: divide `root` down to its leaves. Writes nodes, their boxes and the order of the
/// triangles below it.
/// @return number of nodes below it
std::size_t divideSubtree(const TreeDraft& draft, const DraftEntry& root, std::uint32_t* order);
}

#endif
