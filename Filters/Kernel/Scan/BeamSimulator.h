// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSimulator.h
 * @brief Simulates a block of beams, from rays to returns, in three stages.
 *
 * 1. Tracing (ScanBlock.h) finds what all beams of the block see, unless an earlier run found it.
 * 2. Lighting (BeamLighting.h) sums the energies of all paths of one beam in range units. It is
 *    left out where a scan differs from the scan before only in noise (LitBeam.h).
 * 3. BeamEchoes.h adds noise and makes returns. A beam without hits needs this stage only if noise
 *    may raise a false alarm.
 *
 * Source: paper, Algorithm 2.
 * Differs: a block of beams is traced together, and lit from kept hits.
 * Valid: as the three stages.
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
/// One per thread; setup and beams must outlive this. The setup must not change; a beam may change
/// until it is traced.
class BeamSimulator
{
public:
  /// @param keepsLight keep lit beams where noise matters or something moves
  /// @param wanted called every 4096 steps within a beam, and every 512 units for which noise is
  /// drawn; if it returns false, WorkStopped is thrown
  /// @param sampler draws rays for the sensor, sampling and N of the setup; must outlive this
  BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, bool keepsLight,
    BeamSampler& sampler, std::function<bool()> wanted = {});
  BeamSimulator(const BeamSimulator&) = delete;
  BeamSimulator& operator=(const BeamSimulator&) = delete;

  /// Triangles that beams may meet. Movers are placed here before a block of one beam is traced.
  SceneTriangles& scene() { return this->Scene; }
  const SceneTriangles& scene() const { return this->Scene; }

  /// See ScanBlock::trace().
  std::size_t trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces,
    const std::function<bool(std::size_t)>& leaveOut = {})
  {
    return this->Tracing.trace(begin, end, traces, leaveOut);
  }

  /// Light beam `beam` of the block traced last: add to its trace, append its echoes, and fill its
  /// report.
  void light(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report);

  /// See BeamLighting::lightAll().
  void lightAll() { this->Lighting.lightAll(); }

  /// Mean light that a threshold may follow from the air in a unit of the beam lit last, J.
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
  BeamReceiver Receiver;
  BeamLighting Lighting;
  BeamEchoes Echoes;
};
}

#endif
