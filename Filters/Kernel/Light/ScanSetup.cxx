// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSetup.h"

#include <algorithm>
#include <utility>

namespace avianlidar
{
void finishSetup(ScanSetup& setup)
{
  setup.largestReflectance = 0.0;
  setup.largestGain = 0.0;
  for (const Material& m : std::as_const(setup.materials))
  {
    setup.largestReflectance = std::max(setup.largestReflectance, m.albedo());
    setup.largestGain = std::max(setup.largestGain, apertureGain(m));
  }
  planModel(setup);
}

void planModel(ScanSetup& setup)
{
  if (!setup.settings.smallTargets)
  {
    setup.objects.reset();
  }
  else if (!setup.objects || !setup.objects->isOf(setup.tree->checksum, setup.objectIds))
  {
    setup.objects = std::make_shared<const ObjectSpheres>(
      *setup.tree->mesh, setup.tree->checksum, setup.objectIds);
  }
  setup.noise = planNoise(setup.sensor, setup.settings.noise, setup.settings.fullModel);
  setup.needs = needsOf(setup);
}
}
