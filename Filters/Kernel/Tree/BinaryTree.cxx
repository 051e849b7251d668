// SPDX-License-Identifier: BSD-3-Clause
#include "BinaryTree.h"

#include "SplitRule.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace avianlidar
{
namespace
{
AVIANLIDAR_MULTIVERSION void measure(const LaneBox* boxes, std::size_t count, LaneExtent& extent)
{
  extent.clear();
  extent.include(boxes, count);
}
}

bool BinaryTree::divide(const TriangleMesh& mesh, const TreeOptions& options, int threads,
  const KeepGoing& keepGoing, std::uint32_t deepest)
{
  constexpr double measured = 0.1; // share of the whole work
  const TriangleBoxes scene = makeTriangleBoxes(mesh, threads, partOf(keepGoing, 0.0, measured));
  if (mesh.size() == 0 || !scene.boxes)
  {
    return mesh.size() == 0;
  }
  this->reference = scene.reference;
  this->extent = scene.extent;
  this->order.resize(mesh.size());
  this->nodes.push_back({ 0, static_cast<std::uint32_t>(mesh.size()), 0, 0 });
  LaneBox* from = scene.boxes;
  LaneBox* to = scene.room;
  const auto divideNode = [&](std::size_t number)
  {
    const BinaryNode& node = this->nodes[number];
    LaneBox* const own = from + node.begin;
    LaneExtent sum;
    measure(own, node.count, sum);
    this->boxes[number] = sum.box;
    if (node.children == 0)
    {
      std::uint32_t* const leaf = this->order.data() + node.begin;
      std::transform(own, own + node.count, leaf, [](const LaneBox& b) { return b.triangle(); });
      std::sort(leaf, leaf + node.count);
      return;
    }
    const auto first = static_cast<std::uint32_t>(
      splitTriangles(options.splitRule, own, to + node.begin, node.count, sum.centers, node.depth));
    BinaryNode* const children = &this->nodes[node.children];
    children[0] = { node.begin, first, node.depth + 1, 0 };
    children[1] = { node.begin + first, node.count - first, node.depth + 1, 0 };
  };
  std::size_t end = 0;
  for (std::size_t begin = 0; begin < this->nodes.size(); begin = end, std::swap(from, to))
  {
    end = this->nodes.size();
    for (std::size_t i = begin; i < end && this->nodes[i].depth < deepest; ++i)
    {
      if (this->nodes[i].count > static_cast<std::uint32_t>(options.maximumLeafSize))
      {
        this->nodes[i].children = static_cast<std::uint32_t>(this->nodes.size());
        this->nodes.resize(this->nodes.size() + 2);
      }
    }
    this->boxes.resize(end);
    const auto body = [&](std::size_t first, std::size_t last, int)
    {
      for (std::size_t i = first; i < last; ++i)
      {
        divideNode(begin + i);
      }
    };
    // The number of layers is unknown. Each layer is taken to do a tenth of the remaining work.
    const double done = std::max(measured,
      1.0 - (1.0 - measured) * std::pow(0.9, static_cast<double>(this->nodes[begin].depth)));
    constexpr std::size_t blocksOfLayer = 64;
    const std::size_t block = (end - begin) / blocksOfLayer + 1;
    if (!parallelFor(end - begin, block, threads, body, partOf(keepGoing, done, done)))
    {
      return false;
    }
  }
  return true;
}
}
