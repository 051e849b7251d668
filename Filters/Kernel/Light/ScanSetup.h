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
#include "ModelNeeds.h"
#include "Noise.h"
#include "ObjectSpheres.h"
#include "Sensor.h"
#include "SharedVector.h"

#include <memory>
#include <vector>

namespace avianlidar
{
struct ScanSetup
{
  std::shared_ptr<const CollisionTree> tree;
  SharedVector<Material> materials;             ///< one per triangle
  SharedVector<int> objectIds;                  ///< one per triangle
  SharedVector<int> materialIds;                ///< one per triangle
  double largestReflectance = 0.0;              ///< max of albedo() over all triangles
  double largestGain = 0.0;                     ///< max of apertureGain() over all triangles, 1/sr
  std::shared_ptr<const ObjectSpheres> objects; ///< of tree and ids; null: no small targets
  Sensor sensor;
  EchoSettings settings;
  NoisePlan noise;
  std::int32_t revolution = 0; ///< of the sensor: the noise of each is its own
  ModelNeeds needs;
};

/// Fill in what follows from the rest: largest values, objects, noise and needs.
void finishSetup(ScanSetup& setup);

/// Objects, noise and needs alone. Objects are kept if they are those of the tree and the ids.
void planModel(ScanSetup& setup);
}

#endif
