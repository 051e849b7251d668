// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TreeDraft.h
 * @brief A collision tree while it is built: what the builder's two stages share.
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
  TriangleBoxes scene;
  TreeNode* nodes = nullptr;
  LaneBox* nodeBoxes = nullptr;
  WideTreeCost* costs = nullptr;    ///< null if the tree will not be folded
  ScratchMemory memory;             ///< of these three
  std::vector<std::uint32_t> upper; ///< slots of upper nodes, parents before their children

  /// Room for the nodes of all triangles of the scene.
  void makeRoom()
  {
    const std::size_t n = this->scene.count;
    const bool folds = this->options.boundingVolume == BoundingVolumeType::AABB;
    this->memory = ScratchMemory(ScratchMemory::bytesOf<TreeNode>(2 * n) +
      ScratchMemory::bytesOf<LaneBox>(2 * n) +
      (folds ? ScratchMemory::bytesOf<WideTreeCost>(n) : 0));
    this->nodes = this->memory.take<TreeNode>(2 * n);
    this->nodeBoxes = this->memory.take<LaneBox>(2 * n);
    this->costs = folds ? this->memory.take<WideTreeCost>(n) : nullptr;
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

  /// Below some depth every rule halves the list: a rule that peels off one triangle at a time
  /// (sizes in geometric progression) would otherwise make a list instead of a tree.
  SplitRule ruleAt(std::uint32_t depth) const
  {
    constexpr std::uint32_t MaximumRuleDepth = 96;
    return depth < MaximumRuleDepth ? this->options.splitRule : SplitRule::Halves;
  }
};

/// Divide all nodes of more than `largest` triangles (which is not less than a leaf may hold).
/// @param rest the nodes that are left, in the order of their boxes
/// @return false if somebody said stop
bool divideUpperLayers(TreeDraft& draft, std::size_t largest, ParallelTeam& team,
  const KeepGoing& keepGoing, std::vector<DraftEntry>& rest);

/// Writes nodes, their boxes and the order of the triangles below `root`.
/// @return number of nodes below it
std::size_t divideSubtree(const TreeDraft& draft, const DraftEntry& root, std::uint32_t* order);
}

#endif
