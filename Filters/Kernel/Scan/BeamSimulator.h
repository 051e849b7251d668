// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSimulator.h
 * @brief Follows beams from their axes to their echoes.
 *
 * trace() finds what neighbouring beams see, as these beams are traced together (ViewTracer.h).
 * Then follow() takes each beam through the other stages alone: the starts of its paths
 * (PathStarts.h), the air along it (AirFinder.h), its light (BeamLighting.h), and what the receiver
 * makes of the light (BeamReceiver.h, BeamEchoes.h).
 * What is kept from an earlier scan is not computed again. Light is not computed where a scan
 * differs from the scan before only in noise (LitBeam.h).
 *
 * Source: paper, Algorithm 2.
 * Differs: neighbouring beams are traced together, and lit from kept views.
 * Valid: see the headers of the stages.
 * Test: TestScan.cxx, TestEchoClosedForms.cxx.
 */
#ifndef avianlidar_BeamSimulator_h
#define avianlidar_BeamSimulator_h

#include "AirFinder.h"
#include "BeamEchoes.h"
#include "BeamLighting.h"
#include "BeamReceiver.h"
#include "BeamReport.h"
#include "BeamWaveforms.h"
#include "KeptBeam.h"
#include "ViewTracer.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace avianlidar
{
/// How a scan is simulated.
struct ScanOptions
{
  bool keepsLight = false; ///< whether light is kept where noise matters or surfaces move
  bool lightsAll = false;  ///< whether light is computed that is surely not perceived
};

/// What beams give, one beam after the other.
struct BeamResults
{
  std::vector<Echo> echoes;
  Waveforms waveforms; ///< empty unless the settings request them
};

/// Each thread needs its own object. Setup, air, beams and sampler must outlive the object. The
/// setup must not change. A beam may change until it is traced.
class BeamSimulator
{
public:
  /// @param air air of the setup
  /// @param wanted function called every 4096 steps within a beam, and every 512 units for which
  /// noise is drawn; WorkStopped is thrown if it returns false
  /// @param sampler sampler for the sensor, sampling and N of the setup
  BeamSimulator(const ScanSetup& setup, const ScanAir& air, const ScanBeams& beams,
    const ScanOptions& options, BeamSampler& sampler, std::function<bool()> wanted = {});
  BeamSimulator(const BeamSimulator&) = delete;
  BeamSimulator& operator=(const BeamSimulator&) = delete;

  /// Triangles that beams may meet. Movers are added to the triangles before a single beam is
  /// traced.
  SceneTriangles& scene() { return this->Scene; }
  const SceneTriangles& scene() const { return this->Scene; }

  /// What was traced in this run.
  class Traced
  {
  public:
    /// Number of beams for which something was traced.
    std::size_t size() const { return this->Count; }
    /// What was traced of a beam; nothing if all was kept.
    SeenBeam& of(std::size_t beam);

  private:
    friend class BeamSimulator;

    std::size_t First = 0;
    std::size_t Count = 0;
    std::vector<std::size_t> Places; ///< by beam: place in `Seen`, or past its end
    std::vector<SeenBeam> Seen;
    SeenBeam Nothing;
  };
  /// Find what each beam in [begin, end) sees, unless `kept` (of all beams) already holds it.
  /// @param leaveOut function that is true for beams to skip; empty: no beam is skipped @param
  /// memory result whose memory is used again
  Traced trace(std::size_t begin, std::size_t end, std::vector<KeptBeam>& kept,
    const std::function<bool(std::size_t)>& leaveOut, Traced&& memory);

  /// Follow a traced beam to its echoes: add new geometry of paths to `kept`, append the results,
  /// and fill the report. @param traced what was traced of the beam @param memory light
  /// whose memory is used again @return light of the beam; without samples if kept light was used
  BeamLight follow(std::size_t beam, SeenBeam& traced, KeptBeam& kept, BeamResults& results,
    BeamReport& report, BeamLight&& memory);

private:
  bool followKnown(
    std::size_t beam, const LitBeam& lit, std::vector<Echo>& echoes, BeamReport& report);

  SceneTriangles Scene;
  const ScanSetup& Setup;
  const ScanAir& Air;
  const ScanBeams& Beams;
  const BeamWidth Width;
  const bool KeepsLight;
  DrawnRays Rays;
  ViewTracer Tracing;
  HitFinder Hits;
  AirFinder AirAlong;
  BeamReceiver Receiver;
  BeamLighting Lighting;
  StandardErrorEstimator OfRays; ///< memory of Echoes
  BeamEchoes Echoes;
  std::unique_ptr<BeamWaveforms> Recording; ///< null without waveforms
  std::unique_ptr<BeamLighting> Dividing;   ///< null without several samples in a range unit
  BeamLight Divided;                        ///< memory of `Dividing`
};
}

#endif
