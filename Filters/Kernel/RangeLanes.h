// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeLanes.h
 * @brief Directions and ranges of many rays of a beam at once: the very bits of unitDirection() and
 * rangeOf() (TriangleTest.h).
 */
#ifndef avianlidar_RangeLanes_h
#define avianlidar_RangeLanes_h

#include "TriangleTest.h"

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// unitDirection(frame.direction(x, y)) of n rays.
void unitDirections(const BeamFrame& frame, const double* x, const double* y, double* dx,
  double* dy, double* dz, std::size_t n);

/// Ranges of sixteen rays on a plane, m, those of rangeOf() for rays whose range on the triangle is
/// the plane's (rangeOnPlane(): kind 1). `view` as viewOfCone() has it for all of them.
/// @return rays whose `owner` is `triangle`, one bit each; the ranges of others mean nothing
std::uint32_t planeRanges(PlaneView view, const Corners& corners, const TrianglePlane& plane,
  const std::uint32_t* owner, std::uint32_t triangle, const double* dx, const double* dy,
  const double* dz, double* range);
}

#endif
