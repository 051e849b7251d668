// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamReport.h
 * @brief The report on each beam of a scan, and on the light that a beam receives from a mover.
 *
 * Source: none.
 * Valid: reports of a scan are the same for any division of the beams and any state of the cache,
 * except for costs.
 * Test: TestScanReport.cxx, TestMovedBeams.cxx.
 */
#ifndef avianlidar_BeamReport_h
#define avianlidar_BeamReport_h

#include "BeamTracer.h"
#include "BeamView.h"
#include "Echo.h"

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
struct BeamReport
{
  DirectEcho direct = DirectEcho::Unknown;
  bool isCrowded = false; ///< true if more triangles enter the beam than lists hold
  BeamStatus status = BeamStatus::NoSurface;
  double range = 0.0;              ///< range of the strongest return, m; NaN without a return
  TraceCounters counters;          ///< cost of tracing the beam in this run and in earlier runs
  std::uint64_t raysTracedNow = 0; ///< number of rays traced in this run; 0 if all parts were kept
  std::uint32_t skipped = 0;       ///< bits of SkippedPart, except noise
  /// Bound of the energy that was left out, J. Paths without energy do not count. For a beam left
  /// out as a whole, the value is a bound, below Qlow, of the energy of the strongest range unit.
  double lost = 0.0;
};

/// Light, without noise, that one beam receives from one mover on paths with one reflection.
struct MoverLight
{
  std::uint32_t mover;
  std::size_t beam;
  double energy;      ///< energy of the strongest range unit, J
  double probability; ///< probability that a range unit with only this light is perceived
  double offAxis;     ///< angle from the beam's axis to the mover's position, rad
  bool held;          ///< whether the mover's position lies in the beam
};
}

#endif
