// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanSetup.h
 * @brief What all beams of a scan share: surfaces, sensor, settings, noise plan. Immutable while
 * beams are simulated.
 */
#ifndef avianlidar_ScanSetup_h
#define avianlidar_ScanSetup_h

#include "CollisionTree.h"
#include "EchoSettings.h"
#include "Noise.h"
#include "Sensor.h"
#include "SharedBlocks.h"
#include "SharedVector.h"

#include <memory>
#include <vector>

namespace avianlidar
{
struct ScanSetup
{
  std::shared_ptr<const CollisionTree> tree;
  SharedBlocks<Material> materials; ///< one per triangle
  SharedVector<int> objectIds;      ///< one per triangle
  SharedVector<int> materialIds;    ///< one per triangle
  double largestReflectance = 0.0;  ///< max of kd + ks over all triangles
  Sensor sensor;
  EchoSettings settings;
  NoisePlan noise;
};

/// Fill in what follows from the rest: largestReflectance and noise.
void finishSetup(ScanSetup& setup);

/// The largest kd + ks.
double largestReflectanceOf(const SharedBlocks<Material>& materials);
}

#endif
