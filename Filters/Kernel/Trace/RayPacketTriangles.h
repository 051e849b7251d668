// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayPacketTriangles.h
 * @brief The rays of a packet against up to eight triangles, in single precision with bounds of the
 * error, sixteen rays at a time (RayLanes.h).
 *
 * All rays have the same apex, so what does not depend on the ray is found once for a triangle
 * (ApexTriangles.h). An edge function (TriangleTest.h) along the ray's direction
 * D = axis + tan(theta0.5) (x e1 + y e2), |D| <= sec = 1 / cos(theta0.5), is
 *
 *     e = (E . D) / (16 u G |E|_1 + K u_d R^2),   E = a x b,
 *
 * and the inverse of the range along D, in units of |D|,
 *
 *     w = W . D,   W = n / (n . a),
 *
 * with u = 2^-24, u_d = 2^-53, R the sum of the coordinates' magnitudes of the farthest corner,
 * G = max(1 + sqrt(2) tan(theta0.5), sec) and K = 128 sec + 12 (8 + 14 tan(theta0.5)). E, W and D
 * are computed in double precision and rounded once, after everything has cancelled. Then:
 *
 * - E . D here has an error below 5 u |E|_1 sec (one u each of E and D, three of the evaluation)
 * and 3 u_d R^2 sec (of E). The exact test works in the plane of the ray's own beam, where |e|_1 is
 * at most (1 + sqrt(2) tan(theta0.5)) |E|_1, with an error below 5 u_d of it and a tolerance of 4
 * u_d of it + 6 (8 + 14 tan(theta0.5)) u_d R^2 (the spread of TriangleTest.h is at most 6 R^2 for a
 * x b); the tolerance's second part also bounds the error of E there. So e >= 1 implies acceptance,
 * and e < -1 rejection, with a factor of three to spare in the first term.
 * - Both suppose that n . a has the same sign here and there. Where 128 u_d L R^2 sec is half of |n
 * . a| or more (errors: 64 u_d L R^2 here, below 32 there), e is set to 0 and decides nothing. This
 * is the case of an apex on the triangle, or in its plane but for rounding. Triangles of |n|_1 <=
 * u_d L^2 here keep their e: there |n| is at most 3 u_d L^2 in every coordinate then, and planeOf()
 * accepts no hit of a triangle below 4 u_d L^2.
 * - Where e >= 1 the plane's range stands, too (TriangleTest.h): that needs E . d of 64 u_d R^2
 * (a x b, L <= 2 R) and 42 u_d R^2 for its evaluation there, and bounds that decide anything
 * (128 u_d L R^2 / |n . a| below 1e-6) exclude |cos| of incidence below 2^-27.
 * - w differs from the inverse of the exact range along the same ray by at most `error`: over |W|_1
 * sec, 7 u for its own rounding and that of w -+ error; n . d here (100 u_d R L, L the longest
 * side); and, over |n . a| and relative to w, n . a here (64 u_d L R^2), the exact range (40 u_d L
 * R^2, see TriangleTest.h) and its clamping (less than 64 u_d R w |n . a|). 128 u_d L R / |n . a|
 * bounds the second and, times R, the next two; what is relative to w is doubled.
 *
 * Source: none; derived above.
 * Valid: what is neither surely rejected, nor behind the nearest hit so far, nor surely nearer is
 * left to the exact functions: rays within about 2e-6 G rad of an edge (16 sqrt(3) u G and the
 * evaluation here), and those of a triangle for whose range these bounds decide nothing.
 * Test: TestApexTriangles.cxx, TestRayPacket.cxx.
 */
#ifndef avianlidar_RayPacketTriangles_h
#define avianlidar_RayPacketTriangles_h

#include "ApexTriangles.h"
#include "BoxTests.h"

#include <cstdint>

namespace avianlidar
{
/// Nearest hits so far: bounds of their inverse ranges, in units of |D|.
struct alignas(64) PacketBest
{
  float low[PacketWidth], high[PacketWidth];
  std::uint32_t triangle[PacketWidth];
};

/// Up to eight triangles.
struct PacketTriangles
{
  static constexpr int Width = ApexTriangles::Batch;
  const ApexTriangle* seen[Width];
  RayBits rays[Width];   ///< rays that meet the leaf; their groups are tested
  RayBits level[Width];  ///< rays that surely hit it, about as far away as their nearest hit so far
  RayBits unsure[Width]; ///< other rays, which the exact functions decide
};

/// Test `count` triangles; nearest hits that are certain go to `best`.
/// @return rays whose nearest hit has changed; `undecided` if any is level or unsure
RayBits testTriangles(
  const PacketView& view, int count, PacketTriangles& triangles, PacketBest& best, bool& undecided);

/// Update the ranges beyond which no hit counts, for the groups of the rays in `changed`.
void shortenRays(const PacketBest& best, RayBits changed, PacketView& view);
}

#endif
