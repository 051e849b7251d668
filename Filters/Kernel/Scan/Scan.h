// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Scan.h
 * @brief Simulates all beams of a scan in parallel and reuses the geometry of earlier runs.
 *
 * Source: paper, Algorithm 2.
 * Differs: blocks of beams run in parallel; geometry and lit beams are kept between runs.
 * Valid: echoes and reports have the same bits for any number of threads; echoes also for any order
 * and division of the beams, any tree, and any state of the cache.
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
  std::uint64_t raysTraced = 0;        ///< rays traced in this run; 0 if everything was kept
  std::uint64_t beamsTraced = 0;       ///< beams whose static surfaces were searched in this run
  std::uint64_t beamsTouched = 0;      ///< beams that movers may touch, simulated in every run
  std::vector<MoverSight> sights;      ///< in the order of beams; empty unless asked for
  std::vector<CoincidentPair> coincident; ///< see findCoincidentObjects()
};

/**
 * Simulate every beam. The state of the cache may change costs in reports, and the bound of what
 * the light-energy constraint drops.
 * @param threads number of threads; 0: OpenMP's choice
 * @param cache beams kept from earlier runs; updated
 * @param maximumBytes largest memory for kept beams, bytes; other beams are traced again in later
 * runs
 * @param sights true: find the light that beams receive from each mover, for reportMovers()
 * @return false if keepGoing returned false; result and cache are then empty
 */
bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result, bool sights = true);
}

#endif
