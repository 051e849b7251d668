// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BlockBeams.h
 * @brief The beams of a block: frames, rays, the hits of rays, and the tracer set to one beam.
 *
 * Each value is computed when a stage first needs this value. No rays are drawn for beams that need
 * no rays.
 *
 * Valid: a value depends only on the beam and the arguments of the constructor, not on the order of
 * the calls.
 * Test: TestScan.cxx, TestScanAgain.cxx.
 */
#ifndef avianlidar_BlockBeams_h
#define avianlidar_BlockBeams_h

#include "BeamSampler.h"
#include "BeamTrace.h"
#include "BeamTracer.h"
#include "RaySamples.h"
#include "ScanBeams.h"
#include "ScanSetup.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace avianlidar
{
/// Each thread needs its own object. The constructor's arguments must outlive the object.
class BlockBeams
{
public:
  BlockBeams(const ScanSetup& setup, const SceneTriangles& scene, const ScanBeams& beams,
    BeamSampler& sampler);

  /// Begin the block of the beams [begin, end).
  void begin(std::size_t begin, std::size_t end);

  const BeamFrame& frameOf(std::size_t beam);
  const BeamRays& raysOf(std::size_t beam);

  /// Triangle that each ray of the beam hits; empty if no rays were traced in this run.
  std::vector<std::uint32_t>& triangles(std::size_t beam) { return this->stateOf(beam).triangles; }

  /// Move the hits of the beam's rays to its trace.
  void takeHits(std::size_t beam, BeamTrace& trace);

  /// Hits from which connections start. The hits of an integrated beam are kept in the trace: one
  /// hit for each ray that meets a visible polygon.
  const BeamSamples& pathStartsOf(std::size_t beam, BeamTrace& trace);

  /// Directions and surfaces of the beam's hits, valid until a call for another beam.
  const SampleGeometry& geometryOf(std::size_t beam, const BeamSamples& hits);

  BeamTracer& tracer() { return this->Tracer; }
  /// The tracer, set to the beam with counters of 0, valid until the next call.
  BeamTracer& tracerOf(std::size_t beam);

  /// Cost of tracing the beam in this run.
  TraceCounters& counters(std::size_t beam) { return this->stateOf(beam).counters; }

private:
  struct BeamState
  {
    std::optional<BeamFrame> frame;       ///< frame of the beam; empty until first needed
    BeamRays rays;                        ///< rays of the beam; empty until first needed
    std::vector<std::uint32_t> triangles; ///< triangles hit by the rays in this run; may be empty
    TraceCounters counters;               ///< cost of tracing in this run
  };
  static constexpr std::size_t NoBeam = static_cast<std::size_t>(-1);

  BeamState& stateOf(std::size_t beam) { return this->BeamStates[beam - this->First]; }
  void makeHits(std::size_t beam, const std::vector<std::uint32_t>& triangles, BeamTrace& trace);

  const ScanSetup& Setup;
  const BeamWidth Width;
  const ScanBeams& Beams;
  BeamSampler& Sampler;
  BeamTracer Tracer;
  RaySamples Finder;
  SampleGeometry Geometry;
  std::vector<std::uint32_t> Own; ///< triangles that the rays of an integrated beam meet
  std::size_t First = 0;          ///< first beam of the block
  std::vector<BeamState> BeamStates;
  std::size_t GeometryBeam = NoBeam; ///< beam that `Geometry` belongs to
};
}

#endif
