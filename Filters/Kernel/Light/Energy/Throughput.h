// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Throughput.h
 * @brief Throughputs of direct echoes: energy received / energy of the pulse, without loss in air.
 *
 * The sum of the throughputs and the nearest range give an upper bound of the energy of all direct
 * echoes together. This bound suffices to skip most beams whose energy lies below the detection
 * limit Qlow.
 *
 * Source: paper, Eq. 4-9.
 * Differs: see Reflectance.h. Loss in air is applied at the end, to the length of the whole path.
 * Valid: bounds are never below the energies that paths return, except for rounding (SurelyAbove).
 * Test: TestScan.cxx, TestScanAgain.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_Throughput_h
#define avianlidar_Throughput_h

#include "BeamSamples.h"
#include "BeamShape.h"
#include "ScanSetup.h"

#include <vector>

namespace avianlidar
{
/// Direct echoes of the samples of a beam.
struct Throughput
{
  std::vector<double> reflected; ///< f_direct by sample: share of arriving energy that returns
  double directSum = 0.0;        ///< throughput of all direct echoes together

  void measure(const ScanSetup& setup, const BeamSamples& samples);
};

/// Find the energies of the direct echoes, J. @return their sum
double directEnergies(const ScanSetup& setup, const BeamSamples& samples,
  const Throughput& throughput, std::vector<double>& energies);

/// Largest transmission of the air along any path of a beam. No path is shorter than twice the
/// nearest range. @param nearest range of the nearest surface, m
double transmissionBound(double nearest, double attenuation);

/// Largest weight of a path that leaves or meets a mirror at a greater angle than the path whose
/// direction was drawn. Only lobes that are wider than the angle to the mirror have larger weights.
constexpr double MostGrazing = 8.0;

/// Upper bound of the matt light that returns, with an aperture, by all paths over a mirror, as a
/// share of the light that leaves the mirror. @param nearest lower bound of the ranges of the
/// beam's surfaces, m
double mattReturnBound(const ScanSetup& setup, const BeamShape& shape, double nearest);

/// Upper bound of the light that returns by a mirror path and the paths back by the mirror, as a
/// share of the light that leaves the mirror. @param nearest lower bound of the ranges of the
/// beam's surfaces, m
double mirrorReturnBound(const ScanSetup& setup, const BeamShape& shape, double nearest);

/// Upper bound of the throughput of a mirror path from a surface. @param returned
/// mirrorReturnBound()
double specularBound(
  const ScanSetup& setup, const Material& material, double cosIncidence, double returned);
}

#endif
