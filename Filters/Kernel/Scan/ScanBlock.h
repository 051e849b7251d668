// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBlock.h
 * @brief Finds the surfaces that each beam of a block sees, unless the surfaces are kept from an
 * earlier run.
 *
 * The view of a beam (ViewFinder.h) is found from the triangles that may enter the beam
 * (Candidates.h) before the range gate ends. If the beam sees nothing there, what lies behind the
 * gate matters only for the report. Rays are traced through the tree (BeamTracer.h) if the settings
 * or a view require rays, or if paths with two reflections start from rays.
 *
 * Source: paper, Algorithm 2 and Sec. 3.2.
 * Differs: see the headers named above.
 * Valid: hits depend only on the beam and the inputs of traceKey(). For views see ViewFinder.h.
 * Hits and views are the same for any division of the beams and any state of the cache.
 * Test: TestScan.cxx, TestScanAgain.cxx, TestBeamCells.cxx.
 */
#ifndef avianlidar_ScanBlock_h
#define avianlidar_ScanBlock_h

#include "BeamTrace.h"
#include "BlockBeams.h"
#include "Candidates.h"
#include "ScanBeams.h"
#include "ScanSetup.h"
#include "ViewFinder.h"

#include <functional>
#include <limits>
#include <vector>

namespace avianlidar
{
/// Traces blocks of beams. Each thread needs its own object. The constructor's arguments must
/// outlive the object.
class ScanBlock
{
public:
  ScanBlock(
    const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams, BlockBeams& block);

  /// Find what each beam in [begin, end) sees, unless `traces` (of all beams) already holds it.
  /// @param leaveOut function that is true for beams to skip; empty: no beam is skipped @return
  /// number of beams for which something was traced
  std::size_t trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces,
    const std::function<bool(std::size_t)>& leaveOut = {});

  /// See BeamLighting::lightAll().
  void lightAll() { this->Gate = std::numeric_limits<double>::infinity(); }

private:
  bool needsPathStarts(const BeamTrace& trace) const;
  void addRaysOf(std::size_t beam);
  BeamView findView(std::size_t beam);
  bool meetsBehindGate(std::size_t beam);
  void findViews(std::vector<BeamTrace>& traces);
  void traceRays();

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const ScanBeams& Beams;
  BlockBeams& Block;
  double Gate; ///< range behind which surfaces do not matter, m
  BeamCandidates Candidates;
  ViewFinder Views;

  // Frames and numbers of the beams whose views are searched, and of the beams that need rays.
  std::vector<BeamFrame> Frames;
  std::vector<std::size_t> Searched;
  std::vector<BeamFrame> FramesOfRays;
  std::vector<std::size_t> TracedRays;
};
}

#endif
