// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Scan.h
 * @brief All beams of a scan, in parallel, with the geometry of earlier runs reused.
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
};

/**
 * Simulate every beam. Echoes and reports are the same bits for any number of threads; echoes for
 * any state of the cache, too, of the reports not costs and the bound of what the light-energy
 * constraint drops.
 * @param threads 0: OpenMP's choice @param cache what is known, updated @param maximumBytes of what
 * beams in the cache hold: beams that would exceed it are traced again next time @return false if
 * keepGoing said stop; the result and the cache are empty then
 */
bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result);
}

#endif
