// SPDX-License-Identifier: BSD-3-Clause
#include "PointTree.h"

#include <algorithm>
#include <limits>
#include <tuple>
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
  const std::vector<Vec3>& points;
  Nearest found{ std::numeric_limits<double>::infinity(), 0 };
  std::size_t taken = 0;

  // Whether one of the points from `index` on may be preferred to what is found, if none is nearer
  // than `square` or has lower coordinates than `low`. So boxes full of points in one place are
  // passed by.
  bool improves(double square, const Vec3& low, std::size_t index) const
  {
    if (square != this->found.square)
    {
      return square < this->found.square;
    }
    const Vec3& best = this->points[this->found.index];
    return std::tie(low.x, low.y, low.z, index) <
      std::tie(best.x, best.y, best.z, this->found.index);
  }

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

PointTree::Nearest PointTree::nearest(const Vec3& place, std::size_t* taken) const
{
  Search search{ place, this->Points };
  if (!this->Points.empty())
  {
    this->search(0, { 0, this->Points.size() }, search);
  }
  if (taken)
  {
    *taken += search.taken;
  }
  return search.found;
}

void PointTree::search(std::size_t node, Range range, Search& search) const
{
  if (range.end - range.begin <= LeafSize)
  {
    Nearest best = search.found;
    bool tied = false; // a rare case, kept apart as this loop takes most of the time
    for (std::size_t i = range.begin; i < range.end; ++i)
    {
      const double square = squareOf(search.place - this->Points[i]);
      tied |= square == best.square;
      best.index = square < best.square ? i : best.index;
      best.square = std::min(best.square, square);
    }
    search.found = best;
    for (std::size_t i = range.begin; tied && i < range.end; ++i)
    {
      const double square = squareOf(search.place - this->Points[i]);
      if (search.improves(square, this->Points[i], i))
      {
        search.found = { square, i };
      }
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
  if (search.improves(toNear, this->Boxes[near.first].low, near.second.begin))
  {
    this->search(near.first, near.second, search);
  }
  if (search.improves(toFar, this->Boxes[far.first].low, far.second.begin))
  {
    this->search(far.first, far.second, search);
  }
}
}
