// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CellLanes.h
 * @brief The two inner loops of BeamCells.h, in SIMD lanes: a list of surfaces against sixteen
 * cells, and against sixteen rays.
 *
 * Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988.
 * Differs: single precision in the beam's plane, whose coordinates are at most 1 in the disc. What
 * two triangles share they have with opposite signs, bit for bit, so nothing passes between them.
 * Valid: sides within 1e-6 half-beamwidths. Surfaces of nearly the same 1/z may change places
 * within CellSurface::slack. Products are not fused: every instruction set gives the same bits.
 * Test: TestBeamCells.cxx, InstructionSets.cxx.
 */
#ifndef avianlidar_CellLanes_h
#define avianlidar_CellLanes_h

#include <cstdint>

namespace avianlidar
{
constexpr int CellLanes = 16;

/// A surface of a beam (BeamTriangles.h) in single precision. Sides that do not meet the disc are
/// (0, 0, 1).
struct CellSurface
{
  float lines[4][3];
  float slopes[4];    ///< |x| + |y| of each side
  float inverse[3];   ///< 1/z, 1/m
  float inverseSlope; ///< |x| + |y|
  float most;         ///< upper bound of 1/z
  float slack;        ///< most that rounding changes 1/z
  float share;        ///< of the beam, of the small object that it is part of; 0: it is of none
  float foot[2];      ///< where light comes back in the direction of the surface's mirror
};

/// Sixteen children of a cell, four by four.
struct CellChildren
{
  float x, y, width;          ///< corner of the first, and their side
  float occluders[CellLanes]; ///< 1/z of what covers each: nothing behind it is seen; infinite:
                              ///< it is not wanted
  std::uint32_t counts[CellLanes]; ///< of their lists
  std::uint32_t* lists[CellLanes]; ///< each with room for all
};

/// Distribute a list of surfaces, nearest first, over the children in which they may be seen.
void distribute(const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count,
  CellChildren& children);

/// Sixteen rays, and what each sees.
struct CellRays
{
  float x[CellLanes], y[CellLanes];
  std::int32_t seen[CellLanes]; ///< a surface; -1: none
};

/// Find what the rays see of a list, nearest first.
void see(
  const CellSurface* surfaces, const std::uint32_t* list, std::uint32_t count, CellRays& rays);
}

#endif
