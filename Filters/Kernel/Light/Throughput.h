// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Throughput.h
 * @brief What the paths of a beam bring back of each joule of its pulse, but for the air.
 *
 * Attenuation, pulse energy, limits and noise do not change it, so that it is kept with the beam as
 * long as the surfaces keep their materials: a scan lit again under another of these costs an
 * exponential and some sums a path. From sums of throughputs and the nearest range follow bounds of
 * the energies of all paths together, which show for most beams that are not perceived that they
 * are not, without a look at their paths.
 */
#ifndef avianlidar_Throughput_h
#define avianlidar_Throughput_h

#include "BeamSamples.h"
#include "ScanSetup.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// What throughputs depend on besides the geometry of the beams.
struct Shading
{
  SharedVector<Material> materials; ///< shared: who writes to them takes a copy
  double largestReflectance = 0.0;
  ReflectanceModel model = ReflectanceModel::LambertBlinnPhong;
  double aperture = 0.0;

  std::uint32_t number = 0; ///< counts the different ones, from 1; 0: none yet

  /// Go on to the setup's.
  void follow(const ScanSetup& setup);
};

/// Paths over two reflections that arrive, and what is known of the others. 36 bytes a path.
struct KnownPaths
{
  /// What does not change with the energy.
  struct End
  {
    std::uint32_t triangle; ///< at P2, from where the light comes in
    std::uint32_t one;      ///< sample at P1
    std::uint32_t two;      ///< sample at P2; NoSample of a mirror path, which ends anywhere
    double cosIncidence;    ///< at P2
  };
  std::vector<double> length; ///< m, the whole way
  std::vector<double> throughput;
  std::vector<End> ends;
  std::uint32_t partners = 0; ///< M that they were found for
  bool found = false;         ///< false: nothing here is to be used
  bool mayPassBudget =
    false; ///< a ray may have to be cut, as the weights of its connections are random
  double connectionSum = 0.0;     ///< of all connections, blocked or not
  double mostSum = 0.0;           ///< of all that arrive or are not known
  double unknownSum = 0.0;        ///< bounds of paths of which it is not known whether they arrive
  double unknownMirror = 0.0;     ///< the largest of mirror paths
  double unknownConnection = 0.0; ///< the largest of connections

  std::size_t size() const { return this->ends.size(); }
};

struct Throughput
{
  std::uint32_t shading = 0;     ///< number of the shading that this belongs to
  std::vector<double> reflected; ///< f_direct of each sample: what its direct echo returns of what
                                 ///< arrives there
  double directSum = 0.0;        ///< of the direct echoes
  double budgetSum = 0.0;        ///< bound of all other paths: what the samples can return besides
  double specularSum = 0.0;      ///< bound of all mirror paths
  double glint = 0.0;            ///< of samples that are rays, see HiddenGlint.h
  KnownPaths paths;

  /// Of the samples' direct echoes; forgets the paths over two reflections.
  void measure(const ScanSetup& setup, const BeamSamples& samples);

  std::size_t bytes() const;
};

/// Energies of the direct echoes, J. @return their sum
double directEnergies(const ScanSetup& setup, const BeamSamples& samples,
  const Throughput& throughput, std::vector<double>& energies);

/// Share of the energy that is left of any path of the beam in the air, at most: none is shorter
/// than the way to the nearest sample and back.
double mostAir(const BeamSamples& samples, double attenuation);

/// The most of its energy that a mirror path from a surface can bring back.
double specularBound(const ScanSetup& setup, const Material& material, double cosIncidence);
}

#endif
