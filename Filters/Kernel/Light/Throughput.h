// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Throughput.h
 * @brief What the direct echoes of a beam return for each joule of its pulse, without the air.
 *
 * Their sum and the nearest range bound the energy of all of them together; for most beams below
 * the limit that bound suffices.
 *
 * Source: paper, Eq. 4-9.
 * Differs: see Reflectance.h; the air is applied to the length of the whole path at the end.
 * Valid: the bounds are never below what the paths return, but for rounding (SurelyAbove).
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
  std::vector<double> reflected; ///< f_direct of each sample: share of the arriving energy that its
                                 ///< direct echo returns
  double directSum = 0.0;        ///< sum of the direct echoes

  void measure(const ScanSetup& setup, const BeamSamples& samples);
};

/// Energies of the direct echoes, J. @return their sum
double directEnergies(const ScanSetup& setup, const BeamSamples& samples,
  const Throughput& throughput, std::vector<double>& energies);

/// Largest share of a path's energy that the air leaves: no path is shorter than the way to the
/// nearest surface and back. @param nearest m
double mostAir(double nearest, double attenuation);

/// Largest share that returns of the light that a mirror passes on, both ways of the path together.
/// @param nearest m: no surface of the beam is nearer
double mostOverMirror(const ScanSetup& setup, const BeamShape& shape, double nearest);

/// Bound of the throughput of a mirror path from a surface. @param returned mostOverMirror()
double specularBound(
  const ScanSetup& setup, const Material& material, double cosIncidence, double returned);
}

#endif
