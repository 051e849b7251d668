// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EntryPoints.h
 * @brief Boxes from which the rays of a beam go on down the wide tree.
 */
#ifndef avianlidar_EntryPoints_h
#define avianlidar_EntryPoints_h

#include "WideTree.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Where the rays of one beam begin: boxes eight at a time, front to back but for overlaps.
struct EntryPoints
{
  std::vector<WideNode> nodes;
  std::vector<float> nearest; ///< lower bound of the ranges in each node, m

  void clear();
  void add(const WideNode& node, int lane, float distance);
  /// A leaf whose volume is not known as a box.
  void addLeaf(std::uint32_t first, std::uint32_t count);

private:
  int nextLane(float distance);

  int Filled = WideNode::Width; ///< lanes of the last node
};
}

#endif
