// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Scan.h
 * @brief All beams of a scan, in parallel, with the geometry of earlier runs reused, and the echoes
 * of the run before where they cannot have changed.
 */
#ifndef avianlidar_Scan_h
#define avianlidar_Scan_h

#include "BeamSimulator.h"
#include "ParallelLoop.h"
#include "TraceCache.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
struct ScanResult
{
  std::vector<Echo> echoes;            ///< in the order of the beams, nearest first within a beam
  std::vector<std::size_t> beamOfEcho; ///< index of the beam of each echo
  std::vector<BeamReport> reports;     ///< one per beam
  std::uint64_t raysTraced = 0;        ///< in this run: 0 when everything was known
  std::size_t beamsLit = 0;            ///< in this run, with or without hits
  std::uint64_t run = 0;               ///< number of the run, never the same twice; 0: none
  std::uint64_t before = 0;            ///< run from whose reports those of `changed` alone differ
  std::vector<std::uint32_t> changed;  ///< beams, ascending; without meaning where `before` is 0
  std::size_t bytes() const;
};

/**
 * Simulate every beam. If `result` is that of the run before with the same cache, beams whose
 * echoes cannot have changed (BeamOutcome.h) keep them. Echoes and reports are the same bits for
 * any number of threads; echoes for any state of the cache, too, of the reports not costs and the
 * bound of what the light-energy constraint drops.
 * @param threads 0: OpenMP's choice @param cache what is known, updated @param maximumBytes of what
 * beams in the cache hold, its memory and the result together: beams that would exceed it are
 * traced again next time, and if the rest does not fit beside them, the cache remembers no run and
 * the result is of no use to the next. So it is with noise or a target error, too @return false if
 * keepGoing said stop; the result and the cache are empty then
 */
bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result);
}

#endif
