// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Throughput.h
 * @brief What the paths of a beam return for each joule of its pulse, without the air.
 *
 * It does not depend on attenuation, pulse energy, limits or noise, so it is kept with the beam as
 * long as the surfaces keep their materials. A scan lit again costs an exponential and some sums a
 * path. Sums of throughputs and the nearest range bound the energies of all paths together; for
 * most beams below the limit these bounds suffice.
 *
 * Source: paper, Eq. 4-9.
 * Differs: see Reflectance.h; the air is applied to the length of the whole path at the end.
 * Valid: the bounds (directSum, budgetSum, specularSum, KnownPaths) are never below what the paths
 * return, but for rounding (SurelyAbove).
 * Test: TestScan.cxx, TestScanAgain.cxx, TestScanAgainPlates.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_Throughput_h
#define avianlidar_Throughput_h

#include "BeamSamples.h"
#include "ScanSetup.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Everything that throughputs depend on besides the geometry of the beams.
struct Shading
{
  SharedVector<Material> materials;
  double largestReflectance = 0.0;
  ReflectanceModel model = ReflectanceModel::LambertBlinnPhong;
  double aperture = 0.0;

  std::uint32_t number = 0; ///< number of this shading, from 1; 0: none yet

  /// Take over a setup; the number rises if anything differs.
  void follow(const ScanSetup& setup);
};

/// Paths over two reflections that arrive, and bounds of those not yet traced. 40 bytes a path.
struct KnownPaths
{
  /// The end of a path.
  struct End
  {
    std::uint32_t triangle; ///< at P2
    std::uint32_t one;      ///< sample at P1
    std::uint32_t two;      ///< sample at P2; NoSample of a mirror path, which ends anywhere
    double cosIncidence;    ///< at P2
  };
  std::vector<double> length; ///< of the whole path, m
  std::vector<double> throughput;
  std::vector<End> ends;
  std::uint32_t partners = 0; ///< M for which they were found
  bool found = false;         ///< false: the other members are not valid
  bool mayPassBudget =
    false; ///< random weights of connections may exceed a ray's budget, which cuts it
  double connectionSum = 0.0;     ///< sum of all connections, blocked or not
  double mostSum = 0.0;           ///< bound of all paths that arrive or are not yet traced
  double unknownSum = 0.0;        ///< bound of the paths not yet traced
  double unknownMirror = 0.0;     ///< largest bound of such a mirror path
  double unknownConnection = 0.0; ///< largest bound of such a connection

  std::size_t size() const { return this->ends.size(); }
};

struct Throughput
{
  std::uint32_t shading = 0;     ///< number of the shading it belongs to
  std::vector<double> reflected; ///< f_direct of each sample: share of the arriving energy that its
                                 ///< direct echo returns
  double directSum = 0.0;        ///< sum of the direct echoes
  double budgetSum = 0.0;        ///< bound of all other paths together
  double specularSum = 0.0;      ///< bound of all mirror paths
  KnownPaths paths;

  /// Set the throughputs of direct echoes.
  void measure(const ScanSetup& setup, const BeamSamples& samples);

  /// Set the bounds of the paths that start from the samples, which are rays; after measure().
  void boundPaths(const ScanSetup& setup, const BeamSamples& samples);

  std::size_t bytes() const;
};

/// Energies of the direct echoes, J. @return their sum
double directEnergies(const ScanSetup& setup, const BeamSamples& samples,
  const Throughput& throughput, std::vector<double>& energies);

/// Largest share of a path's energy that the air leaves: no path is shorter than the way to the
/// nearest sample and back.
double mostAir(const BeamSamples& samples, double attenuation);

/// Bound of the throughput of a mirror path from a surface.
double specularBound(const ScanSetup& setup, const Material& material, double cosIncidence);
}

#endif
