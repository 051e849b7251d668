// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSimulator.h
 * @brief Simulates a block of beams, from rays to returns, in three stages.
 *
 * 1. Tracing (ScanBlock.h) finds the surfaces that each beam of the block sees, unless the surfaces
 *    are kept from an earlier run.
 * 2. Lighting (BeamLighting.h) sums the energies of all paths of one beam in range units. Lighting
 *    is skipped where a scan differs from the scan before only in noise (LitBeam.h).
 * 3. BeamEchoes.h adds noise and makes returns. A beam without hits skips this stage unless noise
 *    may cause a false alarm.
 *
 * Source: paper, Algorithm 2.
 * Differs: the beams of a block are traced together, and lit from kept hits.
 * Valid: see the headers of the three stages.
 * Test: TestScan.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_BeamSimulator_h
#define avianlidar_BeamSimulator_h

#include "BeamEchoes.h"
#include "ScanBlock.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// Each thread needs its own object. Setup and beams must outlive the object. The setup must not
/// change. A beam may change until it is traced.
class BeamSimulator
{
public:
  /// @param keepsLight true: keep lit beams where noise matters or surfaces move
  /// @param wanted function called every 4096 steps within a beam, and every 512 units for which
  /// noise is drawn; WorkStopped is thrown if it returns false
  /// @param sampler sampler for the sensor, sampling and N of the setup; must outlive the object
  BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, bool keepsLight,
    BeamSampler& sampler, std::function<bool()> wanted = {});
  BeamSimulator(const BeamSimulator&) = delete;
  BeamSimulator& operator=(const BeamSimulator&) = delete;

  /// Triangles that beams may meet. Movers are added to the triangles before a block of one beam is
  /// traced.
  SceneTriangles& scene() { return this->Scene; }
  const SceneTriangles& scene() const { return this->Scene; }

  /// See ScanBlock::trace().
  std::size_t trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces,
    const std::function<bool(std::size_t)>& leaveOut = {})
  {
    return this->Tracing.trace(begin, end, traces, leaveOut);
  }

  /// Sums the energies of beam `beam` of the block traced last, adds new hits and paths to the
  /// beam's trace, appends the beam's echoes, and fills the beam's report.
  void light(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report);

  /// See BeamLighting::lightAll().
  void lightAll()
  {
    this->Tracing.lightAll();
    this->Lighting.lightAll();
  }

  /// Mean light from the air, J, that a threshold may follow in a unit of the beam lit last.
  double followedIn(std::int64_t unit) { return this->Air.followed(unit); }

  /// Results for the beam lit last.
  const BeamLighting& lighting() const { return this->Lighting; }

private:
  void lightBeam(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report);

  SceneTriangles Scene;
  const ScanBeams& Beams;
  const bool KeepsLight;
  BlockBeams Block;
  ScanBlock Tracing;
  BeamAir Air;
  LeafGaps Gaps;
  BeamReceiver Receiver;
  BeamLighting Lighting;
  BeamEchoes Echoes;
};
}

#endif
