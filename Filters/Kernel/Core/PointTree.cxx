// SPDX-License-Identifier: BSD-3-Clause
#include "PointTree.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace avianlidar
{
namespace
{
constexpr std::size_t LeafSize = 8;

double squareOf(const Vec3& v)
{
  return v.x * v.x + v.y * v.y + v.z * v.z;
}
}

struct PointTree::Search
{
  const Vec3 place;
  double least = std::numeric_limits<double>::infinity();
  std::size_t taken = 0;

  double squareTo(const Box& box) const
  {
    return squareOf(glm::max(glm::max(box.low - this->place, this->place - box.high), Vec3(0.0)));
  }
};

PointTree::PointTree(std::vector<Vec3> points)
  : Points(std::move(points))
{
  if (!this->Points.empty())
  {
    this->build(0, { 0, this->Points.size() });
  }
}

void PointTree::build(std::size_t node, Range range)
{
  const auto begin = this->Points.begin() + static_cast<std::ptrdiff_t>(range.begin);
  const auto end = this->Points.begin() + static_cast<std::ptrdiff_t>(range.end);
  Box box{ *begin, *begin };
  std::for_each(begin, end,
    [&](const Vec3& point)
    {
      box.low = glm::min(box.low, point);
      box.high = glm::max(box.high, point);
    });
  this->Boxes.resize(std::max(this->Boxes.size(), node + 1));
  this->Boxes[node] = box;
  if (range.end - range.begin <= LeafSize)
  {
    return;
  }
  const Vec3 size = box.high - box.low;
  const int axis = size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = range.begin + (range.end - range.begin) / 2;
  std::nth_element(begin, this->Points.begin() + static_cast<std::ptrdiff_t>(middle), end,
    [axis](const Vec3& one, const Vec3& other) { return one[axis] < other[axis]; });
  this->build(2 * node + 1, { range.begin, middle });
  this->build(2 * node + 2, { middle, range.end });
}

double PointTree::nearestSquare(const Vec3& place, std::size_t* taken) const
{
  Search search{ place };
  if (!this->Points.empty())
  {
    this->search(0, { 0, this->Points.size() }, search);
  }
  if (taken)
  {
    *taken += search.taken;
  }
  return search.least;
}

void PointTree::search(std::size_t node, Range range, Search& search) const
{
  if (range.end - range.begin <= LeafSize)
  {
    for (std::size_t i = range.begin; i < range.end; ++i)
    {
      search.least = std::min(search.least, squareOf(search.place - this->Points[i]));
    }
    search.taken += range.end - range.begin;
    return;
  }
  const std::size_t middle = range.begin + (range.end - range.begin) / 2;
  std::pair<std::size_t, Range> near{ 2 * node + 1, { range.begin, middle } };
  std::pair<std::size_t, Range> far{ 2 * node + 2, { middle, range.end } };
  double toNear = search.squareTo(this->Boxes[near.first]);
  double toFar = search.squareTo(this->Boxes[far.first]);
  if (toFar < toNear)
  {
    std::swap(near, far);
    std::swap(toNear, toFar);
  }
  if (toNear < search.least)
  {
    this->search(near.first, near.second, search);
  }
  if (toFar < search.least)
  {
    this->search(far.first, far.second, search);
  }
}
}
