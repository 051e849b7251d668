// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PointingErrors.h
 * @brief Mast sway and encoder jitter: deviations of beams from the directions that the sensor
 * reports.
 *
 * Sway. The mast tilts about the east and the north axis. Each tilt is a narrow-band random motion,
 * the sum of SwayTones sinusoids of equal amplitude,
 *
 *     tilt(t) = a sqrt(2/SwayTones) sum cos(2 pi (f_k t + p_k)).
 *
 * One frequency f_k is drawn in each of SwayTones equal parts of the band (1 +- SwayBandwidth)
 * SwayFrequency. The phases p_k are uniformly distributed. The tilt about each axis has the rms a
 * and never exceeds sqrt(2 SwayTones) a. The tilt is a function of (seed, axis, t), so tilts can be
 * computed for any times in any order.
 *
 * Jitter. All channels of a column share one error of the azimuth, a normal deviate that is a
 * function of (seed, column, revolution).
 *
 * The sensor tilts about its own position. On a mast of height h the sensor would also move by h
 * times the tilt. This motion is not modelled.
 *
 * Source: Rice's sum of sinusoids with random phases (Bell Syst. Tech. J. 23, 1944); Box and
 * Muller's normal deviates.
 * Differs: the shape of the spectrum is assumed.
 * Valid: amplitudes of 0 to 10 deg, frequencies of 1e-6 to 1e6 Hz. Rotations are exact, not linear
 * in the angles. The phase is rounded to 1e-16 f t turns.
 * Test: TestPointingErrors.cxx.
 */
#ifndef avianlidar_PointingErrors_h
#define avianlidar_PointingErrors_h

#include "Vector.h"

#include <array>
#include <cstdint>
#include <string>

namespace avianlidar
{
constexpr int SwayTones = 16;
constexpr double SwayBandwidth = 0.2; // half width of the band, as a share of SwayFrequency

struct PointingErrors
{
  double swayAmplitude = 0.0; ///< a, rms tilt about each horizontal axis, deg; 0: no sway
  double swayFrequency = 0.5; ///< middle frequency of the sway, Hz
  double encoderJitter = 0.0; ///< rms error of a column's azimuth, deg; 0: no jitter
  std::int32_t seed = 0;

  bool none() const { return this->swayAmplitude == 0.0 && this->encoderJitter == 0.0; }
};

/// The first bad value in words ("SwayAmplitude is -1, expected ..."), or an empty string.
std::string checkPointing(const PointingErrors& errors);

/// Gives the directions in which beams leave the sensor. Calls do not depend on each other.
class Pointing
{
public:
  /// @param errors valid errors (checkPointing()) @param rotor upward unit vector of the axis about
  /// which the sensor turns
  Pointing(const PointingErrors& errors, const Vec3& rotor);

  /// Tilt about the east and the north axis (right-handed), rad. @param time time, s
  std::array<double, 2> tilt(double time) const;

  /// Error of the azimuth of a column, rad, clockwise seen from above.
  double azimuthError(std::int64_t column, std::int32_t revolution) const;

  /// Direction in which a beam leaves the sensor. @param reported direction without errors, unit
  /// vector
  /// @param time time of the firing, s
  Vec3 direction(
    const Vec3& reported, std::int64_t column, std::int32_t revolution, double time) const;

private:
  struct Tone
  {
    double frequency; ///< frequency of the sinusoid, Hz
    double phase;     ///< phase of the sinusoid, turns
  };
  PointingErrors Errors;
  Vec3 Rotor;
  std::array<std::array<Tone, SwayTones>, 2> Tones;
};
}

#endif
