// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeLanes.h
 * @brief Unit directions of many rays of a beam, and their ranges on one triangle's plane, in SIMD
 * loops.
 *
 * Source: none.
 * Valid: bitwise identical to unitDirection() and rangeOnPlane() (TriangleTest.h) for every
 * instruction set.
 * Test: TestTriangleTest.cxx, TestApexTriangles.cxx.
 */
#ifndef avianlidar_RangeLanes_h
#define avianlidar_RangeLanes_h

#include "TriangleTest.h"

#include <cstddef>

namespace avianlidar
{
/// Find unitDirection(frame.direction(x, y)) of n rays.
void unitDirections(const BeamFrame& frame, const double* x, const double* y, double* dx,
  double* dy, double* dz, std::size_t n);

/// Find rangeOnPlane() of n rays along unit directions. @param view valid for all n rays
/// (viewOfCone())
void planeRanges(PlaneView view, const Corners& corners, const TrianglePlane& plane,
  const double* dx, const double* dy, const double* dz, double* ranges, int* kinds, std::size_t n);
}

#endif
