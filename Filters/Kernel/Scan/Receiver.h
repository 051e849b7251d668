// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Receiver.h
 * @brief From energies in range units to returns.
 *
 * Sums over paths (RangeUnits.h) plus noise (Noise.h) pass the dynamic range. A **return** is a
 * maximal run of consecutive perceived range units. Its range is the mean range (half the path
 * length) of its paths, weighted with the energies they put into the run. Noise alone lies anywhere
 * in its unit (BeamNoise::place()): a run of false alarms lies at the mean of these places,
 * weighted with the energies of the units.
 *
 * Where the air scatters (BeamAir.h), each unit of the beam receives of it. A threshold that
 * follows the air takes off its mean, n_air, and lies as many deviations of the noise above it as
 * without: n_T (1 + F n_air/sigma0^2)^(1/2). So every unit has the same probability of a false
 * alarm, and what is left are echoes of surfaces and what drops return beyond their mean. A fixed
 * one takes nothing off. Either way all light counts for saturation. Leaves of trees are not
 * followed: what they return is light as that of surfaces. Behind a surface there is as much less
 * of the air's light as the surface has met of the pulse.
 *
 * Source: paper, Sec. 2.4, Eq. 10-12.
 * Differs: the paper's literal reading, one point per perceived range unit at its centre, is
 * ReturnMode::RangeUnits.
 * Valid: on a plane at any tilt the range of a return lies within theta0.5^2/4, relative, of the
 * axis, while a range unit itself is c tau_s/2 long.
 * Test: TestReceiver.cxx.
 */
#ifndef avianlidar_Receiver_h
#define avianlidar_Receiver_h

#include "BeamAir.h"
#include "Drops.h"
#include "EchoSettings.h"
#include "LeafGaps.h"
#include "Noise.h"
#include "PhotonReceiver.h"
#include "RangeErrors.h"
#include "RangeUnits.h"
#include "Sensor.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace avianlidar
{
/// Dynamic range of the receiver (paper, Eq. 12): 0 for received <= lower, at most upper. lower ==
/// upper is allowed.
double perceivedEnergy(double received, double lower, double upper);

/// A range unit with its noise.
struct ReceivedUnit
{
  std::int64_t index = 0;  ///< m
  double energy = 0.0;     ///< Qrec, J, noise included
  double noise = 0.0;      ///< Qn, J
  std::uint32_t paths = 0; ///< with a share in it; 0 for a false alarm, or the air alone
  double air = 0.0;        ///< J of the energy that the air sent back
  double leaves = 0.0;     ///< J of the energy from media that no threshold follows
  int medium = -1;         ///< object of the one of these that returns most
  double lower = 0.0;      ///< limits of this unit, J
  double upper = 0.0;
};

struct Return
{
  std::size_t firstUnit = 0; ///< units [firstUnit, lastUnit) of BeamReceiver::units()
  std::size_t lastUnit = 0;
  std::size_t strongestUnit = 0; ///< one of them: the largest Qrec, ties to the nearest
  double energyReceived = 0.0;   ///< Qrec of the strongest unit (Eq. 10), J
  double energy = 0.0;           ///< Qen of the strongest unit (Eq. 12), J
  double returnEnergy = 0.0;     ///< sum of Qrec over the run, J
  bool hasLight = false;         ///< a path has a share in it, not noise or air alone
  double air = 0.0;              ///< sum over the run of what the air sent back, J
  double leaves = 0.0;           ///< the same of media that no threshold follows
  int medium = -1;               ///< object of the one of these in the unit with most of it
  double rangeOfLeaves = 0.0;    ///< m, mean of the places of their light
  double range = 0.0;            ///< m; see rangeOf()
  /// In the beam, from 1, nearest first, counted before the choice of ReturnMode.
  int returnNumber = 1;
  int numberOfReturns = 1; ///< in the beam, counted before that choice
};

/// Reusable: allocates nothing once its workspace has grown. One per thread.
class BeamReceiver
{
public:
  /// @param wanted called every 512 units for which noise is drawn, over all beams; if it returns
  /// false, WorkStopped is thrown
  /// @param air along each beam, which must outlive this; null: none
  BeamReceiver(const Sensor& sensor, const NoisePlan& noise, std::int32_t seed, ReturnMode mode,
    std::int32_t revolution = 0, std::function<bool()> wanted = {}, BeamAir* air = nullptr);

  /// Receive a beam. @param units in which light arrives, ascending @param radiance that the beam
  /// looks at, W/(m2 sr nm)
  void receive(std::uint64_t beam, const std::vector<RangeUnit>& units, double radiance);

  /// The radiance that the last beam looked at, W/(m2 sr nm).
  double radiance() const { return this->Radiance; }

  /// The range of a return, m. Return::range holds it for returns without light, and in the mode
  /// RangeUnits. @param accumulator of the beam's paths
  double rangeOf(const Return& run, RangeUnitAccumulator& accumulator) const;

  /// What the receiver says of a range of that return, m: noise, walk, quantum (RangeErrors.h). In
  /// the mode RangeUnits the range itself.
  double measured(const Return& run, double range) const;

  /// True if units without paths may be perceived: then no beam can be left out.
  bool mayAlarm() const { return this->Plan.active || (this->Air && this->Air->fillsScene()); }

  /// Units with paths or false alarms, ascending, perceived or not; without those whose light is
  /// faint and whose noise is not rare.
  const std::vector<ReceivedUnit>& units() const { return this->Units; }

  /// The returns that the mode selects, nearest first.
  const std::vector<Return>& returns() const { return this->Returns; }

  /// The strongest return of the beam, in every mode; null without a return.
  const Return* strongest() const { return this->HasReturn ? &this->Strongest : nullptr; }

private:
  void lookAt(double radiance);
  void planAir();
  double lowerIn(double air) const;
  bool isLocal() const { return this->Air && this->Air->isLocal(); }
  double varianceWith(const std::vector<BeamAir::Share>& shares) const;
  std::uint64_t drawsOf(const BeamAir::Share& share, std::int64_t unit) const;
  void drawDrops(std::int64_t unit, double* units);
  double drawAir(std::int64_t unit, ReceivedUnit& received);
  void collectUnits(const std::vector<RangeUnit>& units);
  void addUnit(std::int64_t index, double light, std::uint32_t paths, bool alarm);
  double noiseOf(std::int64_t unit, double light);
  void formReturns();
  void select();
  double rangeOfNoise(const Return& run) const;
  double openAt(std::int64_t unit) const;
  double centreOf(std::int64_t unit) const;

  Sensor Instrument; ///< before the sky
  double Radiance;
  RangeErrors Errors;
  double UnitLength;
  double Lower;
  double Upper;
  NoisePlan Plan;
  BeamAir* Air;
  bool FollowsAir;
  PhotonReceiver Photons;
  std::uint64_t Beam = 0;
  LeafGaps Gaps; ///< gaps between leaves along a narrow beam
  PulseShares Pulse;
  SharedDrops Drops; ///< drops that share their pulses
  std::int32_t Seed;
  std::int32_t Revolution;
  ReturnMode Mode;
  std::function<bool()> Wanted;
  std::uint64_t Drawn = 0; ///< units for which noise was drawn
  BeamNoise Noise;
  std::vector<ReceivedUnit> Units;
  std::vector<Return> Returns;
  Return Strongest;
  bool HasReturn = false;
};
}

#endif
