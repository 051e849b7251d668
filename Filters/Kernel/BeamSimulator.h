// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSimulator.h
 * @brief Echoes of a block of beams (paper, Algorithm 2): rays, hits, energies, range units,
 * returns.
 *
 * In two stages, tracing and lighting. Tracing finds the triangle of every ray of all beams of the
 * block, unless their geometry is known from before. Lighting takes one beam after the other:
 * direct echo of every hit (paper, Eq. 4-9); paths over two reflections; the light-energy
 * constraint; sums in range units, noise, dynamic range (Eq. 10-12); returns with their labels and
 * standard errors. A beam without hits costs nothing there unless noise may alarm.
 *
 * A beam all of whose energy, by upper bounds, would not be perceived if it arrived in one range
 * unit is done before anything is traced on from its hits: it has no echo (where noise does not
 * matter, and with the light-energy constraint, which is the switch for such savings).
 *
 * Light-energy constraint: a path is dropped when it carries less than epsilon Qlow / (paths of the
 * beam), epsilon = 1e-3, and not even traced when a bound says so. All secondary paths of a beam
 * are skipped when their bounds, with those already dropped, sum to less than epsilon Qlow. No
 * range unit so loses more than epsilon Qlow.
 */
#ifndef avianlidar_BeamSimulator_h
#define avianlidar_BeamSimulator_h

#include "BeamOutcome.h"
#include "BeamTrace.h"
#include "DirectLight.h"
#include "EchoLabels.h"
#include "Receiver.h"
#include "ScanSetup.h"
#include "SecondaryReflection.h"
#include "StandardError.h"

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace avianlidar
{
enum class BeamStatus
{
  Echo = 0,
  NoSurface = 1,
  BelowLimit = 2,
  Saturated = 3,
  OutsideGate = 4 ///< direct echoes that are not dropped, all of them beyond
};

struct BeamReport
{
  BeamStatus status = BeamStatus::NoSurface;
  double range = 0.0;              ///< m, of the strongest return; NaN without one
  TraceCounters counters;          ///< of all tracing that the beam's geometry has cost
  std::uint64_t raysTracedNow = 0; ///< in this run: 0 when everything was known
  /// J, sum of the bounds of paths that the light-energy constraint dropped, as far as they are not
  /// known to lead nowhere.
  double lost = 0.0;
};

struct ScanBeams
{
  std::vector<std::uint64_t> ids; ///< unique; key of the beam's random numbers
  std::vector<Vec3> origins;      ///< m
  std::vector<Vec3> directions;   ///< finite, not zero; need not be normalised
  std::uint64_t checksum = 0;     ///< checksumOf() them; 0: not known
  std::size_t size() const { return this->ids.size(); }
};

/// One per thread. Setup and beams must outlive it and stay as they are.
class BeamSimulator
{
public:
  /// @param wanted asked now and then within a beam of very many rays; false ends it with
  /// WorkStopped
  /// @param shading the setup's: strengths of others are not used
  BeamSimulator(const ScanSetup& setup, const ScanBeams& beams, const ShadingChange& shading,
    std::function<bool()> wanted = {});
  ~BeamSimulator();

  /// Find the primary hits of beams [begin, end), as far as `traces` (of all beams) does not know
  /// them.
  void trace(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces);

  /// Light beam `beam` of the block traced last. Its trace is added to; echoes are appended.
  /// @param outcome of a beam that meets something: how far its echoes hold (without noise)
  void light(std::size_t beam, BeamTrace& trace, std::vector<Echo>& echoes, BeamReport& report,
    BeamOutcome& outcome);

  /// True if the echoes of a beam lit before are what they were: nothing was repainted that it
  /// meets, and limits and air leave them.
  bool isLit(BeamTrace& trace, const BeamOutcome& outcome) const;

  /// Of a strongest return that received so much.
  BeamStatus statusOfEcho(double energyReceived) const;

private:
  struct Sampler; // strata and error estimator for one number of rays
  /// A beam of the block.
  struct Slot
  {
    BeamFrame frame;
    BeamRays rays;
    std::uint32_t raysDrawn = 0;
    RandomPurpose purpose = RandomPurpose::Rays;
    std::uint32_t raysWanted = 0;
    std::uint32_t raysMissing = 0;        ///< to be traced now
    std::vector<std::uint32_t> triangles; ///< of each ray; empty if none hit, or known from before
    TraceCounters counters;               ///< of this run
    bool framed = false;
    bool changed = false; ///< more is known of the beam than before
  };
  Sampler& samplerFor(std::uint32_t rays);
  Slot& slotOf(std::size_t beam) { return this->Slots[beam - this->First]; }
  const BeamFrame& frameOf(std::size_t beam);
  const BeamRays& raysOf(std::size_t beam, std::uint32_t rays, RandomPurpose purpose);
  void tracePilots(std::size_t begin, std::size_t end, std::vector<BeamTrace>& traces);
  void tracePrimary(std::size_t begin, std::size_t end, RandomPurpose purpose);
  std::uint32_t raysForTarget(const PrimaryHits& pilot);
  bool takeHits(std::size_t beam, BeamTrace& trace);
  bool lightHits(std::size_t beam, BeamTrace& trace, bool geometryKnown, double& lost);
  bool isRepainted(BeamTrace& trace) const;
  PathStrengths& strengthsOf(std::size_t beam, BeamTrace& trace);
  bool isFaint(double farthest, double energy) const;
  void dropFaintPaths(const PrimaryHits& hits, double& lost);
  void boundLimits(const PathStrengths& strengths, double most, double lostBefore);
  void conclude(const BeamTrace& trace, double lost);
  double surestEnergy(const PrimaryHits& hits, double nearest) const;
  Echo makeEcho(const Return& ret);
  double standardError(const ReceivedUnit& unit);
  bool fillsItsUnit(const ReceivedUnit& unit) const;
  BeamStatus statusOf() const;

  const ScanSetup& Setup;
  const ScanBeams& Beams;
  const ShadingChange& Shades;
  const LimitsAndAir Now;
  std::function<bool()> Wanted;
  BeamTracer Tracer;
  HitFinder Finder;
  HitGeometry Geometry;
  DirectLight Light;
  SecondaryReflection Secondary;
  RangeUnitAccumulator Units;
  BeamReceiver Receiver;
  EchoLabels Labels;
  std::map<std::uint32_t, std::unique_ptr<Sampler>> Samplers;
  std::size_t First = 0; ///< beam of the block
  std::vector<Slot> Slots;

  // The beam being lit.
  Sampler* Current = nullptr;
  const PrimaryHits* Lit = nullptr; ///< null without hits
  std::vector<SecondaryPath> Paths;
  BeamOutcome Outcome;

  // The beams being traced, and what is needed of them.
  std::vector<BeamFrame> Frames;
  std::vector<std::uint32_t> Missing;
  std::vector<std::size_t> Traced;
};
}

#endif
