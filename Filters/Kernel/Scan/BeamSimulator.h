// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSimulator.h
 * @brief Echoes of a block of beams (paper, Algorithm 2): rays, hits, energies, range units,
 * returns.
 *
 * In three stages. Tracing (ScanBlock.h) finds the triangle of every ray of all beams of the block,
 * unless their geometry is known from before. Then, one beam after the other: lighting
 * (BeamLighting.h) sums the energies of all paths in range units; the receiver (BeamEchoes.h) adds
 * noise and makes returns of them, with labels and standard errors. A beam without hits costs
 * nothing there unless noise may alarm.
 */
#ifndef avianlidar_BeamSimulator_h
#define avianlidar_BeamSimulator_h

#include "BeamEchoes.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// One per thread. Setup and beams must outlive it and stay as they are.
class BeamSimulator
{
public:
  /// @param wanted asked now and then within a beam of very many rays; false ends it with
  /// WorkStopped
  /// @param shading number of the setup's: throughputs of others are not used
  BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, std::uint32_t shading,
    std::function<bool()> wanted = {});
  BeamSimulator(const BeamSimulator&) = delete;
  BeamSimulator& operator=(const BeamSimulator&) = delete;

  /// Find the primary hits of beams [begin, end), as far as `traces` (of all beams) does not know
  /// them.
  void trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces)
  {
    this->Block.trace(begin, end, traces);
  }

  /// Light beam `beam` of the block traced last. Its trace is added to; echoes are appended.
  void light(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report);

private:
  const ScanBeams& Beams;
  BeamSamplers Samplers;
  ScanBlock Block;
  BeamReceiver Receiver;
  BeamLighting Lighting;
  BeamEchoes Echoes;
};
}

#endif
