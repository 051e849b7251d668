// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Noise.h
 * @brief Noise of the receiver in every range unit: a Poisson number of photons, or the Gaussian
 * noise of a photon receiver.
 *
 * Q_n[m] = b[m] h nu with b[m] ~ Poisson(b tau_s), independent over range units m inside the gate;
 * with a photon receiver Q_n[m] = z[m] sqrt(sigma0^2 + F n) h nu/eta with z[m] ~ N(0, 1), n the
 * electrons of the unit (PhotonReceiver.h). b[m] and z[m] are pure functions of (seed, beam, m,
 * revolution), whether or not the unit holds an echo, and so is the place in its unit where noise
 * alone lies, which is uniform. For b[m] and z[m]:
 *
 * 1. The units whose noise alone exceeds Qlow (false alarms) are drawn by geometric gaps. That
 *    costs as many draws as there are alarms, not one for each of the thousands of empty units.
 * 2. Gaussian: of the others, so are those with a rare deviate, the largest 0.14 %. Most units of
 *    grazing beams get so little light that nothing else makes them perceived.
 * 3. Given that, b[m] or z[m] comes from the inverse of its distribution conditioned on exceeding
 *    Qlow or not, rare or not. Tails are those of the incomplete gamma and error functions;
 * conditioning keeps them exact where a plain 53-bit uniform would end.
 *
 * Source: paper, Sec. 2.4, Eq. 11.
 * Differs: the paper's further factor tau_s would give Q_n the unit J s; it is left out. Noise
 * that cannot change anything is left out, and the bound that proves it is reported.
 * Valid: b tau_s <= MaximumMeanPhotons. Tails agree with reference values to 1e-11, relative.
 * Test: TestNoise.cxx, TestReceiver.cxx, TestPhotonReceiver.cxx.
 */
#ifndef avianlidar_Noise_h
#define avianlidar_Noise_h

#include "Random.h"
#include "Sensor.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Mean, alarms and bound of a sensor's noise: a function of the sensor alone, so that pieces of a
/// scan agree on it.
struct NoisePlan
{
  bool active = false;       ///< false: no noise, or none that matters
  bool ofRanges = false;     ///< ranges have theirs (RangeErrors.h)
  double meanPhotons = 0.0;  ///< b tau_s, in one unit
  double photonEnergy = 0.0; ///< J
  std::int64_t gateUnits = 0;
  std::int64_t firstUnit = 0; ///< unit in which the gate begins
  /// K, the largest number of photons that alone is not perceived: K h nu <= Qlow < (K+1) h nu.
  double alarmPhotons = 0.0;
  bool gaussian = false; ///< true for a photon receiver; otherwise photons are counted
  /// Variance of Gaussian noise where no light arrives, J^2, and what it grows by with the energy
  /// that does, J.
  double darkVariance = 0.0;
  double varianceOfEnergy = 0.0;
  /// Gaussian: light below this, J, is perceived with a rare deviate alone (BeamNoise::isRare()).
  double faintLight = 0.0;
  double alarmProbability = 0.0;   ///< that the noise of an empty unit exceeds Qlow
  double quietProbability = 1.0;   ///< that it does not
  double falseAlarmsPerBeam = 0.0; ///< expected
  /// J: the probability that any of 1e15 units (more than a scan has) receives more noise than this
  /// is below 1e-30.
  double bound = 0.0;
};

/// Energies below this share of Qlow change nothing: noise bounded by it is skipped.
constexpr double NegligibleNoiseShare = 1e-9;
/// Deviates of Gaussian noise above this are rare (BeamNoise::isRare()).
constexpr double CommonDeviate = 3.0;
constexpr double MaximumMeanPhotons = 1e12;
constexpr double MaximumFalseAlarmsPerBeam = 1e6;
constexpr double MaximumFalseAlarmsPerScan = 1e8;

/// @param enabled the switch `Noise`; false gives an inactive plan with bound 0 @param inFull noise
/// that cannot matter is modelled, too
NoisePlan planNoise(const Sensor& sensor, bool enabled, bool inFull = false);

/// Empty if a scan of `beams` beams can be made; otherwise a sentence naming the value and what was
/// expected.
std::string checkNoise(const NoisePlan& plan, std::uint64_t beams);

/// Light that just reaches a limit with a deviate of CommonDeviate, J: x with x + CommonDeviate
/// (dark + perEnergy x)^(1/2) = limit. -Infinity if the noise of no light may. @param dark variance
/// without light, J^2
/// @param perEnergy what it grows by, J
double leastLight(double limit, double dark, double perEnergy);

/// Noise of one beam. Reusable without allocation; one per thread.
class BeamNoise
{
public:
  /// Draw the false alarms of a beam. Nothing to do for an inactive plan.
  /// @param revolution of the sensor, any int: each has noise of its own
  void begin(
    const NoisePlan& plan, std::int32_t seed, std::uint64_t beam, std::int32_t revolution = 0);

  /// Range units of the beam whose noise alone exceeds Qlow, ascending.
  const std::vector<std::int64_t>& alarms() const { return this->Alarms; }

  /// Gaussian: true if a unit that is no alarm has a rare deviate. Fast for neighbouring units.
  bool isRare(std::int64_t unit);

  /// Noise energy of a unit, J; 0 outside the gate. @param light what the unit receives, J
  double energy(std::int64_t unit, double light = 0.0);

  /// A standard normal deviate for the range of a return, by its strongest unit.
  double rangeDeviate(std::int64_t unit) const;

  /// Where in a unit its noise arrives, as a share of the unit: uniform in (0, 1).
  double place(std::int64_t unit) const;

private:
  std::array<double, 2> draw(std::int64_t unit, RandomPurpose purpose) const;

  /// Units for which rare deviates are drawn together.
  static constexpr std::int64_t UnitsOfBlock = 4096;

  template <class F>
  void forEachInGaps(
    double logOthers, std::int64_t begin, std::int64_t end, RandomPurpose purpose, F f) const;
  double photons(double u, bool alarm) const;
  bool isAlarm(std::int64_t unit) const
  {
    return std::binary_search(this->Alarms.begin(), this->Alarms.end(), unit);
  }

  NoisePlan Plan;
  std::int32_t Seed = 0;
  std::uint64_t Beam = 0;
  std::int32_t Revolution = 0;
  std::vector<std::int64_t> Alarms;
  std::bitset<UnitsOfBlock> Rare; ///< rare units from RareBegin on
  std::int64_t RareBegin = -1;    ///< none drawn
};

/// P(X > x) for X of a gamma distribution of that shape and of scale 1. @param shape above 0
double gammaTail(double shape, double x);

/// P(X <= count) and P(X > count) for X ~ Poisson(mean), each to full relative precision.
double poissonCdf(double mean, double count);
double poissonTail(double mean, double count);

/// Smallest count with P(X <= count) >= p, where q = 1 - p is given too: whichever is smaller
/// decides, so both tails are exact. Monotone in p. @param mean in [0, 1e12] @param p, q in [0, 1];
/// p = 1 with q = 0 is infinity
double poissonQuantile(double mean, double p, double q);
}

#endif
