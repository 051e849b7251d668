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
#include "ObjectSpheres.h"
#include "Sensor.h"
#include "SharedVector.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Bounds are rounded differently from what they bound.
constexpr double SurelyAbove = 1.0 + 1e-9;
constexpr double SurelyBelow = 1.0 - 1e-9;

/// Parts of the model that a beam did without; bits of BeamReport::skipped.
enum SkippedPart : std::uint32_t
{
  SkippedSecondaryPaths = 1, ///< some or all paths over two reflections
  SkippedBeam = 2,           ///< everything: all its energy together would not be perceived
  SkippedNoise = 4,          ///< photon noise, which cannot matter; set by who reports
  SkippedBeyondRange = 8,    ///< with SkippedBeam: all it meets lies beyond the perceivable range
  SkippedDirectPaths = 16    ///< some direct echoes
};

struct ModelNeeds
{
  /// m: from there on a surface that fills the beam, returning all that any surface of the scene
  /// can, is not perceived. Infinity where there is no such range.
  double perceivableRange = 0.0;
  bool secondaryReflections = false; ///< false: not asked for, or none can matter
  double secondaryBound = 0.0; ///< J: all paths over two reflections of a beam, if there are any
  /// J: what any range unit of a beam with an echo loses at most by all that is left out, and what
  /// skipped noise might have added.
  double skippedEnergyBound = 0.0;
  /// J: an object that returns more than this is missed by all rays of a beam with a probability
  /// below 5 %, unless it has rays of its own.
  double missedDetailEnergy = 0.0;
  /// Share of the beam's solid angle from which on a small object can bring a beam the tolerance
  /// of the light-energy constraint, rounded down to a power of 4, so that not every change of a
  /// limit gives other objects rays; infinity: none has rays of its own.
  double smallestTarget = 0.0;
};

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

/// @param setup all but its needs
ModelNeeds needsOf(const ScanSetup& setup);

/// True if paths that cannot matter are dropped.
bool dropsFaintPaths(const EchoSettings& settings);
}

#endif
