// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamEchoes.h
 * @brief Makes echoes of the returns of a beam, with standard errors (EnergyErrors.h) and labels
 * (EchoLabels.h).
 *
 * Source: paper, Eq. 10-12.
 * Differs: the paper gives one point per perceived range unit, without labels. Returns are defined
 * in BeamReceiver.h.
 * Valid: the standard error is NaN where
 * StandardError.h gives no error. For an integrated beam the standard error includes the bound of
 * PolygonQuadrature.h.
 * Test: TestScanReport.cxx, TestScan.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_BeamEchoes_h
#define avianlidar_BeamEchoes_h

#include "BeamReceiver.h"
#include "EchoLabels.h"
#include "EnergyErrors.h"
#include "LitBeam.h"

#include <optional>
#include <vector>

namespace avianlidar
{
/// Makes the echoes of one beam after the other. Each thread needs its own object. The
/// constructor's arguments must outlive the object.
class BeamEchoes
{
public:
  BeamEchoes(const ScanSetup& setup, BeamReceiver& receiver, StandardErrorEstimator& ofRays);

  /// What the receiver reports of a beam.
  struct Report
  {
    BeamStatus status;
    double range; ///< range of the strongest return, m; NaN without a return
  };

  /// Append the echoes of a beam. @param keep output: those values of the returns that do not
  /// depend on noise; may be null
  Report add(
    const Received& received, const BeamLight& light, LitBeam* keep, std::vector<Echo>& echoes);

  /// Append the echoes of a beam whose light was kept. @return no report, with echoes unchanged, if
  /// `known` lacks a return
  std::optional<Report> addKnown(
    const Received& received, const LitBeam& known, std::vector<Echo>& echoes);

private:
  template <class F>
  Report finish(
    const Received& received, F echoOf, bool outsideGate, bool meets, std::vector<Echo>& echoes);
  Echo echoOfLight(const Received& received, const BeamLight& light, const Return& ret);

  const ScanSetup& Setup;
  BeamReceiver& Receiver;
  EchoLabels Labels;
  EnergyErrors Errors;
  ShareFinder Shares; ///< memory of add()
};
}

#endif
