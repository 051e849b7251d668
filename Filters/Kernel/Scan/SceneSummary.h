// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneSummary.h
 * @brief What follows from all materials and ids of a scene together.
 *
 * A pass over the materials (24 bytes a triangle) or ids (8 bytes a triangle), if they are not the
 * same vectors as the time before.
 */
#ifndef avianlidar_SceneSummary_h
#define avianlidar_SceneSummary_h

#include "ScanSetup.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Sums up one scene after another. The answers depend on the setup followed last alone, not on
/// those before, which only say what need not be looked at again. It holds the materials and ids
/// looked at (shared, not copied), so that who writes to them takes a copy: none changes unnoticed.
class SceneSummary
{
public:
  /// Go on to the materials and ids of a setup.
  void follow(const ScanSetup& setup);

  /// The largest albedo() of the setup followed last; 0 without triangles.
  double largestReflectance() const { return this->Reflectance; }

  /// The largest apertureGain(), 1/sr, likewise.
  double largestGain() const { return this->Gain; }

  /// Hash (XXH3, 64 bits) of the scene followed last: equal for equal geometry, materials and ids
  /// of all triangles in their order, compared as bytes. @param geometry hash of points and
  /// triangles (TriangleMesh::checksum())
  std::uint64_t checksum(std::uint64_t geometry) const;

private:
  SharedVector<Material> Materials; ///< looked at last
  SharedVector<int> ObjectIds;
  SharedVector<int> MaterialIds;
  std::uint64_t Hash = 0; ///< of materials
  std::uint64_t Ids = 0;  ///< hash of both
  double Reflectance = 0.0;
  double Gain = 0.0;
};
}

#endif
