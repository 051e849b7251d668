// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SplitRule.h
 * @brief How the triangles of a node are divided between its two children: four rules, and the
 * bins of the surface area heuristic.
 *
 * The rules use only the triangles' boxes and their centres. All are deterministic.
 *
 * The binned heuristic makes one pass over a node's boxes that merges each with one bin on each
 * axis, one over the bins, and one that separates the boxes. Bins of parts of a node can be filled
 * separately and merged: merging takes the larger of two numbers, so the result does not depend on
 * how the node was cut. These parts are inlined, to be compiled for the instruction set of the
 * caller (Multiversion.h).
 *
 * Source: paper, Sec. 3.1, Algorithm 1, line 9; for the surface area heuristic I. Wald, "On fast
 * Construction of SAH-based Bounding Volume Hierarchies", IEEE Symposium on Interactive Ray
 * Tracing, 2007.
 * Differs: the surface area heuristic is not in the paper. Few triangles take few bins, 4 to 16.
 * Valid: boxes are in single precision relative to the middle of the scene. Triangles smaller than
 * the roundings there may be divided differently than exact centres would be; this costs a little
 * time and changes no hit.
 * Test: TestSplitRule.cxx, TestCollisionTreeBuilder.cxx.
 */
#ifndef avianlidar_SplitRule_h
#define avianlidar_SplitRule_h

#include "CollisionTree.h"
#include "TriangleBoxes.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace avianlidar
{
constexpr int MostBins = 16;

/// Maps twice the centre of a box to its bin on each axis.
struct BinMapping
{
  using Numbers = std::int32_t __attribute__((vector_size(16)));

  Lanes lower;
  Lanes scale; ///< bins per metre; 0: all centres are equal on this axis
  Lanes last;  ///< number of the last bin
  /// 1/m: scaled by it, areas can be held in floats, even in a tiny scene. Where a box is 1e18
  /// times as large as the spread of the centres they cannot, and there is nothing to divide by.
  float unit;
  int bins;

  /// Few triangles take few bins: more would cost more than they gain.
  AVIANLIDAR_ALWAYS_INLINE void set(const LaneBox& centers, std::size_t count)
  {
    this->bins = static_cast<int>(std::min<std::size_t>(MostBins, 4 + count / 16));
    const auto number = static_cast<float>(this->bins);
    this->lower = -centers.below;
    this->last = Lanes{} + (number - 1.0f);
    this->scale = Lanes{};
    this->unit = 0.0f;
    for (int axis = 0; axis < 3; ++axis)
    {
      const float width = centers.above[axis] + centers.below[axis];
      const float perMetre = number / width;
      const bool usable = width > 0.0f && perMetre <= std::numeric_limits<float>::max();
      this->scale[axis] = usable ? perMetre : 0.0f;
      // Of the widest axis.
      this->unit = usable && (this->unit == 0.0f || perMetre < this->unit) ? perMetre : this->unit;
    }
  }

  AVIANLIDAR_ALWAYS_INLINE Numbers binsOf(const LaneBox& box) const
  {
    const Lanes at = (box.twiceCenter() - this->lower) * this->scale;
    return __builtin_convertvector(at < this->last ? at : this->last, Numbers);
  }
};

/// Half the surface area, scaled, for comparison.
AVIANLIDAR_ALWAYS_INLINE float halfArea(const LaneBox& box, float unit)
{
  const Lanes size = (box.above + box.below) * unit;
  const Lanes next{ size[1], size[2], size[0], 0.0f };
  const Lanes product = size * next;
  return product[0] + product[1] + product[2];
}

/// Where a node is divided: boxes in lower bins of the axis go to the first child.
struct BinChoice
{
  int axis = -1; ///< -1: nothing to divide by
  int bin = 0;
};

struct Bins
{
  LaneBox box[3][MostBins];
  std::uint32_t number[3][MostBins];

  AVIANLIDAR_ALWAYS_INLINE void clear(int bins)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int bin = 0; bin < bins; ++bin)
      {
        this->box[axis][bin].clear();
        this->number[axis][bin] = 0;
      }
    }
  }

  AVIANLIDAR_ALWAYS_INLINE void add(
    const BinMapping& mapping, const LaneBox* boxes, std::size_t count)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      const BinMapping::Numbers bin = mapping.binsOf(boxes[i]);
      for (int axis = 0; axis < 3; ++axis)
      {
        this->box[axis][bin[axis]].include(boxes[i]);
        ++this->number[axis][bin[axis]];
      }
    }
  }

  AVIANLIDAR_ALWAYS_INLINE void add(const Bins& other, int bins)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      for (int bin = 0; bin < bins; ++bin)
      {
        this->box[axis][bin].include(other.box[axis][bin]);
        this->number[axis][bin] += other.number[axis][bin];
      }
    }
  }

  /// Number of boxes below the place of division.
  AVIANLIDAR_ALWAYS_INLINE std::uint32_t below(const BinChoice& choice) const
  {
    std::uint32_t sum = 0;
    for (int bin = 0; bin < choice.bin; ++bin)
    {
      sum += this->number[choice.axis][bin];
    }
    return sum;
  }

  /// The place where the sum of area times number is least.
  AVIANLIDAR_ALWAYS_INLINE BinChoice choose(const BinMapping& mapping) const
  {
    BinChoice best;
    float least = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis)
    {
      if (mapping.scale[axis] > 0.0f)
      {
        this->tryAxis(axis, mapping, least, best);
      }
    }
    return best;
  }

private:
  AVIANLIDAR_ALWAYS_INLINE void tryAxis(
    int axis, const BinMapping& mapping, float& least, BinChoice& best) const
  {
    const int bins = mapping.bins;
    // The outermost bins are never empty.
    float above[MostBins];
    LaneBox sweep = this->box[axis][bins - 1];
    std::uint32_t count = this->number[axis][bins - 1];
    for (int bin = bins - 1;; --bin)
    {
      above[bin] = halfArea(sweep, mapping.unit) * static_cast<float>(count);
      if (bin == 1)
      {
        break;
      }
      sweep.include(this->box[axis][bin - 1]);
      count += this->number[axis][bin - 1];
    }
    sweep = this->box[axis][0];
    count = this->number[axis][0];
    for (int bin = 1; bin < bins; ++bin)
    {
      const float cost = halfArea(sweep, mapping.unit) * static_cast<float>(count) + above[bin];
      if (cost < least)
      {
        least = cost;
        best.axis = axis;
        best.bin = bin;
      }
      sweep.include(this->box[axis][bin]);
      count += this->number[axis][bin];
    }
  }
};

/// Copy boxes to their places in `to`, in their order: the first child's from `first` on, the
/// others from `second` on.
AVIANLIDAR_ALWAYS_INLINE void part(const BinMapping& mapping, const BinChoice& choice,
  const LaneBox* from, std::size_t count, LaneBox* to, std::size_t first, std::size_t second)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    // No branch: the side of a box cannot be predicted.
    const std::size_t goesFirst = mapping.binsOf(from[i])[choice.axis] < choice.bin ? 1 : 0;
    to[second ^ ((first ^ second) & (0 - goesFirst))] = from[i];
    first += goesFirst;
    second += 1 - goesFirst;
  }
}

/// Copy `from[0 .. count)` (count >= 2) to `to` so that its first part goes to the first child.
/// @param from may be reordered
/// @param centers box of twice their centres
/// @param depth of the node, root 0: chooses the axis of SplitRule::Median
/// @return size of the first part, in [1, count - 1]. Where a rule finds nothing to divide by
/// (equal centres), the list is halved as it stands.
std::size_t splitTriangles(SplitRule rule, LaneBox* from, LaneBox* to, std::size_t count,
  const LaneBox& centers, std::uint32_t depth);
}

#endif
