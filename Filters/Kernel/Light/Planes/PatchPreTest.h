// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PatchPreTest.h
 * @brief Quick test whether planes may fill a beam, from the triangles that some of its rays hit,
 * before VisiblePatch.h searches.
 *
 * Source: none.
 * Valid: finds planes that fill the beam, for any draw of the rays, if at most mostRaysOff() rays
 * miss them by rounding, and if the first or the last ray hits the only plane. Of several planes
 * the first ray, or the last where the first hits nothing, must hit one. A beam whose planes are
 * not found is sampled by rays.
 * Test: TestPlaneIntegrationEdges.cxx, TestPlaneIntegrationScan.cxx.
 */
#ifndef avianlidar_PatchPreTest_h
#define avianlidar_PatchPreTest_h

#include "TriangleMesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// Number of rays of a beam filled by a plane that may miss it by rounding.
inline std::size_t mostRaysOff(std::size_t rays)
{
  return std::max<std::size_t>(1, rays / 32);
}

/// Planes that may fill a beam.
struct PatchPreTest
{
  std::uint32_t triangle; ///< of a plane that may fill it; NoTriangle if none
  bool several;           ///< there are more planes
};

/// Test the triangles that some rays of a beam hit (NoTriangle: none).
/// @param count number of rays, at least 1 @param mostPlanes that may fill it, up to
/// MostPatchPlanes
PatchPreTest mayFill(const TriangleMesh& mesh, const Vec3& origin, const std::uint32_t* triangles,
  std::size_t count, std::size_t mostPlanes);
}

#endif
