// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Noise.h
 * @brief Noise of the receiver in every range unit: a Poisson number of photons, or the Gaussian
 * noise of a photon receiver.
 *
 * The noise of range unit m is Q_n[m] = b[m] h nu with b[m] ~ Poisson(b tau_s), independent for all
 * units inside the gate, and h nu the energy of a photon. With a photon receiver the noise is
 * Q_n[m] = z[m] sqrt(sigma0^2 + F n) h nu/eta with z[m] ~ N(0, 1) and n the electrons of the unit
 * (PhotonReceiver.h). b[m] and z[m] are pure functions of (seed, beam, m, revolution), whether or
 * not the unit holds an echo. The uniformly distributed place of a false alarm in its unit is also
 * a pure function of these values. b[m] and z[m] are drawn in steps:
 *
 * 1. Units whose noise exceeds Qlow without light (false alarms) are drawn by the geometrically
 *    distributed gaps between them. This method costs one draw per alarm, and not one draw for each
 *    of the thousands of empty units.
 * 2. With Gaussian noise, the other units with a rare deviate (the largest 0.14 % of all deviates)
 *    are drawn in the same way. In most units of grazing beams the light is so weak that the unit
 *    is perceived only with a rare deviate.
 * 3. b[m] or z[m] comes from the inverse of its distribution, conditioned on whether the unit is an
 *    alarm and whether its deviate is rare. Tails are computed from the incomplete gamma function
 *    and the error function. With conditioning, even tails that a uniform number of 53 bits does
 *    not reach are exact.
 *
 * Source: paper, Sec. 2.4, Eq. 11.
 * Differs: the paper's further factor tau_s, which would give Q_n the unit J s, is left out. Noise
 * that cannot change any result is left out, too. The bound of this noise is reported.
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
/// Mean, alarms and bound of a sensor's noise, which depend only on the sensor and are the same for
/// all pieces of a scan.
struct NoisePlan
{
  bool enabled = false;      ///< the switch `Noise`; true if light of drops and leaves is drawn
  bool active = false;       ///< true if noise is drawn; false if noise is off or cannot matter
  bool ofRanges = false;     ///< true if ranges have noise (RangeErrors.h)
  double meanPhotons = 0.0;  ///< b tau_s, mean number of photons in a unit
  double photonEnergy = 0.0; ///< energy of a photon, J
  std::int64_t gateUnits = 0;
  std::int64_t firstUnit = 0; ///< unit in which the gate begins
  /// K, the largest number of photons that is not perceived without an echo: K h nu <= Qlow < (K+1)
  /// h nu.
  double alarmPhotons = 0.0;
  bool gaussian = false; ///< true for a photon receiver; otherwise photons are counted
  /// Variance of Gaussian noise without light, J^2, and its increase per joule of light, J.
  double darkVariance = 0.0;
  double varianceOfEnergy = 0.0;
  /// Energy, J, below which light is perceived only with a rare deviate (BeamNoise::isRare()).
  double faintLight = 0.0;
  double alarmProbability = 0.0;   ///< probability that the noise of an empty unit exceeds Qlow
  double quietProbability = 1.0;   ///< probability that an empty unit's noise is at most Qlow
  double falseAlarmsPerBeam = 0.0; ///< expected number of false alarms in a beam
  /// Bound of the noise, J. The probability that any of 1e15 units (more than a scan has) receives
  /// more noise is below 1e-30.
  double bound = 0.0;
};

/// Share of Qlow below which energies change nothing. Noise with a smaller bound is skipped.
constexpr double NegligibleNoiseShare = 1e-9;
/// Largest common deviate of Gaussian noise. Larger deviates are rare (BeamNoise::isRare()).
constexpr double CommonDeviate = 3.0;
constexpr double MaximumMeanPhotons = 1e12;
constexpr double MaximumFalseAlarmsPerBeam = 1e6;
constexpr double MaximumFalseAlarmsPerScan = 1e8;

/// @param enabled the switch `Noise`; false: an inactive plan with the bound 0 @param inFull true
/// if noise that cannot matter is modelled, too
NoisePlan planNoise(const Sensor& sensor, bool enabled, bool inFull = false);

/// Returns an empty string if a scan of `beams` beams can be made, otherwise a sentence that names
/// the value and what was expected.
std::string checkNoise(const NoisePlan& plan, std::uint64_t beams);

/// Energy, J, that just reaches a limit with a deviate of CommonDeviate: x with x + CommonDeviate
/// (dark + perEnergy x)^(1/2) = limit. The result is minus infinity if noise without light may
/// reach the limit.
/// @param dark variance without light, J^2
/// @param perEnergy increase of the variance per joule of light, J
double leastLight(double limit, double dark, double perEnergy);

/// Draws the noise of one beam after the other. An object is reused without allocation. Each thread
/// needs its own object.
class BeamNoise
{
public:
  /// Draw the false alarms of a beam. An inactive plan has no alarms.
  /// @param revolution number of the revolution, any int, on which the noise depends
  void begin(
    const NoisePlan& plan, std::int32_t seed, std::uint64_t beam, std::int32_t revolution = 0);

  /// Numbers of the range units whose noise exceeds Qlow without light, ascending.
  const std::vector<std::int64_t>& alarms() const { return this->Alarms; }

  /// True if Gaussian noise has a rare deviate in a unit that is not an alarm. Calls for
  /// neighbouring units are fast.
  bool isRare(std::int64_t unit);

  /// Noise energy of a unit, J; 0 outside the gate. @param light energy that the unit receives, J
  double energy(std::int64_t unit, double light = 0.0);

  /// A standard normal deviate for the range of the return whose strongest unit is `unit`.
  double rangeDeviate(std::int64_t unit) const;

  /// Place of the noise in a unit, as a share of the unit, uniform in (0, 1).
  double place(std::int64_t unit) const;

private:
  std::array<double, 2> draw(std::int64_t unit, RandomPurpose purpose) const;

  /// Number of units for which rare deviates are drawn together.
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
  std::bitset<UnitsOfBlock> Rare; ///< bits of the rare units from RareBegin on
  std::int64_t RareBegin = -1;    ///< first unit of `Rare`; -1: no unit drawn
};

/// P(X > x) for X of a gamma distribution with the scale 1. @param shape shape parameter, above 0
double gammaTail(double shape, double x);

/// P(X <= count) and P(X > count) for X ~ Poisson(mean), each to full relative precision.
double poissonCdf(double mean, double count);
double poissonTail(double mean, double count);

/// Smallest count with P(X <= count) >= p, infinity for p = 1. The caller also gives q = 1 - p. The
/// smaller of p and q is used, so both tails are exact. The count is monotone in p. @param mean
/// mean of the distribution, in [0, 1e12] @param p, q probabilities in [0, 1]
double poissonQuantile(double mean, double p, double q);
}

#endif
