// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file EnergyErrors.h
 * @brief Standard errors of the energies in range units of a beam whose light
 * BeamLighting has computed.
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

#include "BeamLighting.h"
#include "StandardError.h"

#include <cstdint>

namespace avianlidar
{
/// Errors of one beam after the other. The constructor's arguments must outlive the object.
class EnergyErrors
{
public:
  /// @param lighting results for the beam @param ofRays estimator for the beam's rays
  EnergyErrors(
    const ScanSetup& setup, const BeamLighting& lighting, StandardErrorEstimator& ofRays);

  /// Standard error of the energy in a range unit, J. @param shares shares of the beam's
  /// contributions in the unit @param paths number of contributions with a share; 0: a false alarm,
  /// without error
  double of(const RangeShares& shares, std::uint32_t paths) const;

private:
  double ofSamples(const RangeShares& shares, std::uint32_t paths) const;
  double ofLobes(const RangeShares& shares) const;
  double ofMirrors(const RangeShares& shares) const;
  double ofRays(const RangeShares& shares, bool filled) const;

  const ScanSetup& Setup;
  const BeamLighting& Lighting;
  StandardErrorEstimator& OfRays;
};
}

#endif
