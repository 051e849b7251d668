// SPDX-License-Identifier: BSD-3-Clause
#include "SplitRule.h"

#include <algorithm>
#include <array>
#include <limits>

namespace avianlidar
{
namespace
{
/// One node's triangles.
struct Range
{
  const std::vector<AABB>& boxes;
  std::uint32_t* order;
  std::size_t count;

  Vec3 center(std::size_t i) const { return this->boxes[this->order[i]].center(); }

  /// Move the triangles for which `goesFirst` holds to the front; halve the list if that leaves a
  /// side empty.
  template <class F>
  std::size_t partition(F&& goesFirst) const
  {
    const std::uint32_t* middle = std::partition(this->order, this->order + this->count, goesFirst);
    const std::size_t first = static_cast<std::size_t>(middle - this->order);
    return first > 0 && first < this->count ? first : this->count / 2;
  }
};

std::size_t splitAtMedian(const Range& range, int axis)
{
  const std::size_t middle = range.count / 2;
  // The number settles ties, so that the two sets do not depend on the library's selection
  // algorithm.
  std::nth_element(range.order, range.order + middle, range.order + range.count,
    [&](std::uint32_t a, std::uint32_t b)
    {
      const double ca = range.boxes[a].center()[axis];
      const double cb = range.boxes[b].center()[axis];
      return ca < cb || (ca == cb && a < b);
    });
  return middle;
}

std::size_t splitAtPrincipalPlane(const Range& range)
{
  const Vec3 reference = range.center(0);
  Vec3 mean(0.0);
  for (std::size_t i = 0; i < range.count; ++i)
  {
    mean += range.center(i) - reference;
  }
  mean /= static_cast<double>(range.count);
  SecondMoments moments;
  for (std::size_t i = 0; i < range.count; ++i)
  {
    moments.add((range.center(i) - reference) - mean);
  }
  const Vec3 normal = principalAxes(moments.sums)[0];
  return range.partition([&](std::uint32_t triangle)
    { return glm::dot((range.boxes[triangle].center() - reference) - mean, normal) < 0.0; });
}

/// Binned surface area heuristic: Wald, "On fast Construction of SAH-based Bounding Volume
/// Hierarchies", 2007.
class BinnedHeuristic
{
public:
  explicit BinnedHeuristic(const Range& range)
    : Triangles(range)
    // More bins than triangles cost more than they part.
    , Bins(static_cast<int>(std::clamp<std::size_t>(range.count, 4, MostBins)))
  {
    for (std::size_t i = 0; i < range.count; ++i)
    {
      this->Centers.extend(range.center(i));
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      const double width = this->Centers.upper[axis] - this->Centers.lower[axis];
      const double scale = this->Bins / width;
      this->Scale[axis] = width > 0.0 && std::isfinite(scale) ? scale : 0.0;
    }
  }

  std::size_t split()
  {
    this->fillBins();
    for (int axis = 0; axis < 3; ++axis)
    {
      if (this->Scale[axis] > 0.0)
      {
        this->tryAxis(axis);
      }
    }
    if (this->BestAxis < 0)
    {
      return this->Triangles.count / 2;
    }
    return this->Triangles.partition(
      [this](std::uint32_t triangle) {
        return this->binOf(this->Triangles.boxes[triangle].center(), this->BestAxis) <
          this->BestBin;
      });
  }

private:
  static constexpr int MostBins = 16;

  int binOf(const Vec3& center, int axis) const
  {
    const int bin =
      static_cast<int>((center[axis] - this->Centers.lower[axis]) * this->Scale[axis]);
    return bin < this->Bins ? bin : this->Bins - 1;
  }

  /// One pass over the triangles for all three axes.
  void fillBins()
  {
    for (std::size_t i = 0; i < this->Triangles.count; ++i)
    {
      const AABB& box = this->Triangles.boxes[this->Triangles.order[i]];
      const Vec3 center = box.center();
      for (int axis = 0; axis < 3; ++axis)
      {
        const int bin = this->binOf(center, axis);
        this->Box[axis][bin] = merge(this->Box[axis][bin], box);
        ++this->Number[axis][bin];
      }
    }
  }

  void tryAxis(int axis)
  {
    const auto& box = this->Box[axis];
    const auto& number = this->Number[axis];
    std::array<double, MostBins> costBelow{};
    AABB sweep;
    std::size_t count = 0;
    for (int bin = 1; bin < this->Bins; ++bin)
    {
      sweep = merge(sweep, box[bin - 1]);
      count += number[bin - 1];
      costBelow[bin] = surfaceArea(sweep) * static_cast<double>(count);
    }
    sweep = AABB();
    count = 0;
    for (int bin = this->Bins - 1; bin > 0; --bin)
    {
      sweep = merge(sweep, box[bin]);
      count += number[bin];
      const double cost = costBelow[bin] + surfaceArea(sweep) * static_cast<double>(count);
      if (count > 0 && count < this->Triangles.count && cost < this->BestCost)
      {
        this->BestCost = cost;
        this->BestAxis = axis;
        this->BestBin = bin;
      }
    }
  }

  const Range& Triangles;
  int Bins;
  AABB Centers;
  Vec3 Scale{ 0.0 }; ///< bins per metre
  std::array<std::array<AABB, MostBins>, 3> Box;
  std::array<std::array<std::size_t, MostBins>, 3> Number{};
  double BestCost = std::numeric_limits<double>::infinity();
  int BestAxis = -1;
  int BestBin = 0;
};
}

std::size_t splitTriangles(SplitRule rule, const std::vector<AABB>& boxes, std::uint32_t* order,
  std::size_t count, std::uint32_t depth)
{
  const Range range{ boxes, order, count };
  switch (rule)
  {
    case SplitRule::Median:
      return splitAtMedian(range, static_cast<int>(depth % 3));
    case SplitRule::PrincipalPlane:
      return splitAtPrincipalPlane(range);
    case SplitRule::SurfaceAreaHeuristic:
      return BinnedHeuristic(range).split();
    case SplitRule::Halves:
      break;
  }
  return count / 2;
}
}
