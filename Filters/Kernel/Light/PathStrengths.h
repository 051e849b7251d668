// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathStrengths.h
 * @brief What the paths of a beam bring back of each joule of a ray, but for the air.
 *
 * Attenuation, pulse energy, limits and noise do not change it, so that it is kept with the beam as
 * long as the surfaces keep their materials: a scan lit again under another of these costs an
 * exponential and some sums a path. From sums of strengths and the nearest range follow bounds of
 * the energies of all paths together, by which most beams that are not perceived are told without a
 * look at their paths.
 */
#ifndef avianlidar_PathStrengths_h
#define avianlidar_PathStrengths_h

#include "PrimaryHits.h"
#include "ScanSetup.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
struct DirectLight;

/// What strengths depend on besides the geometry of the beams.
struct Shading
{
  SharedBlocks<Material> materials; ///< shared: who writes to them takes a copy
  double largestReflectance = 0.0;
  ReflectanceModel model = ReflectanceModel::LambertBlinnPhong;
  double aperture = 0.0;

  Shading() = default;
  explicit Shading(const ScanSetup& setup)
    : materials(setup.materials)
    , largestReflectance(setup.largestReflectance)
    , model(setup.settings.reflectanceModel)
    , aperture(setup.sensor.receiverAperture)
  {
  }
  bool isOf(const ScanSetup& setup) const
  {
    return this->materials.sharesWith(setup.materials) &&
      this->largestReflectance == setup.largestReflectance &&
      this->model == setup.settings.reflectanceModel &&
      this->aperture == setup.sensor.receiverAperture;
  }
};

/// Paths over two reflections that arrive, in the order of their numbers, and what is known of the
/// others. 40 bytes a path.
struct KnownPaths
{
  /// What does not change with the energy.
  struct End
  {
    std::uint32_t path;     ///< number
    std::uint32_t triangle; ///< at P2, from where the light comes in
    std::uint32_t one;      ///< hit at P1
    std::uint32_t two;      ///< hit at P2; NoHit of a mirror path, which ends anywhere
    double cosIncidence;    ///< at P2
  };
  std::vector<double> length; ///< m, the whole way
  std::vector<double> strength;
  std::vector<End> ends;
  std::uint32_t connections = 0; ///< M that they were found for
  bool found = false;            ///< false: nothing here is to be used
  bool mayPassBudget =
    false;              ///< a ray may have to be cut, as the weights of its connections are random
  double linkSum = 0.0; ///< of all connections, blocked or not
  double mostSum = 0.0; ///< of all that arrive or are not known
  double unknownSum = 0.0;    ///< bounds of paths of which it is not known whether they arrive
  double unknownMirror = 0.0; ///< the largest of mirror paths
  double unknownLink = 0.0;   ///< the largest of connections

  std::size_t size() const { return this->ends.size(); }
};

struct PathStrengths
{
  std::uint32_t shading = 0;  ///< counts shadings: which one this belongs to
  std::vector<double> direct; ///< f_direct of each hit
  double directSum = 0.0;     ///< of the hits, by their weights
  double budgetSum = 0.0;     ///< bound of all other paths: what the hits can return besides
  double glossSum = 0.0;      ///< bound of all mirror paths
  double nearest = 0.0;       ///< m, of the hits
  double glint = 0.0;         ///< see HiddenGlint.h
  KnownPaths paths;

  /// From the materials and direct echoes of the hits; forgets the paths over two reflections.
  void measure(const ScanSetup& setup, const PrimaryHits& hits, const DirectLight& light);

  /// The most that paths of strength 1 can keep in the air: none is shorter than the way to the
  /// nearest hit and back.
  double mostAir(double attenuation) const;

  std::size_t bytes() const;
};

/// The most of its energy that a mirror path from the hit can bring back.
double glossOf(const ScanSetup& setup, const Material& material, double cosIncidence);

/// The same of all hits. The materials of the hits must be known.
void glossesOf(const ScanSetup& setup, const PrimaryHits& hits, const DirectLight& light,
  std::vector<double>& glosses);
}

#endif
