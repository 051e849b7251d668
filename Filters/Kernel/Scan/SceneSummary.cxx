// SPDX-License-Identifier: BSD-3-Clause
#include "SceneSummary.h"

#include <algorithm>

namespace avianlidar
{
SceneSummary summarise(const ScanSetup& setup)
{
  SceneSummary summary;
  for (const Material& material : setup.materials.different())
  {
    summary.largestReflectance = std::max(summary.largestReflectance, material.albedo());
    summary.largestGain = std::max(summary.largestGain, apertureGain(material));
  }
  return summary;
}
}
