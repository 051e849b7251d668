// SPDX-License-Identifier: BSD-3-Clause
#include "BeamGroup.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Boxes whose half diagonal is at most so many half-beamwidths are roots.
constexpr double RootSize = 16.0;

/// Boxes that so few clusters of beams meet are roots: a packet knows what it has hit, a group does
/// not.
constexpr int FewBeams = 3;

constexpr float Infinity = std::numeric_limits<float>::infinity();

/// Bits of a number of 16, every other one.
std::uint32_t spread(std::uint32_t v)
{
  v = (v | v << 8) & 0x00ff00ffu;
  v = (v | v << 4) & 0x0f0f0f0fu;
  v = (v | v << 2) & 0x33333333u;
  return (v | v << 1) & 0x55555555u;
}
}

void orderBeams(
  const BeamFrame* frames, std::vector<std::uint32_t>& beams, std::vector<std::uint64_t>& keys)
{
  if (beams.empty())
  {
    return;
  }
  Vec3 lower = frames[beams[0]].axis;
  Vec3 upper = lower;
  for (const std::uint32_t b : beams)
  {
    lower = glm::min(lower, frames[b].axis);
    upper = glm::max(upper, frames[b].axis);
  }
  const Vec3 extent = upper - lower;
  const int least =
    extent.x < extent.y ? (extent.x < extent.z ? 0 : 2) : (extent.y < extent.z ? 1 : 2);
  const int u = (least + 1) % 3;
  const int v = (least + 2) % 3;
  const double scale = 65535.0 / std::max({ extent[u], extent[v], 1e-30 });
  keys.clear();
  for (const std::uint32_t b : beams)
  {
    const Vec3 place = scale * (frames[b].axis - lower);
    const std::uint32_t key = spread(static_cast<std::uint32_t>(place[u])) |
      spread(static_cast<std::uint32_t>(place[v])) << 1;
    keys.push_back(static_cast<std::uint64_t>(key) << 32 | b);
  }
  std::sort(keys.begin(), keys.end());
  std::transform(keys.begin(), keys.end(), beams.begin(),
    [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
}

void BeamRoots::clear()
{
  this->nodes.clear();
  this->nearest.clear();
  this->Filled = WideNode::Width;
}

int BeamRoots::nextLane(float distance)
{
  if (this->Filled == WideNode::Width)
  {
    this->Filled = 0;
    this->nodes.emplace_back();
    this->nearest.push_back(distance);
    WideNode& fresh = this->nodes.back();
    std::fill(fresh.first, fresh.first + WideNode::Width, NoChild);
    std::fill(fresh.count, fresh.count + WideNode::Width, 0u);
  }
  this->nearest.back() = std::min(this->nearest.back(), distance);
  return this->Filled++;
}

void BeamRoots::add(const WideNode& node, int lane, float distance)
{
  const int i = this->nextLane(distance);
  WideNode& root = this->nodes.back();
  root.x[i] = node.x[lane];
  root.y[i] = node.y[lane];
  root.z[i] = node.z[lane];
  root.halfX[i] = node.halfX[lane];
  root.halfY[i] = node.halfY[lane];
  root.halfZ[i] = node.halfZ[lane];
  root.first[i] = node.first[lane];
  root.count[i] = node.count[lane];
}

void BeamRoots::addLeaf(std::uint32_t first, std::uint32_t count)
{
  constexpr float Everywhere = 1e30f;
  const int i = this->nextLane(0.0f);
  WideNode& root = this->nodes.back();
  root.x[i] = root.y[i] = root.z[i] = 0.0f;
  root.halfX[i] = root.halfY[i] = root.halfZ[i] = Everywhere;
  root.first[i] = first;
  root.count[i] = count;
}

std::int64_t findRoots(const WideTree& tree, const Vec3& apex, GroupWorkspace& work)
{
  for (int b = 0; b < work.cones.count; ++b)
  {
    work.roots[b].clear();
  }
  Pyramid pyramid;
  if (!pyramid.set(tree, apex, work.cones))
  {
    return -1;
  }
  const auto rootSize = static_cast<float>(RootSize * pyramid.widest);
  using Entry = GroupWorkspace::Entry;
  std::int64_t visited = 0;
  NearBoxes boxes;
  std::vector<Entry>& stack = work.stack;
  stack.resize(std::max<std::size_t>(stack.size(), WideNode::Width * (tree.depth + 2)));
  Entry* const bottom = stack.data();
  Entry* top = bottom;
  const auto open = [&](std::uint32_t number, std::uint32_t beams)
  {
    const WideNode& node = tree.nodes[number];
    meetPyramid(pyramid, node, boxes);
    visited += WideNode::Width;
    Entry* const first = top;
    for (int i = 0; i < WideNode::Width; ++i)
    {
      if (!(boxes.nearest[i] < Infinity) || node.first[i] == NoChild)
      {
        continue;
      }
      const std::uint32_t met = beams & meetCones(work.cones, pyramid, boxes, i);
      if (met == 0)
      {
        continue;
      }
      const bool root =
        node.count[i] > 0 || boxes.size[i] <= rootSize || __builtin_popcount(met) <= FewBeams;
      // Kept sorted, the nearest on top.
      Entry* place = top++;
      while (place != first && place[-1].nearest < boxes.nearest[i])
      {
        *place = place[-1];
        --place;
      }
      *place = { number, static_cast<std::uint32_t>(i), met, boxes.nearest[i], root };
    }
  };
  open(0, (1u << work.cones.count) - 1u);
  while (top != bottom)
  {
    const Entry entry = *--top;
    const WideNode& node = tree.nodes[entry.node];
    if (!entry.root)
    {
      open(node.first[entry.lane], entry.beams);
      continue;
    }
    for (std::uint32_t left = entry.beams; left != 0; left &= left - 1)
    {
      work.roots[__builtin_ctz(left)].add(node, static_cast<int>(entry.lane), entry.nearest);
    }
  }
  return visited;
}
}
