// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayPacketTriangles.h
 * @brief The rays of a packet against eight triangles, in single precision with bounds of the
 * error: loops over lanes.
 *
 * In the packet's own plane a ray is (u, v), |u|, |v| <= 1, and its direction is along
 * c + sigma (u p + v q), with p, q, c orthonormal. An edge function (TriangleTest.h) is
 *
 *     e = ex u + ey v + ez,   (ex, ey, ez) = (sigma p . E, sigma q . E, c . E) / S,   E = a x b,
 *
 * S = |sigma p . E| + |sigma q . E| + |c . E|, so |e| <= 1, and the inverse of the depth along c is
 *
 *     w = wx u + wy v + wz,   (wx, wy, wz) = (sigma p . n, sigma q . n, c . n) / (n . a).
 *
 * Corners are turned to p, q, c in double, and what follows from them is rounded to single once
 * nothing cancels any more. With u = 2^-24, u_d = 2^-53 and R the sum of the coordinates'
 * magnitudes of the farthest corner:
 *
 * - e here has an error below 6 u + 16 u_d R^2 / S: 2 u of the coefficients, u of (u, v), 3 u of
 * the evaluation. The exact test works in the ray's own beam, where |e|_1 is at most G S times the
 * depth of the ray (G is near 1, see PacketPlane, and at least 1 in the beam's own plane), with an
 * error below 5 u G and a tolerance of 4.001 u G + 6 (8 + 14 tan(theta0.5)) u_d R^2 / S (the spread
 * of TriangleTest.h is at most 6 R^2 for a x b); the tolerance's second part also bounds the error
 * of E. So e >= 16 u G + noise implies acceptance, and e < -(15.1 u G + noise) rejection, in either
 * precision, with noise = (128 / least cosine + 12 (8 + 14 tan(theta0.5))) u_d R^2 / S. A triangle
 * is beside all rays where its greatest e for |u|, |v| <= 1 is that low; rays of a beam may leave
 * that square by 8.4 u, so 24 u G is taken.
 * - w differs from the inverse of the exact range along the same ray by at most `error`: 7 u for
 * its own rounding and that of w -+ error; n . d here (100 u_d R L, L the longest side); and, over
 * |n . a| and relative to w, n . a here (64 u_d L R^2), the exact range (40 u_d L R^2, see
 * TriangleTest.h) and its clamping (less than 64 u_d R w |n . a|). 128 u_d L R / |n . a| bounds the
 * second and, times R, the next two; what is relative to w is doubled.
 * - Where e >= 16 u G + noise the plane's range stands, too (TriangleTest.h): that needs E . d of
 * 64 u_d R^2 (a x b, L <= 2 R) and 42 u_d R^2 for its evaluation there, and bounds that say
 * anything (128 u_d L R^2 / |n . a| below 1e-6) exclude |cos| of incidence below 2^-27.
 *
 * What is neither surely rejected, nor behind what is known, nor surely the nearest is left to the
 * exact functions; so is every ray not beside a triangle for which these bounds say nothing.
 */
#ifndef avianlidar_RayPacketTriangles_h
#define avianlidar_RayPacketTriangles_h

#include "RayPacketBoxes.h"
#include "TriangleTest.h"

#include <cstdint>

namespace avianlidar
{
/// What triangles need to know of a packet.
struct alignas(64) PacketPlane
{
  float u[PacketWidth], v[PacketWidth];
  float cosine[PacketWidth]; ///< of the angle between ray and c
  Vec3 apex;
  Vec3 p, q, c;
  double sigma;
  double leastCosine;
  double gain;        ///< G, see the file comment
  double exactSpread; ///< 8 + 14 tan(theta0.5) of the widest beam

  /// @param frames the beam of each ray; all with the same apex
  void set(const PacketView& view, const PacketDirections& rays, const BeamFrame* const* frames);

  /// The same for rays of one beam, in the beam's own plane.
  void set(const BeamFrame& beam, const double* x, const double* y, int padded);
};

/// The nearest hits so far, as inverse depths along c.
struct alignas(64) PacketBest
{
  float low[PacketWidth], high[PacketWidth];
  std::uint32_t triangle[PacketWidth];
};

/// Up to eight triangles: corners in scene coordinates, m.
struct alignas(64) PacketTriangles
{
  static constexpr int Width = 8;
  double corner[3][3][Width]; ///< corner, coordinate
  std::uint32_t id[Width];
  RayBits rays[Width];      ///< those that meet the leaf: their groups are tested
  std::uint32_t candidates; ///< triangles not beside all rays, one bit each
  RayBits unsure[Width];    ///< of a candidate: rays that the exact functions have to decide
};

/// Test `count` triangles: the nearest hits that are sure go to `best`.
/// @return rays whose nearest hit has changed; `anyUnsure` if any was left undecided
RayBits testTriangles(const PacketPlane& plane, int count, PacketTriangles& triangles,
  PacketBest& best, bool& anyUnsure);

/// Ranges beyond which no hit counts for a ray, and the farthest of them.
float shortenRays(const PacketPlane& plane, const PacketBest& best, int padded, PacketView& view);

/// Corners of the triangle that each ray hits, relative to the apex.
struct alignas(64) PacketCorners
{
  double corner[3][3][PacketWidth];
};

/// Range of each ray on its own triangle, one that surely counts for it: that of rangeOf(), to the
/// bit.
void rangesOnTriangles(const PacketCorners& corners, const PacketDirections& rays, double* range);
}

#endif
