// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PointTree.h
 * @brief The nearest of many points, in about log n steps however they are spread.
 *
 * A balanced tree of boxes: each node halves its points along the longest side of their box, down
 * to a few points. (A grid of equal cells would be empty except for one if a single point lay far
 * away.)
 *
 * Source: none.
 * Valid: finite points. The result is the least of all squares (dx dx + dy dy) + dz dz as
 * computed, in any order of the points: rounding is monotonic, so no box is farther than a point
 * in it. Which place is the nearest does not depend on that order, either.
 * Test: TestPointTree.cxx.
 */
#ifndef avianlidar_PointTree_h
#define avianlidar_PointTree_h

#include "Vector.h"

#include <cstddef>
#include <vector>

namespace avianlidar
{
class PointTree
{
public:
  struct Nearest
  {
    double square;     ///< of the distance, m2; infinity if there is no point
    std::size_t index; ///< in points(); 0 if there is none
  };

  /// @param points m, finite
  explicit PointTree(std::vector<Vec3> points);

  /// The points in the order of the tree, which the order given decides.
  const std::vector<Vec3>& points() const { return this->Points; }

  /// The point nearest to a finite place. Of equally near ones the one with the least x, then y,
  /// then z; of several in one place always the same.
  /// @param taken if given, the number of distances computed is added
  Nearest nearest(const Vec3& place, std::size_t* taken = nullptr) const;

  /// Square of the distance (m2) of a finite place to the nearest point, infinity if there is none.
  /// @param taken if given, the number of distances computed is added
  double nearestSquare(const Vec3& place, std::size_t* taken = nullptr) const
  {
    return this->nearest(place, taken).square;
  }

private:
  /// Points [begin, end); those of a node with children are split in the middle.
  struct Range
  {
    std::size_t begin;
    std::size_t end;
  };
  struct Box
  {
    Vec3 low;
    Vec3 high;
  };
  struct Search;

  void build(std::size_t node, Range range);
  void search(std::size_t node, Range range, Search& search) const;

  std::vector<Vec3> Points; ///< those of each node side by side
  std::vector<Box> Boxes;   ///< the children of node i are 2 i + 1 and 2 i + 2
};
}

#endif
