// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneSummary.h
 * @brief Largest reflectance, largest gain and checksum of all materials and ids of a scene.
 *
 * Source: none.
 * Valid: any scene. Equal content gives equal results.
 * Test: Testing/Prober/same_bits.py.
 */
#ifndef avianlidar_SceneSummary_h
#define avianlidar_SceneSummary_h

#include "ScanSetup.h"

#include <cstdint>

namespace avianlidar
{
struct SceneSummary
{
  double largestReflectance = 0.0; ///< largest albedo() of all triangles; 0 without triangles
  double largestGain = 0.0;        ///< largest apertureGain() of all triangles, 1/sr
  /// Checksum (XXH3, 64 bits) of the scene. Scenes with equal bytes of geometry, materials and ids
  /// of all triangles, in order, have equal checksums.
  std::uint64_t checksum = 0;
};

/// Summarise the materials and ids of a setup. @param geometry TriangleMesh::checksum()
SceneSummary summarize(const ScanSetup& setup, std::uint64_t geometry);
}

#endif
