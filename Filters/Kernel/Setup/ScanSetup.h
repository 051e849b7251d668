// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanSetup.h
 * @brief Inputs that all beams of a scan share: surfaces, sensor, settings, noise plan, and the
 * parts of the model that the scan needs. These inputs do not change while beams are simulated.
 *
 * ModelNeeds follows from values that hold for all beams: pulse energy, limits, air, aperture and
 * the largest reflectance in the scene. ModelNeeds says whether paths with two reflections can
 * matter, and beyond which range nothing is perceived. The report of a beam lists the parts that
 * are left out (SkippedPart). With EchoSettings::fullModel no part is left out. Attenuation is
 * always modelled, because its exponential costs the same at any coefficient. Surfaces beyond the
 * perceivable range are always traced, for two reasons. First, hits must not depend on limits and
 * air, so that energies can be computed again from kept hits. Second, the report distinguishes a
 * beam that meets only such surfaces from a beam that meets no surface.
 *
 * Source: none. Documentation/guide/accuracy.md describes the bounds.
 * Valid: the energy of any range unit of an echo differs from the full model by at most
 * ModelNeeds::skippedEnergyBound. The energy of detail between the rays is not bounded
 * (missedDetailEnergy).
 * Test: TestSecondaryConstraints.cxx, TestScanReport.cxx, Testing/Stability/TestStabilitySweep.cxx,
 * Testing/Python/TestModelNeeds.py.
 */
#ifndef avianlidar_ScanSetup_h
#define avianlidar_ScanSetup_h

#include "Air.h"
#include "CollisionTree.h"
#include "EchoSettings.h"
#include "Mover.h"
#include "NoisePlan.h"
#include "Sensor.h"
#include "SharedVector.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Factors that cover the rounding of a bound and of the value that it bounds.
constexpr double SurelyAbove = 1.0 + 1e-9;
constexpr double SurelyBelow = 1.0 - 1e-9;

/// Parts of the model left out of a beam; bits of BeamReport::skipped.
enum SkippedPart : std::uint32_t
{
  SkippedSecondaryPaths = 1, ///< paths with two reflections that an echo might contain
  SkippedBeam = 2,           ///< the whole beam, because no range unit is perceived
  SkippedNoise = 4,          ///< photon noise that cannot matter; set where the report is output
  SkippedBeyondRange = 8,    ///< a SkippedBeam whose surfaces all lie beyond the perceivable range
  SkippedDirectPaths = 16    ///< some direct echoes
};

/// Parts of the model that a scan needs.
struct ModelNeeds
{
  /// Range, m, beyond which nothing is perceived, not even a surface that fills the beam and
  /// returns as much as the scene's brightest surface. Infinity if there is no such range.
  double perceivableRange = 0.0;
  bool secondaryReflections = false; ///< whether two reflections are enabled and can matter
  double secondaryBound = 0.0;       ///< bound of a beam's energy by paths with two reflections, J
  double furtherBound = 0.0;         ///< bound of a beam's energy by paths with more reflections, J
  double lightEnergyBound = 0.0; ///< bound of a range unit's loss by the light-energy constraint, J
  /// Bound of the energy, J, that a range unit of an echo loses by all omissions, plus the energy
  /// that skipped noise might have added.
  double skippedEnergyBound = 0.0;
  /// Energy of an object, J, above which the probability that all rays of a beam miss the object is
  /// below 5 %. A beam in cells has the rays of its grid, and more rays on small objects that have
  /// their own id. Every other beam has N rays.
  double missedDetailEnergy = 0.0;
};

/// Inputs of a scan, and values that follow from them.
struct ScanSetup
{
  std::shared_ptr<const CollisionTree> tree;
  SharedVector<Material> materials; ///< material of each triangle
  SharedVector<int> objectIds;      ///< object id of each triangle
  SharedVector<int> materialIds;    ///< material id of each triangle
  double largestReflectance = 0.0;  ///< largest albedo() of all triangles
  double largestGain = 0.0;         ///< largest apertureGain() of all triangles, 1/sr
  /// Movers; null if nothing moves. `largestReflectance` and `largestGain` include triangles of
  /// movers.
  std::shared_ptr<const std::vector<Mover>> movers;
  /// Number of the first triangle of each mover (SceneTriangles.h).
  std::vector<std::uint32_t> firstTriangles;
  Sensor sensor;
  EchoSettings settings;           ///< settings, including attenuation by the clear air
  std::vector<PlacedMedium> media; ///< media, first the media that fill the scene
  NoisePlan noise;
  std::int32_t revolution = 0; ///< number of the sensor's revolution, which selects the noise
  ModelNeeds needs;

  /// The clear air and all media of the scene.
  Air air() const { return { this->settings.attenuationCoefficient, this->media }; }
  /// Attenuation coefficient of the clear air and the media that fill the scene, 1/m.
  double attenuation() const
  {
    return attenuationOf(this->settings.attenuationCoefficient, this->media);
  }

  /// Material and ids of a triangle of the tree or of a mover.
  const Material& material(std::uint32_t triangle) const
  {
    return triangle < this->materials.size() ? this->materials[triangle]
                                             : this->ofMover(triangle, &Mover::materials);
  }
  int objectId(std::uint32_t triangle) const
  {
    return triangle < this->objectIds.size() ? this->objectIds[triangle]
                                             : this->ofMover(triangle, &Mover::objectIds);
  }
  int materialId(std::uint32_t triangle) const
  {
    return triangle < this->materialIds.size() ? this->materialIds[triangle]
                                               : this->ofMover(triangle, &Mover::materialIds);
  }

private:
  template <class T>
  const T& ofMover(std::uint32_t triangle, std::vector<T> Mover::*values) const
  {
    const auto next = std::upper_bound(firstTriangles.begin(), firstTriangles.end(), triangle);
    const std::size_t m = static_cast<std::size_t>(next - firstTriangles.begin()) - 1;
    return ((*this->movers)[m].*values)[triangle - this->firstTriangles[m]];
  }
};

/// Number the triangles of movers, and include these triangles in the largest reflectance and gain.
void includeMovers(ScanSetup& setup);

/// Set the members `noise` and `needs` of a setup, which follow from the other members.
void planModel(ScanSetup& setup);

/// Needs of a setup whose other members are set.
ModelNeeds needsOf(const ScanSetup& setup);

/// Number of parts of equal length of a range unit, by which surfaces are divided: 1, or more for
/// smooth pulses. A whole number.
double partsOfUnit(const ScanSetup& setup);

/// The same for waveforms: a multiple of the number of samples in a unit.
double partsForSamples(const ScanSetup& setup);

/// Upper bound of the share of the arriving light that any surface of the scene returns.
/// @param range lower bound of the surface's range, m
double returnBound(const ScanSetup& setup, double range);

/// True if paths that cannot matter are dropped.
bool dropsFaintPaths(const EchoSettings& settings);

/// Energy, J, with which the light-energy constraint compares each path with two reflections alone;
/// 0 with LightEnergyThreshold::ShareOfLimit.
double limitOfPath(const ScanSetup& setup);

/// Energy, J, that a range unit may lose by dropped paths with LightEnergyThreshold::ShareOfLimit.
/// Otherwise 0, because the other thresholds drop no direct echoes.
double lightEnergyTolerance(const ScanSetup& setup);
}

#endif
