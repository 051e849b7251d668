// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Sensor.h
 * @brief Instrument values on which an echo depends, and their check.
 *
 * Source: paper, Table 2; defaults of Sec. 5.3.
 * Differs: the Gaussian profile, beams that are not round, the receiver's aperture and the photon
 * receiver are added. Their defaults (uniform, round, 0 and given limits) are the values of the
 * paper.
 * Valid: the ranges of sensorFields(), far beyond any instrument.
 * Test: TestScanReport.cxx, TestStabilitySweep.cxx (bad values are named).
 */
#ifndef avianlidar_Sensor_h
#define avianlidar_Sensor_h

#include "ReceivedPulse.h"
#include "Vector.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Distribution of the emitted energy inside the beam.
enum class BeamProfile
{
  Uniform = 0, ///< uniform in solid angle (paper, Eq. 3; other outlines: BeamShape.h)
  /// exp(-2 k^2 u), u = (1-cos theta)/(1-cos theta0.5), with theta the angle from the axis and k
  /// the truncation. The profile ends at the half-beamwidth, where it is 1/e^2 by default.
  Gaussian = 1
};

/// Outline of the beam in the plane across its axis.
enum class BeamOutline
{
  Ellipse = 0, ///< a disc if both half-beamwidths are equal
  Rectangle = 1
};

/// Model of the receiver, which turns energies into echoes.
enum class ReceiverModel
{
  EnergyLimits = 0, ///< receiver of given limits and noise photons (paper, Eq. 11 and 12)
  Photons = 1       ///< receiver whose limits follow from light and electronics (PhotonReceiver.h)
};

/// Effect of scattering air on the threshold of a photon receiver.
enum class ThresholdLaw
{
  Fixed = 0,     ///< no effect
  FollowsAir = 1 ///< threshold at the air's mean echo plus as many noise deviations as without air
};

constexpr double SpeedOfLight = 299792458.0; // m/s, exact
constexpr double PlanckConstant = 6.626e-34; // J s, the value of the paper's Table 2

// Limits of sensorFields(), all far beyond any instrument and far within the range of doubles:
// products and squares of energies and lengths neither overflow nor vanish.
constexpr double MaximumHalfBeamwidth = Pi / 3.0;    // half-beamwidth, rad (60 degrees)
constexpr double MaximumHalfBeamwidthNotRound = 0.1; // both half-beamwidths, rad
constexpr double MaximumBeamRatio = 1000.0;          // ratio of the half-beamwidths
constexpr double MaximumEnergy = 1e50;               // pulse energy and energy limits, J
constexpr double MaximumRangeGate = 1e30;            // range gate, m, as for coordinates

/// Largest number of range units inside the gate; exact in double precision.
constexpr double MaximumGateUnits = 4503599627370496.0; // 2^52

/// Levels of a digitiser. 0 J is a level, and a sixteenth of all levels lies below 0 J (assumed).
struct DigitiserLevels
{
  double step;  ///< step between two levels, J
  double below; ///< number of levels below 0 J
  double above; ///< number of levels above 0 J
};

/// The instrument. The defaults describe the paper's airport lidar (Sec. 5.3).
struct Sensor
{
  double halfBeamwidth = 5.6e-3; ///< half-beamwidth, rad, 1e-9 to pi/3
  BeamProfile beamProfile = BeamProfile::Uniform;
  double gaussianTruncation = 1.0; ///< half-beamwidth divided by 1/e^2 radius, 0.1 to 3
  BeamOutline beamOutline = BeamOutline::Ellipse;
  double halfBeamwidthAcross = 0.0;  ///< second half-beamwidth, rad, 1e-9 to 0.1; 0: halfBeamwidth
  double beamRotation = 0.0;         ///< angle of halfBeamwidth from horizontal towards `up`, deg
  Vec3 up{ 0.0, 0.0, 1.0 };          ///< up axis of the sensor, unit vector in scene coordinates
  double pulseEnergy = 3.6e-4;       ///< pulse energy Qs, J, 1e-50 to 1e50
  double pulseWidth = 5e-9;          ///< pulse width tau_e, s, >= 0 and <= 1000 tau_s
  double frequency = 3.313e14;       ///< frequency nu of the light, Hz, 1 to 1e30
  double samplingInterval = 5e-9;    ///< sampling interval tau_s, s, 1e-30 to 1e20
  double rangeGate = 4000.0;         ///< largest recorded range, m, > 0, <= 1e30
  double noisePhotonRate = 20e3;     ///< mean number of noise photons per second, 0 to 1e50
  double lowerEnergyLimit = 2e-6;    ///< lower limit Qlow, J, 0 to Qhigh
  double upperEnergyLimit = 6.25e-5; ///< upper limit Qhigh, J, Qlow to 1e50
  double receiverAperture = 0.0; ///< aperture, m^2, 0 to 1e20; 0: the paper's radiometry (no 1/r^2)

  // The photon receiver, with assumed defaults.
  ReceiverModel receiverModel = ReceiverModel::EnergyLimits;
  ThresholdLaw thresholdLaw = ThresholdLaw::FollowsAir; ///< law of the photon threshold
  double receiverEfficiency = 0.4;  ///< electrons per photon at the aperture, eta, > 0, <= 1
  double filterBandwidth = 10.0;    ///< bandwidth of the filter, nm, 0 to 1e6
  double backgroundRadiance = 0.05; ///< radiance L, W/(m^2 sr nm), 0 to 1e10
  double amplifierNoise = 60.0;     ///< noise n_a, electrons rms in a range unit, 0 to 1e20
  double excessNoiseFactor = 3.0;   ///< excess noise factor F, 1 to 1e6

  // Daylight on the surfaces in a beam (Background.h). If `sunlight` is 0, all beams have the
  // background radiance.
  double sunlight = 0.0;      ///< E, irradiance of surfaces facing the sun, W/(m^2 nm), 0 to 1e10
  double sunAzimuth = 180.0;  ///< azimuth of the sun, clockwise from north, deg
  double sunElevation = 45.0; ///< elevation of the sun, deg, -90 to 90

  // Loss of near echoes in the receiver (nearRangeShare()); 0: no loss.
  double minimumRange = 0.0; ///< least recorded range, m, 0 to rangeGate
  double overlapRange = 0.0; ///< range at which 1 - 1/e of the beam lies in the receiver's view, m
  double defocusRange = 0.0; ///< range at which half of a blurred spot is on the detector, m

  // Errors of ranges (RangeErrors.h), which the paper's receiver does not have.
  double rangeNoise = 0.0;         ///< b, standard deviation at a signal-to-noise ratio of 1, m
  double rangeNoiseExponent = 2.0; ///< exponent p, 0 to 10
  double rangeNoiseFloor = 0.0;    ///< a, standard deviation of the ranges of strong echoes, m
  double rangeWalk = 0.0;          ///< range walk at the lower limit, m
  double rangeQuantum = 0.0;       ///< step of the ranges, m; 0: ranges are not rounded

  // Shape of the pulse, and what records it (ReceivedPulse.h, BeamWaveforms.h). The defaults change
  // nothing.
  PulseShape pulseShape = PulseShape::Rectangle;
  std::vector<double> pulseSamples; ///< time, s, and power of each sample of PulseShape::Samples
  double responseTime = 0.0;        ///< full width of the receiver's response, s, 0 to 1000 tau_s
  double digitiserRate = 0.0;       ///< samples per second, Hz; 0: one sample per range unit
  double digitiserBits = 0.0;       ///< bits of a sample, 4 to 32; 0: samples are not rounded

  /// Energy of one photon, J.
  double photonEnergy() const { return PlanckConstant * this->frequency; }

  /// True if the beam is a cone.
  bool hasRoundBeam() const
  {
    return this->beamOutline == BeamOutline::Ellipse &&
      (this->halfBeamwidthAcross == 0.0 || this->halfBeamwidthAcross == this->halfBeamwidth);
  }

  /// Solid angle of the beam, sr; for an ellipse with a relative error of at most 1e-4.
  double solidAngle() const;

  /// True if the mean of the air's echo is subtracted.
  bool followsAir() const
  {
    return this->receiverModel == ReceiverModel::Photons &&
      this->thresholdLaw == ThresholdLaw::FollowsAir;
  }

  /// True if the background of a beam depends on the surfaces in the beam.
  bool seesDaylight() const
  {
    return this->receiverModel == ReceiverModel::Photons && this->sunlight > 0.0;
  }

  /// True if the receiver loses light of near echoes.
  bool losesNearRange() const { return this->overlapRange > 0.0 || this->defocusRange > 0.0; }

  /// Share of the light from a range, m, that reaches the detector: (1 - exp(-(r/r_o)^2))/(1 +
  /// (r_d/r)^2), with r_o = overlapRange and r_d = defocusRange.
  double nearRangeShare(double range) const;

  /// Number of the digitiser's samples in a range unit, a whole number.
  double samplesOfUnit() const
  {
    return this->digitiserRate > 0.0 ? std::round(this->digitiserRate * this->samplingInterval)
                                     : 1.0;
  }

  /// Levels of the digitiser, whose highest level is the power that saturates a range unit. Needs
  /// `digitiserBits`. @param upper upper limit of a range unit, J
  DigitiserLevels levelsOfDigitiser(double upper) const
  {
    const double all = std::exp2(this->digitiserBits);
    const double above = all - 1.0 - all / 16.0;
    return { upper / this->samplesOfUnit() / above, all / 16.0, above };
  }

  /// Length of one range unit, m: c tau_s / 2.
  double rangeUnitLength() const { return 0.5 * SpeedOfLight * this->samplingInterval; }
};

/// Number of range units whose beginning lies inside the gate: ceil(2 gate/(c tau_s)), at least 1.
std::int64_t unitsInsideGate(double samplingInterval, double rangeGate);

/// The unit in which the gate begins, floor(2 minimum/(c tau_s)). Units before this unit receive
/// nothing.
std::int64_t firstUnitInsideGate(double samplingInterval, double minimumRange);

/// Beams whose input must contain a value of the sensor. For other beams the default replaces an
/// absent value.
enum class NeededOf
{
  All,
  Photons, ///< beams of a photon receiver
  None
};

/// Description of a numeric value of the sensor, for checks, keys, field data and files.
struct SensorField
{
  const char* name; ///< name in field data and sensor files
  const char* unit; ///< unit; "1": a pure number
  double Sensor::*member;
  double least, most;
  const char* expected; ///< expected range in words, also if the range depends on other fields
  NeededOf neededOf;
};

/// All numeric values of the sensor. Choices such as profile and receiver model have no entry.
const std::vector<SensorField>& sensorFields();

/// Entry of a member in sensorFields().
const SensorField& sensorField(double Sensor::*member);

/// Range, m, beyond which echoes arrive after the next pulse has left. @param pulseInterval time
/// between two pulses, s
double unambiguousRange(double pulseInterval);

/// Returns an empty string, or a warning about a gate that ends after the next pulse has left.
/// @param pulseInterval time between two pulses, s
std::string warningOnAmbiguity(const Sensor& sensor, double pulseInterval);

/// Returns an empty string for a usable sensor, else a sentence that names the value and what was
/// expected.
std::string checkSensor(const Sensor& sensor);
}

#endif
