// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TriangleLanes.h
 * @brief The triangle test of TriangleTest.h for whole beams: eight triangles at a time are
 * prepared, then all rays of the beam are tested against one.
 *
 * Every lane does the arithmetic of BeamTriangle, beamRayAccepted() and rangeOf(), operation by
 * operation: the same bits as one ray against one triangle.
 */
#ifndef avianlidar_TriangleLanes_h
#define avianlidar_TriangleLanes_h

#include "TriangleTest.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Rays of a beam and what they have hit so far, padded to whole lanes; padding is never accepted.
template <typename Real>
struct RayLanes
{
  static constexpr std::size_t Group = 16; ///< rays looked at together

  std::size_t count = 0;  ///< rays
  std::size_t padded = 0; ///< multiple of Group
  std::vector<Real> x, y; ///< in the beam's plane
  std::vector<Real> slack;
  std::vector<double> dx, dy, dz; ///< unit directions
  std::vector<double> range;      ///< nearest so far, infinity: none
  std::vector<double> second; ///< plane's range of slivers that need a second look, else NoRange
  std::vector<std::uint64_t> triangle;

  /// Take the rays of a beam; nothing hit yet.
  void set(const BeamFrame& frame, const double* rayX, const double* rayY, std::size_t rays);

  /// The farthest of the nearest hits of rays [begin, end).
  double farthest(std::size_t begin, std::size_t end) const;
};

/// Up to eight triangles in the beam's frame.
template <typename Real>
struct TriangleLanes
{
  static constexpr int Width = 8;

  std::uint32_t id[Width];
  double ax[Width], ay[Width], az[Width];
  double bx[Width], by[Width], bz[Width];
  double cx[Width], cy[Width], cz[Width];

  // Found by prepare(): edge functions as in BeamEdge, and whether some ray may be inside.
  Real x[3][Width], y[3][Width], z[3][Width], tolerance[3][Width];
  int candidate[Width];

  void put(int lane, std::uint32_t triangle, const Corners& corners);
  Corners corners(int lane) const
  {
    return { Vec3(this->ax[lane], this->ay[lane], this->az[lane]),
      Vec3(this->bx[lane], this->by[lane], this->bz[lane]),
      Vec3(this->cx[lane], this->cy[lane], this->cz[lane]) };
  }

  /// Edge functions of all lanes, filled or not.
  void prepare(const BeamPlaneMap& map);
};

/// Consecutive rays and a cone that holds them.
struct RayBundle
{
  std::size_t begin = 0; ///< multiple of RayLanes::Group
  std::size_t end = 0;   ///< multiple of RayLanes::Group
  Vec3 axis{ 0.0 };
  double sine = 0.0; ///< of the cone's half-angle
  double cosine = 1.0;
  double angularMargin = 0.0; ///< beamRayMargin() of the beam
};

/// The least slack over the three edges of one lane for rays [begin, end); true if any ray is
/// accepted.
template <typename Real>
bool testRays(const TriangleLanes<Real>& triangles, int lane, RayLanes<Real>& rays,
  std::size_t begin, std::size_t end);

/// Ranges of the accepted rays of a bundle on their triangle, kept where they are the nearest so
/// far.
/// @return rays that had no hit before and have one now; `changed` if any nearest hit changed
template <typename Real>
std::size_t takeRanges(const Corners& corners, std::uint32_t triangle, const RayBundle& bundle,
  RayLanes<Real>& rays, bool& changed);
}

#endif
