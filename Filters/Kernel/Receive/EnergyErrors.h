// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EnergyErrors.h
 * @brief Standard errors of the energies in range units of a beam.
 *
 * The error follows from the rays (StandardError.h), or from the cells and the rays from which
 * paths start. For an integrated beam, the error is a bound for the direct echo plus the standard
 * error of the paths with more reflections. Where an aperture gathers light from two mirrors, the
 * width of the mirrors' lobes adds to the error.
 *
 * Source: none.
 * Valid: the error is NaN where StandardError.h has no estimate. For the bound of integrated beams
 * see PolygonQuadrature.h.
 * Test: TestStandardError.cxx, TestScanReport.cxx, TestCellErrors.cxx, TestPolygonUnits.cxx.
 */
#ifndef avianlidar_EnergyErrors_h
#define avianlidar_EnergyErrors_h

#include "BeamLight.h"
#include "RangeShares.h"
#include "StandardError.h"

#include <cstdint>

namespace avianlidar
{
/// The setup and the estimator must outlive the object.
class EnergyErrors
{
public:
  /// @param ofRays estimator for the beams' rays
  EnergyErrors(const ScanSetup& setup, StandardErrorEstimator& ofRays)
    : Setup(setup)
    , OfRays(ofRays)
  {
  }

  /// Standard error of the energy in a range unit, J. @param shares shares of the beam's
  /// contributions in the unit @param paths number of contributions with a share; 0: a false alarm,
  /// without error
  double of(const BeamLight& light, const RangeShares& shares, std::uint32_t paths) const;

private:
  double ofSamples(const BeamLight& light, const RangeShares& shares, std::uint32_t paths) const;
  double ofRays(const BeamLight& light, const RangeShares& shares, bool filled) const;

  const ScanSetup& Setup;
  StandardErrorEstimator& OfRays;
};
}

#endif
