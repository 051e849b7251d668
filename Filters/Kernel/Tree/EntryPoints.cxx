// SPDX-License-Identifier: BSD-3-Clause
#include "EntryPoints.h"

#include <algorithm>

namespace avianlidar
{
void EntryPoints::clear()
{
  this->nodes.clear();
  this->nearest.clear();
  this->Filled = WideNode::Width;
}

int EntryPoints::nextLane(float distance)
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

void EntryPoints::add(const WideNode& node, int lane, float distance)
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

void EntryPoints::addLeaf(std::uint32_t first, std::uint32_t count)
{
  constexpr float Everywhere = 1e30f;
  const int i = this->nextLane(0.0f);
  WideNode& root = this->nodes.back();
  root.x[i] = root.y[i] = root.z[i] = 0.0f;
  root.halfX[i] = root.halfY[i] = root.halfZ[i] = Everywhere;
  root.first[i] = first;
  root.count[i] = count;
}
}
