// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSimulator.h
 * @brief Echoes of a block of beams: rays, hits, energies, range units, returns.
 *
 * Three stages: tracing (ScanBlock.h) finds the triangle of every ray of all beams of the block, as
 * far as it is not kept from an earlier run. Then, one beam after the other, lighting
 * (BeamLighting.h) sums the energies of all paths in range units, and BeamEchoes.h adds noise and
 * makes returns. Where only noise differs from the scan before, lighting is left out (LitBeam.h). A
 * beam without hits costs nothing after tracing unless noise may raise a false alarm.
 *
 * Source: paper, Algorithm 2.
 * Differs: a block of beams is traced together, and lit from what is kept.
 * Valid: as its three stages.
 * Test: TestScan.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_BeamSimulator_h
#define avianlidar_BeamSimulator_h

#include "BeamEchoes.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// Simulates blocks of beams. One per thread; setup and beams must outlive it. The setup does not
/// change; a beam may, before it is traced.
class BeamSimulator
{
public:
  /// @param keepsLight keep lit beams where noise matters or something moves
  /// @param wanted called every 4096 steps within a beam, and every 512 units for which noise is
  /// drawn; if it returns false, WorkStopped is thrown
  /// @param sampler of the setup's sampling and N, for its sensor and seed; must outlive this
  BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, bool keepsLight,
    BeamSampler& sampler, std::function<bool()> wanted = {});
  BeamSimulator(const BeamSimulator&) = delete;
  BeamSimulator& operator=(const BeamSimulator&) = delete;

  /// What the beams may meet. Movers are placed there before the one beam of a block is traced.
  SceneTriangles& scene() { return this->Scene; }
  const SceneTriangles& scene() const { return this->Scene; }

  /// See ScanBlock::trace().
  std::size_t trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces,
    const std::function<bool(std::size_t)>& leaveOut = {})
  {
    return this->Block.trace(begin, end, traces, leaveOut);
  }

  /// Light beam `beam` of the block traced last: add to its trace, append its echoes, and fill its
  /// report.
  void light(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report);

  /// Light beams also where bounds show that nothing of them can be perceived: for those who look
  /// at lighting().
  void lightAll() { this->Lighting.lightAll(); }

  /// What the air of the beam lit last sends back in a unit, of what a threshold may follow, J.
  double followedIn(std::int64_t unit) { return this->Air.followed(unit); }

  /// What the beam lit last received.
  const BeamLighting& lighting() const { return this->Lighting; }

private:
  void lightBeam(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report);

  SceneTriangles Scene;
  const ScanBeams& Beams;
  const bool KeepsLight;
  ScanBlock Block;
  BeamAir Air;
  BeamReceiver Receiver;
  BeamLighting Lighting;
  BeamEchoes Echoes;
};
}

#endif
