// SPDX-License-Identifier: BSD-3-Clause
#include "SceneSummary.h"

#include "Hash.h"

#include <algorithm>

namespace avianlidar
{
SceneSummary summarize(const ScanSetup& setup, std::uint64_t geometry)
{
  SceneSummary summary;
  const Material* last = nullptr; // neighbours often have the same material
  for (const Material& material : setup.materials)
  {
    if (!last || material != *last)
    {
      summary.largestReflectance = std::max(summary.largestReflectance, material.albedo());
      summary.largestGain = std::max(summary.largestGain, apertureGain(material));
    }
    last = &material;
  }
  const std::uint64_t parts[] = { geometry, setup.materials.checksum(), setup.objectIds.checksum(),
    setup.materialIds.checksum() };
  summary.checksum = hashOf(parts, sizeof(parts), 0);
  return summary;
}
}
