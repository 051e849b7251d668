// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSetup.h"

#include <algorithm>

namespace avianlidar
{
void finishSetup(ScanSetup& setup)
{
  setup.largestReflectance = largestReflectanceOf(setup.materials);
  setup.noise = planNoise(setup.sensor, setup.settings.noise);
}

double largestReflectanceOf(const SharedBlocks<Material>& materials)
{
  double largest = 0.0;
  for (const Material& m : materials)
  {
    largest = std::max(largest, m.kd + m.ks);
  }
  return largest;
}
}
