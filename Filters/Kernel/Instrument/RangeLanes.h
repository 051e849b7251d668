// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeLanes.h
 * @brief Directions and ranges of many rays of a beam at once: the very bits of unitDirection() and
 * rangeOf() (TriangleTest.h).
 */
#ifndef avianlidar_RangeLanes_h
#define avianlidar_RangeLanes_h

#include "Multiversion.h"
#include "TriangleTest.h"

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// unitDirection() for loops over lanes, to the bit.
AVIANLIDAR_ALWAYS_INLINE void unitDirectionOf(
  double x, double y, double z, double& dx, double& dy, double& dz)
{
  const double ax = std::fabs(x);
  const double ay = std::fabs(y);
  const double az = std::fabs(z);
  const double ayz = ay > az ? ay : az;
  const double scale = inversePowerOfTwo(ax > ayz ? ax : ayz);
  const double sx = x * scale;
  const double sy = y * scale;
  const double sz = z * scale;
  const double inverse = 1.0 / std::sqrt((sx * sx + sy * sy) + sz * sz);
  dx = sx * inverse;
  dy = sy * inverse;
  dz = sz * inverse;
}

/// unitDirection(frame.direction(x, y)) of n rays.
void unitDirections(const BeamFrame& frame, const double* x, const double* y, double* dx,
  double* dy, double* dz, std::size_t n);

/// Ranges on a plane of those of sixteen rays that are among `rays` (one bit each) and whose
/// `owner` is `triangle`, m: those of rangeOf() if the range on the triangle is the plane's
/// (rangeOnPlane(): kind 1). `view` as viewOfCone() has it for all sixteen.
/// @return these rays; triangle and range of the others are left as they are
std::uint32_t planeHits(PlaneView view, const Corners& corners, const TrianglePlane& plane,
  std::uint32_t rays, const std::uint32_t* owner, std::uint32_t triangle, const double* dx,
  const double* dy, const double* dz, std::uint32_t* hit, double* range);

/// Corners of the triangle that each ray hits, relative to the apex, m.
struct alignas(64) CornerLanes
{
  static constexpr int Width = 64;
  double corner[3][3][Width]; ///< corner, coordinate
};

/// Range of each of `count` rays on its own triangle, one that surely counts for it: that of
/// rangeOf(), to the bit.
void rangesOnTriangles(const CornerLanes& corners, int count, const double* dx, const double* dy,
  const double* dz, double* range);
}

#endif
