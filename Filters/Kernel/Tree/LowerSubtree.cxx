// SPDX-License-Identifier: BSD-3-Clause
#include "LowerSubtree.h"

#include "SplitRule.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
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

AVIANLIDAR_MULTIVERSION void measure(const LaneBox* boxes, std::size_t count, LaneExtent& extent)
{
  extent.clear();
  extent.include(boxes, count);
}
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
  if (draft.costs)
  {
    draft.wideTreeInput().setCosts(firstSlot, slot);
    draft.wideTreeInput().setCosts(root.slot, root.slot + 1);
  }
  return slot - firstSlot;
}
}
