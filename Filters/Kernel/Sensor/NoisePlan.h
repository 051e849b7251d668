// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file NoisePlan.h
 * @brief What a sensor's noise has in common in all range units: mean, alarms and bound.
 *
 * Source: paper, Sec. 2.4, Eq. 11.
 * Differs: noise that cannot change any result is left out. The bound of this noise is reported.
 * Valid: b tau_s <= MaximumMeanPhotons.
 * Test: TestNoise.cxx, TestPhotonReceiver.cxx.
 */
#ifndef avianlidar_NoisePlan_h
#define avianlidar_NoisePlan_h

#include "Sensor.h"

#include <cstdint>
#include <string>

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
}

#endif
