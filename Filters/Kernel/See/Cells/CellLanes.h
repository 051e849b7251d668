// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CellLanes.h
 * @brief The two inner loops of BeamCells.h, in SIMD lanes: tests of a list of surfaces against
 * sixteen cells, and against sixteen rays.
 *
 * Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988.
 * Differs: single precision in the beam's plane, whose coordinates are at most 1 in the disc. The
 * coefficients of a side that two triangles share have opposite signs in the two triangles, bit for
 * bit, so no ray passes between the triangles.
 * Valid: sides are accurate to 1e-6 half-beamwidths. Surfaces whose 1/z (BeamTriangles.h) differ by
 * less than CellSurface::slack may be seen in the wrong order. Products are not fused with sums, so
 * all instruction sets give the same bits.
 * Test: TestBeamCells.cxx, InstructionSets.cxx.
 */
#ifndef avianlidar_CellLanes_h
#define avianlidar_CellLanes_h

#include <cstdint>

namespace avianlidar
{
constexpr int CellLanes = 16;

/// A BeamSurface in single precision. Sides that do not meet the disc are (0, 0, 1).
struct CellSurface
{
  float lines[4][3];  ///< coefficients x, y and z of each side's PlaneLine
  float slopes[4];    ///< |x| + |y| of each side
  float inverse[3];   ///< PlaneLine of 1/z, divided by the largest 1/z in the beam
  float inverseSlope; ///< |x| + |y| of `inverse`
  float most;         ///< upper bound of `inverse`
  float slack;        ///< bound of the rounding of `inverse`
  float share;        ///< share of the beam filled by the surface's small object; 0: not small
  float foot[2];      ///< foot of the apex's perpendicular (middle of the lobe), half-beamwidths
};

/// Sixteen children of a cell, four by four.
struct CellChildren
{
  float x, y, width; ///< corner of the first child, and side of a child, half-beamwidths
  /// For each child, the least CellSurface::inverse of the nearest surface that covers the child;
  /// infinity: the child is skipped.
  float occluders[CellLanes];
  std::uint32_t counts[CellLanes]; ///< lengths of `lists`
  std::uint32_t* lists[CellLanes]; ///< surfaces of each child; each list has room for all surfaces
};

/// Distribute a list of surfaces, nearest first, over the children in which they may be seen.
void distribute(const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count,
  CellChildren& children);

/// Sixteen rays, and the surface that each ray sees.
struct CellRays
{
  float x[CellLanes], y[CellLanes]; ///< places of the rays in the plane, half-beamwidths
  std::int32_t seen[CellLanes];     ///< number of the surface that the ray sees; -1: none
};

/// Find the surface that each ray sees. @param list surfaces, nearest first
void see(
  const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count, CellRays& rays);
}

#endif
