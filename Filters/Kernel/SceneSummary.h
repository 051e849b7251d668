// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file SceneSummary.h
 * @brief What follows from all materials and ids of a scene together, kept by blocks: after a
 * change of some only their blocks are looked at.
 */
#ifndef avianlidar_SceneSummary_h
#define avianlidar_SceneSummary_h

#include "ScanSetup.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
class SceneSummary
{
public:
  /// Go on to the materials and ids of a setup.
  void follow(const ScanSetup& setup);

  /// The largest kd + ks.
  double largestReflectance() const;

  /// Hash of geometry, materials and ids: equal for equal scenes.
  std::uint64_t checksum(std::uint64_t geometry) const;

private:
  SharedBlocks<Material> Materials; ///< looked at last
  SharedVector<int> ObjectIds;
  SharedVector<int> MaterialIds;
  std::vector<std::uint64_t> Hashes; ///< of materials, by block
  std::vector<double> Largest;       ///< kd + ks, by block
  std::uint64_t Ids = 0;             ///< hash of both
};
}

#endif
