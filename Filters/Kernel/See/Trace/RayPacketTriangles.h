// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RayPacketTriangles.h
 * @brief Tests the rays of a packet, sixteen at a time (RayLanes.h), against up to eight triangles,
 * in single precision with bounds of the error.
 *
 * All rays of a packet have one apex. Terms that do not depend on the ray are therefore computed
 * once for each triangle (ApexTriangles.h). For a ray along D = axis + tan(theta0.5) (x e1 + y e2),
 * |D| <= sec = 1 / cos(theta0.5), an edge function (TriangleTest.h) is
 *
 *     e = (E . D) / (16 u G |E|_1 + K u_d R^2),   E = a x b,
 *
 * and the inverse of the range along D, in units of |D|, is
 *
 *     w = W . D,   W = n / (n . a),
 *
 * with u = 2^-24, u_d = 2^-53, R the sum of the coordinates' magnitudes of the farthest corner, L
 * the longest side, G = max(1 + sqrt(2) tan(theta0.5), sec) and K = 128 sec + 12 (8 + 14
 * tan(theta0.5)). E, W and D are computed in double precision and rounded once, after all
 * cancellation. Below, *exact* means the test of TriangleTest.h, and *rounded* means this test.
 *
 * - Edges: e >= 1 implies acceptance by the exact test, and e < -1 implies rejection, with a factor
 *   of three to spare in the first term. The rounded E . D has an error below 5 u |E|_1 sec (one u
 *   each of E and D, three of the evaluation) plus 3 u_d R^2 sec (the error of E). The exact test
 *   works in the plane of the ray's own beam, where |e|_1 is at most (1 + sqrt(2) tan(theta0.5))
 *   |E|_1. The exact test has an error below 5 u_d |e|_1 and a tolerance of 4 u_d |e|_1 + 6 (8 + 14
 *   tan(theta0.5)) u_d R^2 (its spread is at most 6 R^2 for a x b). The second part of the
 *   tolerance also bounds the exact test's error of E.
 * - Sign: the bounds above suppose that n . a has one sign in both tests. The error of n . a is 64
 *   u_d L R^2 in the rounded test and below 32 u_d L R^2 in the exact test. Where 128 u_d L R^2 sec
 *   is half of |n . a| or more, e is set to 0 and decides nothing: the apex lies on the triangle,
 *   or in its plane except for rounding. Triangles of |n|_1 <= u_d L^2 keep e: in the exact test
 *   |n| is at most 3 u_d L^2 in every coordinate, and planeOf() accepts no hit below 4 u_d L^2.
 * - Plane: where e >= 1 the plane's range is not clamped (TriangleTest.h). Without clamping, E . d
 *   must be at least 64 u_d R^2 (a x b, L <= 2 R), plus 42 u_d R^2 for the evaluation of E . d in
 *   the exact test. Bounds that decide anything (128 u_d L R^2 / |n . a| < 1e-6) exclude |cos| of
 *   incidence below 2^-27.
 * - Range: `error` bounds the difference of w from the inverse of the exact range along the same
 *   ray. Its parts are 7 u |W|_1 sec for the rounding of w and of w -+ error; 100 u_d L R / |n . a|
 *   for n . d; and, relative to w, 64 u_d L R^2 / |n . a| for n . a, 40 u_d L R^2 / |n . a| for the
 *   exact range (TriangleTest.h), and less than 64 u_d R w for the clamping of this range. 128 u_d
 *   L R / |n . a| bounds the second part. R times this bound covers the next two parts. Parts
 *   relative to w are doubled.
 *
 * Source: none; derived above.
 * Valid: the exact functions decide hits that are neither surely rejected, nor behind the nearest
 * hit so far, nor surely nearer. Such hits are hits of rays within about 2e-6 G rad of an edge (16
 * sqrt(3) u G and the evaluation here), and hits on triangles whose ranges the bounds leave
 * undecided.
 * Test: TestApexTriangles.cxx, TestRayPacket.cxx.
 */
#ifndef avianlidar_RayPacketTriangles_h
#define avianlidar_RayPacketTriangles_h

#include "ApexTriangles.h"
#include "BoxTests.h"

#include <cstdint>

namespace avianlidar
{
/// Nearest hits so far, with bounds of the inverse ranges in units of |D|.
struct alignas(64) PacketBest
{
  float low[PacketWidth], high[PacketWidth];
  std::uint32_t triangle[PacketWidth];
};

/// Up to eight triangles, and the rays that are tested against each triangle.
struct PacketTriangles
{
  static constexpr int Width = ApexTriangles::Batch;
  const ApexTriangle* seen[Width];
  RayBits rays[Width];   ///< rays that meet the leaf; the groups of these rays are tested
  RayBits level[Width];  ///< rays that surely hit, at about the range of the nearest hit so far
  RayBits unsure[Width]; ///< other rays that may hit, for the exact functions to decide
};

/// Test `count` triangles, and put nearest hits that are certain into `best`.
/// @return rays whose nearest hit has changed; `undecided` is true if any ray is level or unsure
RayBits testTriangles(
  const PacketView& view, int count, PacketTriangles& triangles, PacketBest& best, bool& undecided);

/// Update the ranges beyond which no hit counts, for all rays of the groups with a ray in
/// `changed`.
void shortenRays(const PacketBest& best, RayBits changed, PacketView& view);
}

#endif
