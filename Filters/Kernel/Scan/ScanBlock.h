// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBlock.h
 * @brief First stage of a block of beams: finds how many rays each beam needs and which triangles
 * they hit, as far as that is not kept from an earlier run.
 *
 * It traces pilots where a target error is set, the beams' rays, the rays of small targets
 * (SmallTargets.h), and more rays for beams near Qlow (RayBudget.h). Before any rays it looks for
 * the polygons that a beam sees: if they are few, the beam is integrated and needs no rays
 * (VisiblePolygons.h, PolygonQuadrature.h).
 *
 * Source: paper, Algorithm 2 and Sec. 3.2.
 * Differs: see the headers named above; the paper draws N rays for every beam.
 * Valid: the same hits for any pieces of the beams and any state of what is kept.
 * Test: TestScan.cxx, TestScanAgain.cxx, TestSmallTargets.cxx, TestTargetsAndOthers.cxx,
 * TestPolygonScan.cxx.
 */
#ifndef avianlidar_ScanBlock_h
#define avianlidar_ScanBlock_h

#include "BeamCells.h"
#include "BeamSamplers.h"
#include "BeamTrace.h"
#include "PolygonQuadrature.h"
#include "RayBudget.h"
#include "RaySamples.h"
#include "ScanBeams.h"
#include "ScanSetup.h"
#include "SmallTargets.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// Traces blocks of beams. One per thread; setup, beams and samplers must outlive it.
class ScanBlock : private BeamPreTest
{
public:
  /// @param light number of the setup's LightKey, or 0: beams lit with it need nothing
  ScanBlock(
    const ScanSetup& setup, const ScanBeams& beams, std::uint32_t light, BeamSamplers& samplers);

  /// The setup has other surfaces now.
  void followSurfaces();

  /// Find the primary hits of beams [begin, end) that `traces` (of all beams) lacks.
  void trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces);

  /// Move what was found of a beam to its trace, and remove what followed from other hits.
  void takeHits(std::size_t beam, BeamTrace& trace);

  const BeamFrame& frameOf(std::size_t beam);

  /// True if the beam is integrated over its polygons and so has no rays.
  bool isIntegrated(std::size_t beam) { return this->slotOf(beam).integrated; }

  /// True if direct echoes of the beam are those of its cells; its rays are where paths over two
  /// reflections start.
  bool isInCells(std::size_t beam) { return this->slotOf(beam).inCells; }

  /// Points of an integrated beam from which paths over two reflections start: N rays, as a sampled
  /// beam has them, each on what the polygons show there. They are kept as the hits of the trace.
  const BeamSamples& pathStartsOf(std::size_t beam, BeamTrace& trace);

  /// The N rays of the beam's hits. @param samples the hits
  const BeamRays& raysOf(std::size_t beam, const BeamSamples& samples)
  {
    return this->raysOf(beam, samples.rays, RandomPurpose::Rays);
  }

  /// Directions and surfaces of the beam's hits. Valid until it is called for another beam.
  const SampleGeometry& geometryOf(std::size_t beam, const BeamSamples& samples);

  /// The tracer, set to the beam with counters at 0. Valid until it is called for another beam.
  BeamTracer& tracerOf(std::size_t beam);

  /// True if rays or polygons of the beam were looked for in trace(); before its paths are traced.
  bool wasTraced(std::size_t beam)
  {
    const Slot& slot = this->slotOf(beam);
    return slot.preTested || slot.counters.raysTraced > 0;
  }

  /// Cost of tracing in this run.
  TraceCounters& countersOf(std::size_t beam) { return this->slotOf(beam).counters; }
  void addCounters(std::size_t beam, const TraceCounters& more);

  /// The beam's trace has changed in this run.
  void markChanged(std::size_t beam) { this->slotOf(beam).changed = true; }
  bool isChanged(std::size_t beam) const { return this->Slots[beam - this->First].changed; }

private:
  /// A beam of the block.
  struct Slot
  {
    BeamFrame frame;
    BeamRays rays;
    std::uint32_t raysDrawn = 0;
    RandomPurpose purpose = RandomPurpose::Rays;
    std::uint32_t raysWanted = 0;
    std::uint32_t raysMissing = 0;        ///< to be traced now
    std::vector<std::uint32_t> triangles; ///< of each ray, those of targets last; empty if none
                                          ///< hit, or if kept from before
    BeamTargets targets;
    RandomPurpose targetsDrawn = RandomPurpose::Rays; ///< purpose of the targets' rays, if drawn
    std::unique_ptr<BeamSamples> first;    ///< samples of the first N rays, if they hit anything
    bool firstTraced = false;              ///< they were traced in this run
    TraceCounters counters;                ///< of this run
    SeenByBeam seen = SeenByBeam::Unknown; ///< found in this run, or before
    bool preTested = false;                ///< in this run
    std::unique_ptr<VisiblePolygons> polygons; ///< found in this run
    std::unique_ptr<CellSamples> cells;        ///< likewise
    bool integrated = false;
    bool inCells = false;
    bool lit = false; ///< before, with the same key: hits are those that it needs
    bool framed = false;
    bool changed = false;
  };
  static constexpr std::size_t NoBeam = static_cast<std::size_t>(-1);

  Slot& slotOf(std::size_t beam) { return this->Slots[beam - this->First]; }
  const BeamRays& raysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose);
  void beginBlock(std::size_t begin, std::size_t end, const std::vector<BeamTrace>& traces);
  void tracePilots(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces);
  void tracePrimary(std::size_t begin, std::size_t end, RandomPurpose purpose);
  void findCells(Slot& slot);
  bool fits(const BeamFrame& frame, const VisiblePolygons& seen);
  bool begin(std::size_t beam) override;
  bool leaf(const std::uint32_t* triangles, std::uint32_t count) override;
  bool end() override;
  void traceTargets(std::size_t begin, std::size_t end, RandomPurpose purpose);
  const BlockHits& traceBeams(const std::function<const BeamRays&(std::size_t)>& source,
    BeamPreTest* preTest, bool inOrder = false);
  bool isKnown(std::size_t beam, const BeamTrace& trace);
  bool isPilotKnown(std::size_t beam, const BeamTrace& trace);
  bool isFirstKnown(std::size_t beam, const BeamTrace& trace);
  bool haveTargetsStayed(std::size_t beam, const BeamTrace& trace);
  void thinPaths(std::size_t beam, BeamSamples& samples) const;
  void refine(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces);
  const BeamTargets& targetsOf(std::size_t beam);
  TargetRays raysOfTargets(std::size_t beam, RandomPurpose purpose);
  const BeamTargets& drawTargets(std::size_t beam, RandomPurpose purpose);
  const BeamRays& allRaysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose);
  void makeHits(std::size_t beam, std::uint32_t rays, RandomPurpose purpose, BeamSamples& samples);

  const ScanSetup& Setup;
  const BeamWidth Width;
  const ScanBeams& Beams;
  const std::uint32_t Light;
  BeamSamplers& Samplers;
  BeamTracer Tracer;
  RaySamples Finder;
  SampleGeometry Geometry;
  RayBudget Budget;
  PolygonFinder Polygons;
  PolygonQuadrature Quadrature;
  BeamCells Cells;
  Slot* PreTested = nullptr; ///< the beam being pre-tested
  std::size_t PreTestedBeam = 0;
  SmallTargets Targets;
  const bool Integrates;          ///< beams that few triangles enter need no rays
  const bool UsesCells;           ///< beams that many triangles enter are divided into cells
  const bool Refines;             ///< beams near Qlow may get more rays
  BeamRays AllRays;               ///< N and those of targets, of the beam asked for last
  std::vector<std::uint32_t> Own; ///< triangles of some rays
  std::size_t First = 0;          ///< beam of the block
  std::vector<Slot> Slots;
  std::size_t GeometryBeam = NoBeam; ///< beam that `Geometry` belongs to
  std::size_t TracerBeam = NoBeam;   ///< beam that `Tracer` is set to

  // The beams being traced: frames, missing rays, numbers.
  std::vector<BeamFrame> Frames;
  std::vector<std::uint32_t> Missing;
  std::vector<std::size_t> Traced;
};

/// Add costs of one beam; of its candidates the larger number counts.
void addCounters(const TraceCounters& more, TraceCounters& sum);
}

#endif
