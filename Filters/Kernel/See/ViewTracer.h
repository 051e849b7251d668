// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ViewTracer.h
 * @brief Finds what neighbouring beams see.
 *
 * The view of a beam (ViewFinder.h) is found from the triangles that may enter the beam
 * (Candidates.h) before the range gate ends. If the beam sees nothing there, what lies behind the
 * gate matters only for the report. Rays are traced through the tree (BeamTracer.h) if the settings
 * or a view require rays, or if paths with two reflections start from rays.
 *
 * Source: paper, Algorithm 2 and Sec. 3.2.
 * Differs: see the headers named above.
 * Valid: a view depends only on the beam and the inputs of traceKey() (TraceCache.h). For the
 * seen surfaces see ViewFinder.h. Views are the same for any division of the beams.
 * Test: TestScan.cxx, TestScanAgain.cxx, TestBeamCells.cxx.
 */
#ifndef avianlidar_ViewTracer_h
#define avianlidar_ViewTracer_h

#include "BeamView.h"
#include "Candidates.h"
#include "DrawnRays.h"
#include "PathStarts.h"
#include "ScanBeams.h"
#include "ScanSetup.h"
#include "ViewFinder.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// A beam to look along.
struct BeamToSee
{
  std::size_t beam; ///< number of the beam in the scan
  bool onlyRays;    ///< true: the view is known, and lacks only the hits of rays
};

/// What a beam sees, and the cost of finding it.
struct SeenBeam
{
  BeamView view; ///< only `hits` if the rest of the view was known
  TraceCounters cost;
  SampleGeometry geometry;  ///< geometry of `hits`
  bool hasGeometry = false; ///< whether `geometry` was found
};

/// Looks along some beams at a time. Each thread needs its own object. The constructor's arguments
/// must outlive the object.
class ViewTracer
{
public:
  /// @param beyondGate true: find surfaces behind the range gate in every beam that sees nothing
  /// before the gate
  ViewTracer(const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams,
    DrawnRays& rays, bool beyondGate);

  /// True if paths with two reflections may start from rays whose hits the view lacks.
  bool lacksHits(const BeamView& view) const;

  /// Find what beams see. @param memory result whose memory is used again @return entries for the
  /// entries of `beams`, perhaps followed by entries without meaning
  std::vector<SeenBeam> see(const std::vector<BeamToSee>& beams, std::vector<SeenBeam>&& memory);

private:
  SeenSurfaces findSurfaces(std::size_t beam, const BeamFrame& frame, TraceCounters& cost);
  bool meetsBehindGate(const BeamFrame& frame, TraceCounters& cost);
  void traceRays(const std::vector<BeamToSee>& beams, std::vector<SeenBeam>& seen);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const ScanBeams& Beams;
  DrawnRays& Rays;
  const BeamWidth Width;
  const double Gate; ///< range behind which surfaces do not matter, m
  BeamTracer Tracer;
  BeamCandidates Candidates;
  ViewFinder Views;
  HitFinder Hits;
  // Memory of see(): frames and numbers of the beams whose surfaces are searched, and of the beams
  // that need rays.
  std::vector<BeamFrame> Frames;
  std::vector<std::size_t> Searched;
  std::vector<BeamFrame> FramesOfRays;
  std::vector<std::size_t> TracedRays;
  std::vector<std::size_t> Numbers;
  std::vector<std::uint32_t> Triangles;
};
}

#endif
