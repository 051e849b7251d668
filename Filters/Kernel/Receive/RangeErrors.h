// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeErrors.h
 * @brief Errors of the range of a return: noise, walk and quantisation.
 *
 * The range has the standard deviation sqrt(a^2 + b^2/S^p), with a the floor (clock, electronics),
 * b the noise at S = 1 and p the exponent. S is a signal-to-noise ratio of the strongest range
 * unit, which received m electrons: S = (m - sigma(m))/sqrt(sigma0^2 + F m/4), at least 1, with
 * sigma(m) the standard deviation of m (PhotonReceiver.h). The denominator is the noise of the
 * pulse's flanks, which on average receive a quarter of the light of the strongest unit. One
 * deviation is subtracted because the strongest of several units is strong partly because of noise.
 * For strong light S tends to twice the ratio m/sqrt(sigma0^2 + F m). S does not grow beyond Qhigh.
 * S exists only for a photon receiver. The range of an echo of the energy Q is too long by w Qlow/Q
 * (walk), with w the walk at Qlow. Ranges outside the gate are mirrored at its ends. Finally,
 * ranges are rounded to multiples of a quantum. False alarms have the same errors as echoes.
 * Returns keep the order of their true ranges.
 *
 * Source: p = 2 is the exponent of the Cramer-Rao bound of a delay. Data sheets of makers have
 * other exponents. b = 0.649 c tau/2 holds for a pulse as long as a unit, tau. This b is the rms
 * error of the centroid of two units over all places of the pulse in a unit (TestRangeErrors.cxx
 * has the integral). The formula of the walk holds for a leading edge with a straight rise.
 * Differs: the paper's ranges are exact.
 * Valid: a value of b holds for one width of the pulse and one length of the unit. With b = 0.649 c
 * tau/2, the rms error at a ratio n/sqrt(sigma0^2 + F n) of 12 and more lies within 11 % of a Monte
 * Carlo of the waveform. At a ratio of 8, with a threshold that two in five echoes do not reach,
 * the rms error lies 19 % below the Monte Carlo. A pulse shorter than a unit adds an error of at
 * most the unit's length divided by sqrt(12). The model is not valid if two surfaces share a
 * return.
 * Test: TestRangeErrors.cxx, Testing/Python/TestRangeNoise.py (Monte Carlo of the waveform).
 */
#ifndef avianlidar_RangeErrors_h
#define avianlidar_RangeErrors_h

#include "PhotonReceiver.h"
#include "Sensor.h"

namespace avianlidar
{
/// Error of the range of a return.
struct RangeError
{
  double walk = 0.0;  ///< by the strength of the echo, m
  double noise = 0.0; ///< by chance, m

  /// Range that the receiver reports, m: within the gate, a multiple of the quantum. @param range
  /// true range, m
  double reported(double range, const Sensor& sensor) const;
};

class RangeErrors
{
public:
  /// @param noise false if only walk and quantum apply
  RangeErrors(const Sensor& sensor, bool noise);

  /// True if ranges have noise.
  bool hasNoise() const { return this->Noise; }

  /// Standard deviation of a range, m. @param energy Qrec of the strongest unit, J; an energy above
  /// the upper limit counts as the limit
  double deviation(double energy) const;

  /// Error of the range of a return. @param energy Qrec of the strongest unit, J @param normal a
  /// standard normal deviate
  RangeError of(double energy, double normal) const;

private:
  Sensor Instrument;
  PhotonReceiver Receiver;
  bool Noise = false;
};
}

#endif
