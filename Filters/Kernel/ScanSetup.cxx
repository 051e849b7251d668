// SPDX-License-Identifier: BSD-3-Clause
#include "ScanSetup.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>

namespace avianlidar
{
void finishSetup(ScanSetup& setup)
{
  setup.largestReflectance = largestReflectanceOf(setup.materials);
  setup.noise = planNoise(setup.sensor, setup.settings.noise);
}

double largestReflectanceOf(const SharedVector<Material>& materials)
{
  double largest = 0.0;
  for (const Material& m : materials)
  {
    largest = std::max(largest, m.kd + m.ks);
  }
  return largest;
}

std::uint64_t sceneChecksum(const ScanSetup& setup, std::uint64_t geometry)
{
  static_assert(sizeof(Material) == 3 * sizeof(double), "materials are hashed as bytes");
  std::uint64_t key = XXH3_64bits_withSeed(
    setup.materials.data(), setup.materials.size() * sizeof(Material), geometry);
  key = XXH3_64bits_withSeed(setup.objectIds.data(), setup.objectIds.size() * sizeof(int), key);
  return XXH3_64bits_withSeed(
    setup.materialIds.data(), setup.materialIds.size() * sizeof(int), key);
}
}
