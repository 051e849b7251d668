// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSetup.h"

#include <algorithm>

namespace avianlidar
{
void finishSetup(ScanSetup& setup)
{
  setup.largestReflectance = 0.0;
  for (const Material& m : setup.materials)
  {
    setup.largestReflectance = std::max(setup.largestReflectance, m.kd + m.ks);
  }
  setup.noise = planNoise(setup.sensor, setup.settings.noise);
}
}
