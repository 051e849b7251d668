// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Scan.h
 * @brief Simulates all beams of a scan in parallel and reuses the geometry of earlier runs.
 *
 * Source: paper, Algorithm 2.
 * Differs: blocks of beams in parallel; what is known of a beam is kept between runs.
 * Valid: echoes have the same bits for any number of threads, any order and pieces of the beams,
 * any tree, and any state of the cache.
 * Test: TestScan.cxx, TestScanAgain.cxx, TestScanSweep.cxx, TestScanReport.cxx.
 */
#ifndef avianlidar_Scan_h
#define avianlidar_Scan_h

#include "BeamSimulator.h"
#include "CoincidentObjects.h"
#include "MovedBeams.h"
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
  std::uint64_t raysTraced = 0;        ///< in this run; 0 if everything was kept
  std::uint64_t beamsTraced = 0;       ///< beams whose static surfaces were looked for in this run
  std::uint64_t beamsTouched = 0;      ///< beams that movers may touch, which are simulated anew
  std::vector<MoverSight> sights;      ///< in the order of beams, if they are asked for
  std::vector<CoincidentPair> coincident; ///< see findCoincidentObjects()
};

/**
 * Simulate every beam. Echoes and reports have the same bits for any number of threads. Echoes also
 * have the same bits for any state of the cache; of the reports, costs and the bound of what the
 * light-energy constraint drops may differ.
 * @param threads 0: OpenMP's choice
 * @param cache what is kept; updated
 * @param maximumBytes of the beams in the cache; beams beyond it are traced again next time
 * @param sights find what beams receive of each mover, for reportMovers()
 * @return false if keepGoing returned false; the result and the cache are empty then
 */
bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result, bool sights = true);
}

#endif
