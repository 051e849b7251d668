// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanSetup.h
 * @brief What all beams of a scan share: surfaces, sensor, settings, noise plan, and the parts of
 * the model that the scan needs. It does not change while beams are simulated.
 *
 * The needs follow from bounds that hold for all beams: pulse energy, limits, air, aperture and the
 * most that any surface of the scene returns. They say whether paths over two reflections can
 * matter, and from which range on nothing is perceived. What single beams leave out stands in their
 * reports (SkippedPart). EchoSettings::fullModel leaves nothing out. Attenuation is never left out,
 * as its exponential costs the same at any coefficient. Nor are surfaces beyond the perceivable
 * range: hits must not depend on limits and air, so that a scan can be lit again, and the report
 * distinguishes a beam that meets such a surface from one that meets none.
 *
 * Source: none; derived in Documentation/model-needs.md.
 * Valid: no range unit of a beam with an echo differs from the full model by more than
 * ModelNeeds::skippedEnergyBound. Detail between the rays is not bounded (missedDetailEnergy).
 * Test: TestSecondaryConstraints.cxx, TestScanReport.cxx,
 * Testing/Stability/TestStabilitySweep.cxx, Testing/Python/TestModelNeeds.py.
 */
#ifndef avianlidar_ScanSetup_h
#define avianlidar_ScanSetup_h

#include "Air.h"
#include "CollisionTree.h"
#include "EchoSettings.h"
#include "Mover.h"
#include "Noise.h"
#include "Sensor.h"
#include "SharedVector.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// Factors that cover the different rounding of a bound and of what it bounds.
constexpr double SurelyAbove = 1.0 + 1e-9;
constexpr double SurelyBelow = 1.0 - 1e-9;

/// Parts of the model left out of a beam; bits of BeamReport::skipped.
enum SkippedPart : std::uint32_t
{
  SkippedSecondaryPaths = 1, ///< some or all paths over two reflections
  SkippedBeam = 2,           ///< the whole beam: all its energy together would not be perceived
  SkippedNoise = 4,          ///< photon noise, which cannot matter; set where the report is output
  SkippedBeyondRange = 8,    ///< with SkippedBeam: all it meets lies beyond the perceivable range
  SkippedDirectPaths = 16    ///< some direct echoes
};

/// Parts of the model that a scan needs.
struct ModelNeeds
{
  /// Range, m, from which on a surface that fills the beam is not perceived, even if it returns the
  /// most that any surface of the scene can. Infinity if there is none.
  double perceivableRange = 0.0;
  bool secondaryReflections = false; ///< false: not asked for, or none can matter
  double secondaryBound = 0.0;       ///< J, most energy of all paths over two reflections of a beam
  double furtherBound = 0.0; ///< J, the same of all paths over more reflections than are asked for
  double lightEnergyBound = 0.0; ///< J, most that a range unit loses by the light-energy constraint
  /// Most energy, J, that a range unit of a beam with an echo loses by all that is left out, plus
  /// what skipped noise might have added.
  double skippedEnergyBound = 0.0;
  /// Energy, J: an object that returns more than this is missed by all N rays of a beam, or of one
  /// in cells by all rays of the grid (there small objects with an id of their own get more), with
  /// a probability below 5 %.
  double missedDetailEnergy = 0.0;
};

/// Inputs of a scan, and what follows from them.
struct ScanSetup
{
  std::shared_ptr<const CollisionTree> tree;
  SharedVector<Material> materials; ///< one per triangle
  SharedVector<int> objectIds;      ///< one per triangle
  SharedVector<int> materialIds;    ///< one per triangle
  double largestReflectance = 0.0;  ///< max of albedo() over all triangles
  double largestGain = 0.0;         ///< max of apertureGain() over all triangles, 1/sr
  /// What moves; null: nothing. Largest reflectance and gain are of these, too.
  std::shared_ptr<const std::vector<Mover>> movers;
  /// Number of the first triangle of each mover (SceneTriangles.h).
  std::vector<std::uint32_t> firstTriangles;
  Sensor sensor;
  EchoSettings settings;           ///< its attenuation coefficient is the clear air's alone
  std::vector<PlacedMedium> media; ///< media that fill the scene come first
  NoisePlan noise;
  std::int32_t revolution = 0; ///< of the sensor; each has noise of its own
  ModelNeeds needs;

  /// All air of the scene.
  Air air() const { return { this->settings.attenuationCoefficient, this->media }; }
  /// Attenuation coefficient of all that fills the scene, 1/m.
  double attenuation() const
  {
    return attenuationOf(this->settings.attenuationCoefficient, this->media);
  }

  /// Of a triangle of the tree or of a mover.
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

/// Raise largest reflectance and gain, which are of the surfaces, to those of movers, and number
/// their triangles.
void includeMovers(ScanSetup& setup);

/// Set noise and needs, which follow from the rest.
void planModel(ScanSetup& setup);

/// The needs of a setup. @param setup complete but for its needs
ModelNeeds needsOf(const ScanSetup& setup);

/// Largest share of the light on a surface of the scene that returns. @param range m, of the
/// surface at least
double mostReturned(const ScanSetup& setup, double range);

/// True if paths that cannot matter are dropped.
bool dropsFaintPaths(const EchoSettings& settings);

/// Most energy, J, that a range unit may lose where faint paths are dropped by the share of the
/// limit; 0 where the limit itself is the threshold, which leaves direct echoes alone.
double lightEnergyTolerance(const ScanSetup& setup);
}

#endif
