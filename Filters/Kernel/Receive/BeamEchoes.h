// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamEchoes.h
 * @brief Makes echoes of the returns of a beam, with standard errors (EnergyErrors.h) and labels
 * (EchoLabels.h).
 *
 * Source: paper, Eq. 10-12.
 * Differs: the paper gives one point per perceived range unit, without labels. Returns are defined
 * in BeamReceiver.h.
 * Valid: the standard error is NaN where StandardError.h gives no error. For an integrated beam the
 * standard error includes the bound of PolygonQuadrature.h.
 * Test: TestScanReport.cxx, TestScan.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_BeamEchoes_h
#define avianlidar_BeamEchoes_h

#include "EchoLabels.h"
#include "EnergyErrors.h"
#include "ReturnRanges.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Numbers of the first, last and strongest range unit of a return.
struct UnitsOfReturn
{
  std::int64_t first, last, strongest;

  bool operator==(const UnitsOfReturn& other) const
  {
    return this->first == other.first && this->last == other.last &&
      this->strongest == other.strongest;
  }
};

UnitsOfReturn unitsOf(const Received& received, const Return& ret);

/// The part of an echo that follows from light alone: it is the same in all scans in which a return
/// has these units.
struct LightEcho
{
  UnitsOfReturn units;
  Echo echo; ///< with range, labels and standard error
};

/// Makes the echoes of one beam after the other. Each thread needs its own object. The
/// constructor's arguments must outlive the object.
class BeamEchoes
{
public:
  BeamEchoes(const ScanSetup& setup, StandardErrorEstimator& ofRays);

  /// What follows from light alone, for all returns with light that add() needs.
  std::vector<LightEcho> ofLight(const Received& received, const BeamLight& light);

  /// What the receiver reports of a beam.
  struct Report
  {
    BeamStatus status;
    double range; ///< range of the strongest return, m; NaN without a return
  };

  /// Append the echoes of a beam. @param ofLight what follows from light for all returns with
  /// light @param meets true if the beam meets a surface @param outsideGate see
  /// BeamLight::isOutsideGate(). The value follows from direct echoes alone, as the cache may
  /// change which paths with two reflections are traced.
  Report add(const Received& received, const std::vector<LightEcho>& ofLight, bool meets,
    bool outsideGate, std::vector<Echo>& echoes) const;

private:
  Echo echoOf(const Received& received, const Return& ret, std::size_t& place,
    const std::vector<LightEcho>& ofLight) const;

  const ScanSetup& Setup;
  const ReturnRanges Ranges;
  EchoLabels Labels;
  EnergyErrors Errors;
  ShareFinder Shares; ///< memory of ofLight()
};
}

#endif
