// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBlock.h
 * @brief First stage of a block of beams: how many rays each needs, and which triangles they hit,
 * as far as that is not known from before.
 */
#ifndef avianlidar_ScanBlock_h
#define avianlidar_ScanBlock_h

#include "BeamSamplers.h"
#include "BeamTrace.h"
#include "PlaneQuadrature.h"
#include "RayBudget.h"
#include "RaySamples.h"
#include "ScanBeams.h"
#include "ScanSetup.h"
#include "SmallTargets.h"

#include <functional>
#include <vector>

namespace avianlidar
{
/// One per thread. Setup, beams and samplers must outlive it.
class ScanBlock : private BeamPreTest
{
public:
  ScanBlock(const ScanSetup& setup, const ScanBeams& beams, BeamSamplers& samplers);

  /// Find the primary hits of beams [begin, end), as far as `traces` (of all beams) does not know
  /// them.
  void trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces);

  /// What was found becomes known, and all that followed from other hits is forgotten.
  void takeHits(std::size_t beam, BeamTrace& trace);

  const BeamFrame& frameOf(std::size_t beam);

  /// The beam is integrated over its patch: it has no rays.
  bool isIntegrated(std::size_t beam) { return this->slotOf(beam).integrated; }

  /// The N rays that were drawn for the beam's hits, which the caller gives.
  const BeamRays& raysOf(std::size_t beam, const BeamSamples& samples)
  {
    return this->raysOf(beam, samples.rays, RandomPurpose::Rays);
  }

  /// Directions and surfaces of the beam's hits; they stand until the next beam is asked for.
  const SampleGeometry& geometryOf(std::size_t beam, const BeamSamples& samples);

  /// The tracer, set to the beam; its counters begin at 0 then. They stand until the next beam is
  /// asked for.
  BeamTracer& tracerOf(std::size_t beam);

  /// What tracing has cost in this run.
  TraceCounters& countersOf(std::size_t beam) { return this->slotOf(beam).counters; }
  void addCounters(std::size_t beam, const TraceCounters& more);

  /// More is known of the beam than before.
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
                                          ///< hit, or known from before
    BeamTargets targets;
    RandomPurpose targetsDrawn = RandomPurpose::Rays; ///< what the targets' rays are for, if drawn
    std::unique_ptr<BeamSamples> first;               ///< of the first N rays, if they hit anything
    bool firstTraced = false;                         ///< they were traced in this run
    TraceCounters counters;                           ///< of this run
    std::unique_ptr<VisiblePatch> patch;              ///< found in this run
    bool preTested = false;                           ///< in this run
    bool again = false;          ///< what is known was sampled, but may be integrated
    double footprint = 0.0;      ///< see BeamTrace
    bool preTestMissing = false; ///< to be pre-tested now
    bool integrated = false;
    bool framed = false;
    bool changed = false;
  };
  static constexpr std::size_t NoBeam = static_cast<std::size_t>(-1);

  Slot& slotOf(std::size_t beam) { return this->Slots[beam - this->First]; }
  const BeamRays& raysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose);
  bool looksFilled(Slot& slot, const std::uint32_t* triangles, std::size_t count);
  void beginBlock(std::size_t begin, std::size_t end, const std::vector<BeamTrace>& traces);
  void tracePilots(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces);
  void tracePrimary(std::size_t begin, std::size_t end, RandomPurpose purpose);
  bool begin(std::size_t beam, const std::uint32_t* triangles, std::size_t count) override;
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
  const std::vector<std::uint32_t>& trianglesOf(const BeamSamples& samples);
  const BeamTargets& targetsOf(std::size_t beam);
  TargetRays raysOfTargets(std::size_t beam, RandomPurpose purpose);
  const BeamTargets& drawTargets(std::size_t beam, RandomPurpose purpose);
  const BeamRays& allRaysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose);
  void makeHits(std::size_t beam, std::uint32_t rays, RandomPurpose purpose, BeamSamples& samples);

  const ScanSetup& Setup;
  const BeamWidth Width;
  const ScanBeams& Beams;
  BeamSamplers& Samplers;
  BeamTracer Tracer;
  RaySamples Finder;
  SampleGeometry Geometry;
  RayBudget Budget;
  PatchFinder Patches;
  PlaneQuadrature Quadrature;
  Slot* PreTested = nullptr; ///< the beam being pre-tested
  SmallTargets Targets;
  const bool Refines;             ///< beams near Qlow may get more rays
  BeamRays AllRays;               ///< N and those of targets, of the beam asked for last
  std::vector<std::uint32_t> Own; ///< triangles of some rays
  std::size_t First = 0;          ///< beam of the block
  std::vector<Slot> Slots;
  std::size_t GeometryBeam = NoBeam; ///< whose `Geometry` is
  std::size_t TracerBeam = NoBeam;   ///< to which `Tracer` is set

  // The beams being traced, and what is needed of them.
  std::vector<BeamFrame> Frames;
  std::vector<std::uint32_t> Missing;
  std::vector<std::size_t> Traced;
};

/// Costs of one beam add up; of its candidates the most count.
void addCounters(const TraceCounters& more, TraceCounters& sum);
}

#endif
