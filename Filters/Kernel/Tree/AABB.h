// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AABB.h
 * @brief Axis-aligned bounding box in double precision. An empty box contains no point and changes
 * no box that it is merged with.
 *
 * Source: none.
 * Valid: coordinates up to MaximumCoordinate in magnitude.
 * Test: TestBoundingVolume.cxx.
 */
#ifndef avianlidar_AABB_h
#define avianlidar_AABB_h

#include "Vector.h"

#include <limits>

namespace avianlidar
{
/// Largest coordinate, m. Larger coordinates are refused, because products of three coordinates
/// must be finite.
constexpr double MaximumCoordinate = 1e30;

struct AABB
{
  Vec3 lower{ std::numeric_limits<double>::infinity() };
  Vec3 upper{ -std::numeric_limits<double>::infinity() };
  bool empty() const { return this->lower.x > this->upper.x; }
  /// Extend the box to a point. Coordinates that are NaN are left out.
  void extend(const Vec3& p)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->lower[axis] = p[axis] < this->lower[axis] ? p[axis] : this->lower[axis];
      this->upper[axis] = p[axis] > this->upper[axis] ? p[axis] : this->upper[axis];
    }
  }
  Vec3 center() const { return 0.5 * this->lower + 0.5 * this->upper; }
};

/// The smallest box that holds `a` and `b`.
inline AABB merge(const AABB& a, const AABB& b)
{
  AABB box = a;
  for (int axis = 0; axis < 3; ++axis)
  {
    box.lower[axis] = b.lower[axis] < a.lower[axis] ? b.lower[axis] : a.lower[axis];
    box.upper[axis] = b.upper[axis] > a.upper[axis] ? b.upper[axis] : a.upper[axis];
  }
  return box;
}
}

#endif
