// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeLanes.h
 * @brief Unit directions of many rays of a beam, and their ranges on one triangle's plane, in SIMD
 * loops.
 *
 * Source: none.
 * Valid: the same bits as unitDirection() and rangeOnPlane() (TriangleTest.h) for every instruction
 * set.
 * Test: TestTriangleTest.cxx, TestApexTriangles.cxx.
 */
#ifndef avianlidar_RangeLanes_h
#define avianlidar_RangeLanes_h

#include "Multiversion.h"
#include "TriangleTest.h"

#include <cstddef>

namespace avianlidar
{
/// unitDirection() for SIMD loops, with the same bits.
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

/// rangeOnPlane() of n rays along unit directions. @param view valid for all of them (viewOfCone())
void planeRanges(PlaneView view, const Corners& corners, const TrianglePlane& plane,
  const double* dx, const double* dy, const double* dz, double* ranges, int* kinds, std::size_t n);
}

#endif
