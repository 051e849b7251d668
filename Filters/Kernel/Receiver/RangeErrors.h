// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file RangeErrors.h
 * @brief What a receiver makes of the range of a return: noise, walk and quantisation.
 *
 * The range has a standard deviation of sqrt(a^2 + b^2/S^p), a the floor (clock, electronics), b
 * that of a ratio of 1 and p the exponent. S is a signal-to-noise ratio of what the strongest range
 * unit received, m electrons: S = (m - sigma(m))/sqrt(sigma0^2 + F m/4), at least 1. Its noise is
 * that of the pulse's flanks, which get a quarter of the light that the strongest unit gets, on
 * average; one deviation less, as the strongest of some units is strong by its noise, too. S tends
 * to twice the ratio m/sqrt(sigma0^2 + F m) of strong light and grows no more beyond Qhigh. Only a
 * photon receiver has S. Echoes that exceed the limit by little come late by w Qlow/Q (walk), w the
 * walk at the limit. Ranges before or beyond the gate are folded back. Last, ranges are rounded to
 * multiples of a quantum. False alarms have the same errors as echoes. Returns stay in the order of
 * their true ranges.
 *
 * Source: p = 2 is the Cramer-Rao bound of a delay; makers' sheets fit others. b = 0.649
 * c tau/2 is calculated: rms over all places in a unit of the centroid of two units, of a pulse of
 * one unit tau (TestRangeErrors.cxx has the integral). Walk of a leading edge: its rise is
 * straight.
 * Differs: the paper's ranges are exact.
 * Valid: b belongs to a pulse and a unit: another pulse needs another. With that b, the rms of
 * echoes of a pulse of n/sqrt(sigma0^2 + F n) = 12 and more lies within 11 % of a Monte Carlo of
 * the waveform; at 8 and a threshold that two in five do not reach, 19 % below it. A pulse shorter
 * than a unit has, beside this, the unit's length over sqrt(12) at most. Not where two surfaces
 * share a return.
 * Test: TestRangeErrors.cxx, Testing/Python/TestRangeNoise.py (Monte Carlo of the waveform).
 */
#ifndef avianlidar_RangeErrors_h
#define avianlidar_RangeErrors_h

#include "PhotonReceiver.h"
#include "Sensor.h"

namespace avianlidar
{
class RangeErrors
{
public:
  /// @param noise false: walk and quantum alone
  RangeErrors(const Sensor& sensor, bool noise);

  /// True if ranges have noise.
  bool hasNoise() const { return this->Noise; }

  /// Standard deviation of a range, m. @param energy Qrec of the strongest unit, J; what exceeds
  /// the upper limit counts as the limit
  double deviation(double energy) const;

  /// The range that the receiver says, m, within the gate. @param range true one @param energy as
  /// above
  /// @param normal a standard normal deviate
  double measured(double range, double energy, double normal) const;

private:
  Sensor Instrument;
  PhotonReceiver Receiver;
  bool Noise = false;
};
}

#endif
