// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneSummary.h
 * @brief Largest reflectance, largest gain and checksum of all materials and ids of a scene.
 *
 * A new vector of materials (32 bytes per triangle) or of ids (8 bytes per triangle) is read once.
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
/// Summarises one scene after another. Results depend only on the last setup. Vectors of materials
/// and ids are shared and constant, so the same vector is not read a second time.
class SceneSummary
{
public:
  /// Summarise the materials and ids of a setup.
  void follow(const ScanSetup& setup);

  /// Largest albedo() of the last setup; 0 without triangles.
  double largestReflectance() const { return this->Reflectance; }

  /// Largest apertureGain() of the last setup, 1/sr.
  double largestGain() const { return this->Gain; }

  /// Hash (XXH3, 64 bits) of the last scene. Scenes with equal bytes of geometry, materials and ids
  /// of all triangles, in order, have equal hashes. @param geometry TriangleMesh::checksum()
  std::uint64_t checksum(std::uint64_t geometry) const;

private:
  SharedVector<Material> Materials; ///< materials of the last setup
  SharedVector<int> ObjectIds;
  SharedVector<int> MaterialIds;
  std::uint64_t Hash = 0; ///< hash of the materials
  std::uint64_t Ids = 0;  ///< hash of both vectors of ids
  double Reflectance = 0.0;
  double Gain = 0.0;
};
}

#endif
