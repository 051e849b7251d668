// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamNoise.h
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
 *    alarm and whether its deviate is rare. With conditioning, even tails that a uniform number of
 *    53 bits does not reach are exact (Distributions.h).
 *
 * Source: paper, Sec. 2.4, Eq. 11.
 * Differs: the paper's further factor tau_s, which would give Q_n the unit J s, is left out.
 * Valid: as NoisePlan.h.
 * Test: TestNoise.cxx, TestReceiver.cxx, TestPhotonReceiver.cxx.
 */
#ifndef avianlidar_BeamNoise_h
#define avianlidar_BeamNoise_h

#include "NoisePlan.h"
#include "Random.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Key of the random numbers of a beam's noise.
struct NoiseKey
{
  std::int32_t seed = 0;
  std::uint64_t beam = 0;
  std::int32_t revolution = 0; ///< number of the revolution
};

/// A standard normal deviate for the range of the return whose strongest unit is `unit`.
double rangeDeviate(const NoiseKey& key, std::int64_t unit);

/// Place of the noise in a unit, as a share of the unit, uniform in (0, 1).
double placeOfNoise(const NoiseKey& key, std::int64_t unit);

/// Draws the noise of one beam after the other. An object is reused without allocation. Each thread
/// needs its own object.
class BeamNoise
{
public:
  /// Draw the false alarms of a beam. An inactive plan has no alarms.
  void begin(const NoisePlan& plan, const NoiseKey& key);

  /// Numbers of the range units whose noise exceeds Qlow without light, ascending.
  const std::vector<std::int64_t>& alarms() const { return this->Alarms; }

  /// True if Gaussian noise has a rare deviate in a unit that is not an alarm. Calls for
  /// neighbouring units are fast.
  bool isRare(std::int64_t unit);

  /// Noise energy of a unit, J; 0 outside the gate. @param light energy that the unit receives, J
  double energy(std::int64_t unit, double light = 0.0);

private:
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
  NoiseKey Key;
  std::vector<std::int64_t> Alarms;
  std::bitset<UnitsOfBlock> Rare; ///< bits of the rare units from RareBegin on
  std::int64_t RareBegin = -1;    ///< first unit of `Rare`; -1: no unit drawn
};
}

#endif
