// SPDX-License-Identifier: BSD-3-Clause
#include "SceneSummary.h"

#include <algorithm>

namespace avianlidar
{
SceneSummary summarise(const ScanSetup& setup)
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
  return summary;
}
}
