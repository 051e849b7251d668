// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneSummary.h
 * @brief What follows from all materials and ids of a scene together: largest reflectance and gain,
 * and a checksum.
 *
 * It costs a pass over the materials (24 bytes a triangle) or ids (8 bytes a triangle), unless they
 * are the same vectors as the time before.
 *
 * Source: none.
 * Valid: any scene; equal content gives equal results.
 * Test: Testing/Prober/same_bits.py.
 */
#ifndef avianlidar_SceneSummary_h
#define avianlidar_SceneSummary_h

#include "ScanSetup.h"

#include <cstdint>

namespace avianlidar
{
/// Summary of one scene after another. Results depend on the last setup alone; earlier ones only
/// save passes. It shares the vectors of materials and ids, which are constant: other materials or
/// ids are another vector.
class SceneSummary
{
public:
  /// Summarise the materials and ids of a setup.
  void follow(const ScanSetup& setup);

  /// Largest albedo() of the last setup; 0 without triangles.
  double largestReflectance() const { return this->Reflectance; }

  /// Largest apertureGain() of the last setup, 1/sr.
  double largestGain() const { return this->Gain; }

  /// Hash (XXH3, 64 bits) of the last scene: equal for equal geometry, materials and ids of all
  /// triangles in their order, compared as bytes. @param geometry TriangleMesh::checksum()
  std::uint64_t checksum(std::uint64_t geometry) const;

private:
  SharedVector<Material> Materials; ///< of the last setup, as the two below
  SharedVector<int> ObjectIds;
  SharedVector<int> MaterialIds;
  std::uint64_t Hash = 0; ///< hash of the materials
  std::uint64_t Ids = 0;  ///< hash of both ids
  double Reflectance = 0.0;
  double Gain = 0.0;
};
}

#endif
