// SPDX-License-Identifier: BSD-3-Clause
#include "SplitRule.h"

#include "PrincipalAxes.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>

namespace avianlidar
{
namespace
{
Vec3 twiceCenter(const LaneBox& box)
{
  const Lanes center = box.twiceCenter();
  return { center[0], center[1], center[2] };
}

std::size_t splitInHalves(const LaneBox* from, LaneBox* to, std::size_t count)
{
  std::copy(from, from + count, to);
  return count / 2;
}

std::size_t splitAtMedian(LaneBox* from, LaneBox* to, std::size_t count, int axis)
{
  const std::size_t middle = count / 2;
  // Triangle numbers break ties, so that the sets do not depend on std::nth_element().
  std::nth_element(from, from + middle, from + count,
    [axis](const LaneBox& a, const LaneBox& b)
    {
      const float ca = a.twiceCenter()[axis];
      const float cb = b.twiceCenter()[axis];
      return ca < cb || (ca == cb && a.triangle() < b.triangle());
    });
  return splitInHalves(from, to, count);
}

std::size_t splitAtPrincipalPlane(const LaneBox* from, LaneBox* to, std::size_t count)
{
  const Vec3 reference = twiceCenter(from[0]);
  Vec3 mean(0.0);
  for (std::size_t i = 0; i < count; ++i)
  {
    mean += twiceCenter(from[i]) - reference;
  }
  mean /= static_cast<double>(count);
  glm::dmat3 moments(0.0);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Vec3 off = (twiceCenter(from[i]) - reference) - mean;
    moments += glm::outerProduct(off, off);
  }
  const Vec3 normal = principalAxes(moments)[0];
  const LaneBox* const middle = std::partition_copy(from, from + count, to,
    std::reverse_iterator<LaneBox*>(to + count),
    [&](const LaneBox& box) {
      return glm::dot((twiceCenter(box) - reference) - mean, normal) < 0.0;
    }).first;
  const std::size_t first = static_cast<std::size_t>(middle - to);
  return first < count ? first : 0;
}

constexpr int MostBins = 16;

/// Maps twice the centre of a box to its bin on each axis.
struct BinMapping
{
  using Numbers = std::int32_t __attribute__((vector_size(16)));

  Lanes lower;
  Lanes scale{}; ///< bins per metre; 0 if all centres are equal on this axis
  Lanes last;    ///< number of the last bin
  /// Scale of lengths, 1/m, by which areas fit in floats even in a tiny scene. Where a box is 1e18
  /// times the spread of the centres, areas do not fit and no division is found.
  float unit = 0.0f;
  int bins; ///< number of bins, fewer in a small node, where more bins cost more than they gain

  AVIANLIDAR_ALWAYS_INLINE BinMapping(const LaneBox& centers, std::size_t count)
    : lower(-centers.below)
    , bins(static_cast<int>(std::min<std::size_t>(MostBins, 4 + count / 16)))
  {
    const auto number = static_cast<float>(this->bins);
    this->last = Lanes{} + (number - 1.0f);
    for (int axis = 0; axis < 3; ++axis)
    {
      const float width = centers.above[axis] + centers.below[axis];
      const float perMetre = number / width;
      const bool usable = width > 0.0f && perMetre <= std::numeric_limits<float>::max();
      this->scale[axis] = usable ? perMetre : 0.0f;
      // The widest axis has the fewest bins per metre.
      this->unit = usable && (this->unit == 0.0f || perMetre < this->unit) ? perMetre : this->unit;
    }
  }

  AVIANLIDAR_ALWAYS_INLINE Numbers binsOf(const LaneBox& box) const
  {
    const Lanes at = (box.twiceCenter() - this->lower) * this->scale;
    return __builtin_convertvector(at < this->last ? at : this->last, Numbers);
  }

  /// Half the surface area of a box in units of 1 / unit^2, for comparison.
  AVIANLIDAR_ALWAYS_INLINE float halfArea(const LaneBox& box) const
  {
    const Lanes size = (box.above + box.below) * this->unit;
    const Lanes next{ size[1], size[2], size[0], 0.0f };
    const Lanes product = size * next;
    return product[0] + product[1] + product[2];
  }
};

/// Bins of one axis, merged from one end of the axis on.
struct BinSweep
{
  LaneBox box;
  std::uint32_t number = 0;

  AVIANLIDAR_ALWAYS_INLINE BinSweep() { this->box.clear(); }
  /// Merge one more bin. @return area times number of triangles
  AVIANLIDAR_ALWAYS_INLINE float add(
    const BinMapping& mapping, const LaneBox& bin, std::uint32_t count)
  {
    this->box.include(bin);
    this->number += count;
    return mapping.halfArea(this->box) * static_cast<float>(this->number);
  }
};

/// Boxes in the lower bins of the best axis go to the first child. Axis and bin minimise the sum
/// over both children of area times number of triangles.
AVIANLIDAR_MULTIVERSION std::size_t splitBySurfaceArea(
  const LaneBox* from, LaneBox* to, std::size_t count, const LaneBox& centers)
{
  const BinMapping mapping(centers, count);
  const int bins = mapping.bins;
  LaneBox box[3][MostBins];
  std::uint32_t number[3][MostBins];
  for (int axis = 0; axis < 3; ++axis)
  {
    for (int bin = 0; bin < bins; ++bin)
    {
      box[axis][bin].clear();
      number[axis][bin] = 0;
    }
  }
  // One register of AVX holds both corners of a box. Boxes are aligned as one corner is, so that
  // registers are copied from and to them.
  using Both = float __attribute__((vector_size(sizeof(LaneBox))));
  for (std::size_t i = 0; i < count; ++i)
  {
    const BinMapping::Numbers bin = mapping.binsOf(from[i]);
    Both own;
    std::memcpy(&own, &from[i], sizeof(own));
    for (int axis = 0; axis < 3; ++axis)
    {
      LaneBox& sum = box[axis][bin[axis]];
      Both both;
      std::memcpy(&both, &sum, sizeof(both));
      both = both > own ? both : own;
      std::memcpy(&sum, &both, sizeof(both));
      ++number[axis][bin[axis]];
    }
  }
  float least = std::numeric_limits<float>::infinity();
  int bestAxis = 0;
  int bestBin = 0;
  std::size_t toFirst = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    if (mapping.scale[axis] > 0.0f)
    {
      // The outermost bins are never empty.
      float above[MostBins];
      BinSweep down;
      for (int bin = bins - 1; bin > 0; --bin)
      {
        above[bin] = down.add(mapping, box[axis][bin], number[axis][bin]);
      }
      BinSweep up;
      for (int bin = 1; bin < bins; ++bin)
      {
        const float cost = up.add(mapping, box[axis][bin - 1], number[axis][bin - 1]) + above[bin];
        if (cost < least)
        {
          least = cost;
          bestAxis = axis;
          bestBin = bin;
          toFirst = up.number;
        }
      }
    }
  }
  std::size_t first = 0;
  std::size_t second = toFirst;
  for (std::size_t i = 0; toFirst > 0 && i < count; ++i)
  {
    // The choice has no branch, because the side of a box cannot be predicted.
    const std::size_t goesFirst = mapping.binsOf(from[i])[bestAxis] < bestBin ? 1 : 0;
    to[second ^ ((first ^ second) & (0 - goesFirst))] = from[i];
    first += goesFirst;
    second += 1 - goesFirst;
  }
  return toFirst;
}
}

std::size_t splitTriangles(SplitRule rule, LaneBox* from, LaneBox* to, std::size_t count,
  const LaneBox& centers, std::uint32_t depth)
{
  constexpr std::uint32_t deepest = 96;
  rule = depth < deepest ? rule : SplitRule::Halves;
  const std::size_t first = rule == SplitRule::Median
    ? splitAtMedian(from, to, count, static_cast<int>(depth % 3))
    : rule == SplitRule::PrincipalPlane       ? splitAtPrincipalPlane(from, to, count)
    : rule == SplitRule::SurfaceAreaHeuristic ? splitBySurfaceArea(from, to, count, centers)
                                              : 0;
  return first > 0 ? first : splitInHalves(from, to, count);
}
}
