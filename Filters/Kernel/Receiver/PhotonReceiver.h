// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PhotonReceiver.h
 * @brief What a receiver of photons can see: electrons, their noise, and the limits that follow.
 *
 * An energy Q at the aperture makes n = eta Q/(h nu) electrons in a range unit. Daylight makes n_b
 * = eta L dlambda Omega A tau_s/(h nu) more, Omega the solid angle of the beam; their mean is
 * removed (AC coupling), their noise stays. The electrons of a unit have the variance F (n + n_b) +
 * n_a^2, sigma0^2 where n is 0, and are Gaussian. A unit is perceived above n_T = k sigma0, k such
 * that a scan of empty sky has as many false alarms as are allowed. So a scan has one lower limit
 * in joules, n_T h nu/eta, and one upper limit, by the dynamic range above it; all that knows
 * limits stays as it is.
 *
 * Source: Gaussian noise of a direct-detection receiver with an avalanche photodiode, e.g.
 * R. D. Richmond and S. C. Cain, Direct-Detection LADAR Systems, SPIE, 2010.
 * Differs: the paper gives limits in joules and Poisson noise (Receiver.h, Noise.h).
 * Valid: Gaussian noise is right for many electrons. Electrons come singly, and their noise is
 * skewed: with counted electrons and an avalanche of the excess F, a Poisson number of mean n_b/F
 * of which each makes F, the skewness is g = F^2 n_b/sigma0^3, the least that any avalanche of that
 * excess has. Noise of the same three moments, gamma distributed, exceeds n_T with probability
 * Q(a, a + k sqrt(a)), a = 4/g^2. So false alarms are 1.04 to 1.7 times those allowed with the
 * presets, some 1,500 times with 3.5 electrons alone. From 10 times on warningOnElectrons() says
 * so. The factor lies within 2 % of the exact sum for the presets, within 2 times of it for a few
 * electrons, or 5 times where F is above 1 and no amplifier smooths the steps of F electrons.
 * Test: TestPhotonReceiver.cxx.
 */
#ifndef avianlidar_PhotonReceiver_h
#define avianlidar_PhotonReceiver_h

#include "Sensor.h"

#include <cmath>
#include <string>

namespace avianlidar
{
/// What a sensor's photon receiver makes of light.
struct PhotonReceiver
{
  explicit PhotonReceiver(const Sensor& sensor);

  double electronsPerJoule; ///< eta/(h nu)
  double background;        ///< n_b, electrons in a range unit, on average
  double darkVariance;      ///< sigma0^2
  double excess;            ///< F

  /// Standard deviation of the electrons of a unit that gets n on average.
  double deviation(double electrons) const;

  /// n over its standard deviation.
  double signalToNoise(double electrons) const;

  /// Probability that a unit that gets n electrons on average is perceived. @param threshold n_T
  /// @param air electrons of air, whose mean is taken off and whose noise stays
  double detectionProbability(double electrons, double threshold, double air = 0.0) const;

  /// By how much a threshold that follows the air grows where the air makes so many electrons.
  double growthInAir(double air) const
  {
    return std::sqrt(1.0 + this->excess * air / this->darkVariance);
  }
};

/// The sensor in a beam that looks at another radiance than its sky's: background, and where that
/// is brighter the lower limit, which stays at the same number of standard deviations of the noise,
/// so that bright walls raise no more false alarms than the sky. @param radiance W/(m2 sr nm)
Sensor lookingAt(const Sensor& sensor, double radiance);

/// Probability that a range unit that receives so much light is perceived: by the noise of a photon
/// receiver, else 0 or 1 by the limit. @param receiver of the sensor @param energy J @param air
/// mean of what the air sends back there, J: it matters where the threshold follows it
double perceptionProbability(
  const Sensor& sensor, const PhotonReceiver& receiver, double energy, double air = 0.0);

/// How many times the false alarms of Gaussian noise single electrons would raise above the
/// sensor's limit, about.
double falseAlarmsOfElectrons(const Sensor& sensor);

/// Empty, or a sentence on a photon receiver of so few electrons that ten times as many false
/// alarms would be raised as were asked for.
std::string warningOnElectrons(const Sensor& sensor);

/// k = n_T/sigma0. @param falseAlarms expected in a scan @param units range units of the scan;
/// more than twice the false alarms
double thresholdFactor(double falseAlarms, double units);

/// Range units inside the gate of so many beams.
double rangeUnitsOf(const Sensor& sensor, double beams);

/// Empty, or a sentence that names the value and what was expected. @param falseAlarms expected in
/// a scan @param dynamicRange dB
std::string checkPhotonLimits(double falseAlarms, double dynamicRange);

/// Set the limits of a sensor's photon receiver. @param falseAlarms expected in a scan, above 0
/// @param dynamicRange from the lower to the upper limit, dB (10 log10 of electrons), 0 to 1000
/// @param beams of the scan. Empty, or a sentence that names the value and what was expected.
std::string setPhotonLimits(Sensor& sensor, double falseAlarms, double dynamicRange, double beams);

/// Energy, J, that comes to the aperture from a Lambertian surface on the axis of the beam; without
/// an aperture, what the paper's radiometry gives.
/// @param range m @param area silhouette weighted by the cosine of incidence, m^2; infinite for a
/// wall that fills the beam @param reflectance 0 to 1 @param attenuation 1/m
double energyFromTarget(
  const Sensor& sensor, double range, double area, double reflectance, double attenuation);

/// Set the limits of a sensor that sees a surface which fills the beam until `range`, m. Empty, or
/// a sentence as above.
std::string setDataSheetLimits(
  Sensor& sensor, double range, double reflectance, double attenuation, double dynamicRange);

/// Error of a sensor with a photon receiver whose other values are right: what the receiver lacks.
std::string checkPhotonReceiver(const Sensor& sensor);
}

#endif
