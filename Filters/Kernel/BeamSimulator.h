// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamSimulator.h
 * @brief Echoes of one beam after the other (paper, Algorithm 2): rays, hits, energies, range
 * units, returns.
 *
 * Steps of a beam: draw the rays; find their hits (or take those known from before); direct echo of
 * every hit (paper, Eq. 4-9); paths over two reflections; the light-energy constraint; sums in
 * range units, noise, dynamic range (Eq. 10-12); returns with their labels and standard errors.
 *
 * Light-energy constraint: a path is dropped when an upper bound of its energy is below epsilon
 * Qlow / (paths of the beam), epsilon = 1e-3, and all secondary paths of a beam are skipped when
 * their bounds, with those already dropped, sum to less than epsilon Qlow. No range unit so loses
 * more than epsilon Qlow.
 */
#ifndef avianlidar_BeamSimulator_h
#define avianlidar_BeamSimulator_h

#include "BeamTrace.h"
#include "ScanSetup.h"
#include "SecondaryReflection.h"
#include "StandardError.h"

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace avianlidar
{
/// One return of one beam.
struct Echo
{
  double range = 0.0;          ///< m along the axis
  double energyReceived = 0.0; ///< J, Qrec of the strongest unit (Eq. 10)
  double energy = 0.0;         ///< J, Qen of the strongest unit (Eq. 12)
  double returnEnergy = 0.0;   ///< J, sum of Qrec over the return
  double energyStdError = 0.0; ///< J, of energyReceived; NaN for N = 1
  int returnNumber = 1;
  int numberOfReturns = 1;
  int objectId = -1; ///< of the largest share of the paths' energy; -1 for a false alarm
  int materialId = -1;
  double labelShare = 0.0; ///< that share
  double incidenceAngle =
    0.0; ///< rad, energy-weighted mean at the last surface; NaN for a false alarm
  double secondaryShare = 0.0; ///< share of the energy that came over two reflections
};

enum class BeamStatus
{
  Echo = 0,
  NoSurface = 1,
  BelowLimit = 2,
  Saturated = 3,
  OutsideGate = 4
};

struct BeamReport
{
  BeamStatus status = BeamStatus::NoSurface;
  double range = 0.0;              ///< m, of the strongest return; NaN without one
  TraceCounters counters;          ///< of all tracing that the beam's geometry has cost
  std::uint64_t raysTracedNow = 0; ///< in this run: 0 when everything was known
  double lost = 0.0; ///< J, sum of the bounds of paths that the light-energy constraint dropped
};

/// One per thread. The setup must outlive it and stay as it is.
class BeamSimulator
{
public:
  /// @param wanted asked now and then within a beam of very many rays; false ends it with
  /// WorkStopped
  explicit BeamSimulator(const ScanSetup& setup, std::function<bool()> wanted = {});
  ~BeamSimulator();

  /// Simulate beam `id`. `trace` is what is known of the beam's geometry; it is added to. Echoes
  /// are appended.
  void simulate(std::uint64_t id, const Vec3& origin, const Vec3& direction, BeamTrace& trace,
    std::vector<Echo>& echoes, BeamReport& report);

private:
  struct Sampler; // strata and error estimator for one number of rays
  Sampler& samplerFor(std::uint32_t rays);
  std::uint32_t raysFor(std::uint64_t id, const BeamFrame& frame, BeamTrace& trace);
  std::uint32_t raysForTarget(const std::vector<RayHit>& pilot) const;
  void drawRays(std::uint64_t id, std::uint32_t rays, RandomPurpose purpose);
  void tracePrimary(std::uint64_t id, BeamTrace& trace, std::uint32_t rays);
  void lightRays(const BeamFrame& frame, const std::vector<std::uint32_t>& triangles,
    std::vector<RayHit>& hits) const;
  void addDirectPaths(double& lost);
  void addSecondaryPaths(std::uint64_t id, const BeamFrame& frame, BeamTrace& trace, double& lost);
  Echo makeEcho(const Return& ret) const;
  void label(const Return& ret, Echo& echo) const;
  double standardError(const Return& ret) const;
  bool fillsItsUnit(const ReceivedUnit& unit) const;
  BeamStatus statusOf(bool anyHit) const;

  const ScanSetup& Setup;
  std::function<bool()> Wanted;
  BeamTracer Tracer;
  SecondaryReflection Secondary;
  RangeUnitAccumulator Units;
  BeamReceiver Receiver;
  std::map<std::uint32_t, std::unique_ptr<Sampler>> Samplers;
  Sampler* Current = nullptr;
  BeamRays Rays;
  std::vector<Hit> Hits;
  std::vector<RayHit> Lit;
  std::vector<SecondaryPath> Paths;
};
}

#endif
