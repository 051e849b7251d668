// SPDX-License-Identifier: BSD-3-Clause
#include "BeamGroup.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// Boxes of at most so many half-beamwidths are roots: below, a packet's own tests reject as much.
constexpr double RootSize = 16.0;

/// Boxes that so few beams meet are roots.
constexpr int FewBeams = 1;

constexpr float Infinity = std::numeric_limits<float>::infinity();

template <float GroupedBeam::*Axis>
void part(GroupedBeam* beams, std::size_t half, std::size_t count)
{
  std::nth_element(beams, beams + half, beams + count,
    [](const GroupedBeam& a, const GroupedBeam& b)
    { return a.*Axis < b.*Axis || (a.*Axis == b.*Axis && a.beam < b.beam); });
}
}

void forEachGroup(GroupedBeam* beams, std::size_t count, std::size_t most,
  const std::function<void(GroupedBeam* beams, std::size_t count)>& visit)
{
  if (count <= most)
  {
    if (count > 0)
    {
      visit(beams, count);
    }
    return;
  }
  GroupedBeam lower = beams[0];
  GroupedBeam upper = beams[0];
  for (std::size_t i = 1; i < count; ++i)
  {
    lower.x = std::min(lower.x, beams[i].x);
    lower.y = std::min(lower.y, beams[i].y);
    lower.z = std::min(lower.z, beams[i].z);
    upper.x = std::max(upper.x, beams[i].x);
    upper.y = std::max(upper.y, beams[i].y);
    upper.z = std::max(upper.z, beams[i].z);
  }
  const float x = upper.x - lower.x;
  const float y = upper.y - lower.y;
  const float z = upper.z - lower.z;
  // Whole groups on one side, so that few are left half full.
  const std::size_t groups = (count + most - 1) / most;
  const std::size_t half = groups / 2 * most;
  if (x >= y && x >= z)
  {
    part<&GroupedBeam::x>(beams, half, count);
  }
  else if (y >= z)
  {
    part<&GroupedBeam::y>(beams, half, count);
  }
  else
  {
    part<&GroupedBeam::z>(beams, half, count);
  }
  forEachGroup(beams, half, most, visit);
  forEachGroup(beams + half, count - half, most, visit);
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
