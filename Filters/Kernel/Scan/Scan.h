// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Scan.h
 * @brief Simulates all beams of a scan in parallel and reuses the geometry of earlier runs.
 *
 * Source: paper, Algorithm 2.
 * Differs: blocks of beams run in parallel. Geometry and lit beams are kept between runs.
 * Valid: echoes and reports are bitwise identical for any number of threads. Echoes are also
 * bitwise identical for any order and division of the beams, any tree, and any state of the cache.
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
  std::vector<Echo> echoes;               ///< echoes, in the order of the beams, then by range
  std::vector<std::size_t> beamOfEcho;    ///< index of the beam of each echo
  Waveforms waveforms;                    ///< empty unless the settings request them
  std::vector<BeamReport> reports;        ///< report on each beam
  std::uint64_t raysTraced = 0;           ///< number of rays traced; 0 if all beams were kept
  std::uint64_t beamsTraced = 0;          ///< number of beams whose static surfaces were searched
  std::uint64_t beamsTouched = 0;         ///< number of beams that movers may touch
  std::vector<MoverLight> sights;         ///< light from movers, by beam; empty unless requested
  std::vector<CoincidentPair> coincident; ///< result of findCoincidentObjects()
};

/**
 * Simulate every beam. The state of the cache may change two values of reports: costs, and the
 * bound of the energy that the light-energy constraint drops.
 * @param threads number of threads; 0: OpenMP's choice
 * @param cache beams kept from earlier runs; updated by this run
 * @param maximumBytes largest memory, bytes, for the beams that later runs need not trace again
 * @param sights true: find the light that beams receive from each mover, for reportMovers()
 * @return false if keepGoing returned false; result and cache are then empty
 */
bool simulateScan(const ScanSetup& setup, const ScanBeams& beams, int threads, TraceCache& cache,
  std::size_t maximumBytes, const KeepGoing& keepGoing, ScanResult& result, bool sights = true);
}

#endif
