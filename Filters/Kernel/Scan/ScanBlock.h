// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBlock.h
 * @brief Finds what each beam of a block sees, unless it is kept from an earlier run.
 *
 * The triangles that may enter each beam (Candidates.h) give its view (ViewFinder.h). Rays are
 * traced through the tree (BeamTracer.h) where settings ask for them, where a view needs them, and
 * where paths over two reflections start.
 *
 * Source: paper, Algorithm 2 and Sec. 3.2.
 * Differs: see the headers named above.
 * Valid: hits depend only on the beam and the inputs of traceKey(), views as in ViewFinder.h. Both
 * are the same for any division of the beams and any state of the cache.
 * Test: TestScan.cxx, TestScanAgain.cxx, TestBeamCells.cxx.
 */
#ifndef avianlidar_ScanBlock_h
#define avianlidar_ScanBlock_h

#include "BeamSampler.h"
#include "BeamTrace.h"
#include "Candidates.h"
#include "RaySamples.h"
#include "ScanBeams.h"
#include "ScanSetup.h"
#include "ViewFinder.h"

#include <functional>
#include <optional>
#include <vector>

namespace avianlidar
{
/// Traces blocks of beams. One per thread; the constructor's arguments must outlive it.
class ScanBlock
{
public:
  ScanBlock(const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams,
    BeamSampler& sampler);

  /// Find what each beam in [begin, end) sees, unless `traces` (of all beams) already holds it.
  /// @param leaveOut true for beams to skip; empty: none @return number of beams that were searched
  std::size_t trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces,
    const std::function<bool(std::size_t)>& leaveOut = {});

  /// Move the hits of the beam's rays to its trace.
  void takeHits(std::size_t beam, BeamTrace& trace);

  const BeamFrame& frameOf(std::size_t beam);

  /// Hits from which connections start. Those of an integrated beam lie on its polygons, one for
  /// each ray that meets one, and are kept in the trace.
  const BeamSamples& pathStartsOf(std::size_t beam, BeamTrace& trace);

  const BeamRays& raysOf(std::size_t beam);

  /// Directions and surfaces of the beam's hits. Valid until it is called for another beam.
  const SampleGeometry& geometryOf(std::size_t beam, const BeamSamples& hits);

  /// The tracer, set to the beam. Counters begin at 0. Valid until it is called for another beam.
  BeamTracer& tracerOf(std::size_t beam);

  /// Cost of tracing the beam in this run.
  TraceCounters& countersOf(std::size_t beam) { return this->stateOf(beam).counters; }
  void addCounters(std::size_t beam, const TraceCounters& more);

private:
  /// A beam of the block.
  struct BeamState
  {
    std::optional<BeamFrame> frame;       ///< none until first needed
    BeamRays rays;                        ///< empty until first needed
    std::vector<std::uint32_t> triangles; ///< hit by each ray in this run; empty: none
    TraceCounters counters;               ///< cost in this run
  };
  static constexpr std::size_t NoBeam = static_cast<std::size_t>(-1);

  BeamState& stateOf(std::size_t beam) { return this->BeamStates[beam - this->First]; }
  bool needsPathStarts(const BeamTrace& trace) const;
  void findViews(std::vector<BeamTrace>& traces);
  void traceRays();
  void makeHits(std::size_t beam, const std::vector<std::uint32_t>& triangles, BeamTrace& trace);

  const ScanSetup& Setup;
  const SceneTriangles& Scene;
  const BeamWidth Width;
  const ScanBeams& Beams;
  BeamSampler& Sampler;
  BeamTracer Tracer;
  RaySamples Finder;
  SampleGeometry Geometry;
  BeamCandidates Candidates;
  ViewFinder Views;
  std::vector<std::uint32_t> Own; ///< triangles at the rays of an integrated beam
  std::size_t First = 0;          ///< first beam of the block
  std::vector<BeamState> BeamStates;
  std::size_t GeometryBeam = NoBeam; ///< beam that `Geometry` belongs to
  std::size_t TracerBeam = NoBeam;   ///< beam that `Tracer` is set to

  // Frames and numbers of the beams being traced, then of those that need rays.
  std::vector<BeamFrame> Frames;
  std::vector<std::size_t> Traced;
  std::vector<BeamFrame> FramesOfRays;
  std::vector<std::size_t> TracedRays;
};
}

#endif
