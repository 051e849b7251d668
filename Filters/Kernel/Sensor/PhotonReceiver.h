// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PhotonReceiver.h
 * @brief Photoelectrons in a photon receiver, their noise, and the limits that follow from the
 * noise.
 *
 * An energy Q at the aperture makes n = eta Q/(h nu) electrons in a range unit. Daylight adds n_b =
 * eta L dlambda Omega A tau_s/(h nu) electrons, with the radiance L, the filter bandwidth dlambda,
 * the solid angle Omega of the beam and the aperture A. The receiver removes the mean n_b (AC
 * coupling), but not the noise of the background. The electrons of a unit are normally distributed
 * with the variance F (n + n_b) + n_a^2, with the excess noise factor F and the amplifier noise
 * n_a. The variance is sigma0^2 if n is 0. A unit is perceived above n_T = k sigma0 electrons. The
 * factor k gives a scan of empty sky the allowed number of false alarms. So a scan has one lower
 * limit in joules, n_T h nu/eta, and one upper limit, which exceeds the lower limit by the dynamic
 * range.
 *
 * Source: Gaussian noise of a direct-detection receiver with an avalanche photodiode, e.g.
 * R. D. Richmond and S. C. Cain, Direct-Detection LADAR Systems, SPIE, 2010.
 * Differs: the paper gives limits in joules and Poisson noise (BeamReceiver.h, BeamNoise.h).
 * Valid: Gaussian noise is right for many electrons. Noise of single electrons is skewed. If the
 * number of detected photons is Poisson distributed with the mean n_b/F, and each photon makes F
 * electrons, the skewness is g = F^2 n_b/sigma0^3. No avalanche with the excess noise factor F has
 * a smaller skewness. A gamma distribution with the same three moments exceeds n_T with the
 * probability Q(a, a + k sqrt(a)), with a = 4/g^2 and the regularised upper incomplete gamma
 * function Q. So with the presets false alarms are 1.04 to 1.7 times as many as allowed. With 3.5
 * background electrons and no amplifier noise they are about 1,500 times as many. If false alarms
 * are at least ten times as many as allowed, warningOnElectrons() returns a warning. The computed
 * ratio of false alarms lies within 2 % of the exact sum for the presets. The ratio is wrong by a
 * factor of up to 2 for a few electrons, and of up to 5 if F is above 1 and no amplifier noise
 * smooths the steps of F electrons.
 * Test: TestPhotonReceiver.cxx.
 */
#ifndef avianlidar_PhotonReceiver_h
#define avianlidar_PhotonReceiver_h

#include "Sensor.h"

#include <cmath>
#include <string>

namespace avianlidar
{
/// Electrons and noise of a sensor's photon receiver.
struct PhotonReceiver
{
  explicit PhotonReceiver(const Sensor& sensor);

  double electronsPerJoule; ///< eta/(h nu), electrons per joule at the aperture
  double background;        ///< n_b, mean number of background electrons in a range unit
  double darkVariance;      ///< sigma0^2, variance of a unit's electrons without signal
  double excess;            ///< F, excess noise factor

  /// Standard deviation of the number of electrons in a unit. @param electrons mean number n of
  /// signal electrons
  double deviation(double electrons) const;

  /// Ratio of the mean number n of signal electrons to its standard deviation.
  double signalToNoise(double electrons) const;

  /// Probability that a unit is perceived. The mean number of electrons from air is subtracted, but
  /// the noise of these electrons remains. @param electrons mean number n of signal electrons
  /// @param threshold threshold n_T, electrons @param air mean number of electrons from air
  double detectionProbability(double electrons, double threshold, double air = 0.0) const;

  /// Factor by which `air` electrons from the air raise a threshold that follows the air.
  double growthInAir(double air) const
  {
    return std::sqrt(1.0 + this->excess * air / this->darkVariance);
  }
};

/// The sensor in a beam whose background has another radiance than the sky. A brighter background
/// raises the lower limit to the same number of standard deviations of the noise, so that bright
/// walls cause no more false alarms than the sky. @param radiance radiance of the background, W/(m2
/// sr nm)
Sensor lookingAt(const Sensor& sensor, double radiance);

/// Probability that a range unit is perceived. With a photon receiver the probability follows from
/// the noise. With given limits the probability is 0 or 1. @param receiver receiver of the sensor
/// @param energy received energy, J @param air mean energy from air in the unit, J; used if the
/// threshold follows the air
double perceptionProbability(
  const Sensor& sensor, const PhotonReceiver& receiver, double energy, double air = 0.0);

/// Approximate ratio of the number of false alarms with single electrons to the number with
/// Gaussian noise, at the sensor's limit.
double falseAlarmsOfElectrons(const Sensor& sensor);

/// Returns an empty string, or a warning about a photon receiver with so few electrons that it
/// would cause at least ten times the requested number of false alarms.
std::string warningOnElectrons(const Sensor& sensor);

/// Factor k = n_T/sigma0. @param falseAlarms expected number of false alarms in a scan @param units
/// number of range units of the scan, more than twice falseAlarms
double thresholdFactor(double falseAlarms, double units);

/// Number of range units inside the gate, summed over all beams. @param beams number of beams
double rangeUnitsOf(const Sensor& sensor, double beams);

/// Returns an empty string, or a sentence that names the value and what was expected.
/// @param falseAlarms expected number of false alarms in a scan @param dynamicRange ratio of the
/// upper to the lower limit, dB
std::string checkPhotonLimits(double falseAlarms, double dynamicRange);

/// Set the limits of a sensor's photon receiver. @param falseAlarms expected number of false alarms
/// in a scan, above 0
/// @param dynamicRange ratio of the upper to the lower limit, dB (10 log10 of electrons), 0 to 1000
/// @param beams number of beams @return result of checkPhotonLimits()
std::string setPhotonLimits(Sensor& sensor, double falseAlarms, double dynamicRange, double beams);

/// Energy, J, that reaches the aperture from a Lambertian surface on the axis of the beam. Without
/// an aperture, the energy follows the paper's radiometry.
/// @param range range of the surface, m @param area silhouette weighted by the cosine of incidence,
/// m^2; infinite for a wall that fills the beam @param reflectance reflectance, 0 to 1
/// @param attenuation attenuation coefficient of the air, 1/m
double energyFromTarget(
  const Sensor& sensor, double range, double area, double reflectance, double attenuation);

/// Set limits with which, at ranges up to `range`, m, a sensor perceives a surface that fills the
/// beam.
/// @return an empty string, or a sentence that names the value and what was expected
std::string setDataSheetLimits(
  Sensor& sensor, double range, double reflectance, double attenuation, double dynamicRange);

/// Returns an empty string, or a sentence that names what a photon receiver lacks. The other values
/// of the sensor must be valid.
std::string checkPhotonReceiver(const Sensor& sensor);
}

#endif
