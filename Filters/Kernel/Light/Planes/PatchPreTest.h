// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PatchPreTest.h
 * @brief May planes fill a beam? A glance at what some of its rays hit, before VisiblePatch.h
 * searches.
 */
#ifndef avianlidar_PatchPreTest_h
#define avianlidar_PatchPreTest_h

#include "TriangleMesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// Of some rays of a beam that a plane fills, so many may miss it, by rounding.
inline std::size_t mostRaysOff(std::size_t rays)
{
  return std::max<std::size_t>(1, rays / 32);
}

/// What a glance at some rays tells of the planes that may fill a beam.
struct PatchPreTest
{
  std::uint32_t triangle; ///< of a plane that may; NoTriangle if none
  bool several;           ///< it is not alone
};

/// A glance at the triangles that some rays of a beam hit (NoTriangle: none), to save the search in
/// beams where it would be in vain. Lenient, so that it is never false where planes do fill the
/// beam, whichever rays were drawn: mostRaysOff() may differ.
/// @param count at least 1 @param mostPlanes that are wanted, up to MostPatchPlanes
PatchPreTest mayFill(const TriangleMesh& mesh, const Vec3& origin, const std::uint32_t* triangles,
  std::size_t count, std::size_t mostPlanes);
}

#endif
