// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Sensor.h
 * @brief The instrument: all of its values on which an echo depends, and their check.
 *
 * Source: paper, Table 2; defaults of Sec. 5.3.
 * Differs: the Gaussian profile, beams that are not round, the receiver's aperture and the photon
 * receiver are added; the defaults, uniform, round, 0 and the limits, are the paper's.
 * Valid: the ranges of sensorFields(), far beyond any instrument.
 * Test: TestScanReport.cxx, TestStabilitySweep.cxx (bad values are named).
 */
#ifndef avianlidar_Sensor_h
#define avianlidar_Sensor_h

#include "Vector.h"

#include <cmath>
#include <string>
#include <vector>

namespace avianlidar
{
/// Distribution of the emitted energy inside the beam.
enum class BeamProfile
{
  Uniform = 0, ///< uniform in solid angle (paper, Eq. 3); see BeamShape.h for beams not round
  /// exp(-2 k^2 u), u = (1-cos theta)/(1-cos theta0.5), k the truncation: by default 1/e^2 at the
  /// half-beamwidth, cut there.
  Gaussian = 1
};

/// Outline of the beam in the plane across its axis.
enum class BeamOutline
{
  Ellipse = 0, ///< a disc, if both half-beamwidths are one
  Rectangle = 1
};

/// What turns energies into echoes.
enum class ReceiverModel
{
  EnergyLimits = 0, ///< limits that are given, and noise photons (paper, Eq. 11 and 12)
  Photons = 1       ///< limits that follow from light and electronics, see PhotonReceiver.h
};

/// What air that scatters does to the threshold of a photon receiver.
enum class ThresholdLaw
{
  Fixed = 0,     ///< nothing
  FollowsAir = 1 ///< mean of the air's echo, plus so many deviations of the noise as without it
};

constexpr double SpeedOfLight = 299792458.0; // m/s, exact
constexpr double PlanckConstant = 6.626e-34; // J s, the value of the paper's Table 2

// Limits of sensorFields(), all far beyond any instrument and far within the range of doubles:
// products and squares of energies and lengths neither overflow nor vanish.
constexpr double MaximumHalfBeamwidth = Pi / 3.0;    // rad; wider than 60 degrees is not a beam
constexpr double MaximumHalfBeamwidthNotRound = 0.1; // rad; both of them
constexpr double MaximumBeamRatio = 1000.0;          // of the two
constexpr double MaximumEnergy = 1e50;               // J, of the pulse and of the limits
constexpr double MaximumRangeGate = 1e30;            // m, as far as coordinates go

/// Range units inside the gate at most: their numbers stay exact in double precision.
constexpr double MaximumGateUnits = 4503599627370496.0; // 2^52

/// The instrument. All values SI; the defaults are the paper's airport (Sec. 5.3).
struct Sensor
{
  double halfBeamwidth = 5.6e-3; ///< rad, 1e-9 to pi/3
  BeamProfile beamProfile = BeamProfile::Uniform;
  double gaussianTruncation = 1.0; ///< half-beamwidths over the Gaussian's 1/e^2 radii, 0.1 to 3
  BeamOutline beamOutline = BeamOutline::Ellipse;
  double halfBeamwidthAcross = 0.0;  ///< rad, across the first one, 1e-9 to 0.1; 0: the same
  double beamRotation = 0.0;         ///< deg, of the first one from the horizontal, towards `up`
  Vec3 up{ 0.0, 0.0, 1.0 };          ///< up axis of the sensor, unit vector in scene coordinates
  double pulseEnergy = 3.6e-4;       ///< Qs, J, 1e-50 to 1e50
  double pulseWidth = 5e-9;          ///< tau_e, s, >= 0 and <= 1000 tau_s
  double frequency = 3.313e14;       ///< nu, Hz, 1 to 1e30
  double samplingInterval = 5e-9;    ///< tau_s, s, 1e-30 to 1e20
  double rangeGate = 4000.0;         ///< m, > 0, <= 1e30: nothing beyond is recorded
  double noisePhotonRate = 20e3;     ///< mean photons per second, 0 to 1e50
  double lowerEnergyLimit = 2e-6;    ///< Qlow, J, 0 to Qhigh
  double upperEnergyLimit = 6.25e-5; ///< Qhigh, J, Qlow to 1e50
  double receiverAperture = 0.0;     ///< m^2, 0 to 1e20; 0: the paper's radiometry (no 1/r^2)

  // The photon receiver; the defaults are assumed.
  ReceiverModel receiverModel = ReceiverModel::EnergyLimits;
  ThresholdLaw thresholdLaw = ThresholdLaw::FollowsAir; ///< law of the photon threshold
  double receiverEfficiency = 0.4;  ///< eta, electrons per photon at the aperture, > 0, <= 1
  double filterBandwidth = 10.0;    ///< nm, 0 to 1e6
  double backgroundRadiance = 0.05; ///< L, W/(m^2 sr nm), 0 to 1e10
  double amplifierNoise = 60.0;     ///< n_a, electrons rms in a range unit, 0 to 1e20
  double excessNoiseFactor = 3.0;   ///< F, 1 to 1e6

  // Daylight by what a beam looks at (Background.h); 0: all look at the background radiance.
  double sunlight = 0.0;      ///< E, W/(m^2 nm), of the sun on what faces it, 0 to 1e10
  double sunAzimuth = 180.0;  ///< azimuth of the sun, deg from north, clockwise
  double sunElevation = 45.0; ///< deg, -90 to 90

  // What a receiver loses of near echoes, see nearRangeShare(); 0: nothing.
  double minimumRange = 0.0; ///< m, 0 to rangeGate: nothing nearer is recorded
  double overlapRange = 0.0; ///< m, at which 1 - 1/e of the beam lies in its view
  double defocusRange = 0.0; ///< m, at which half of a spot's blurred image is on the detector

  // Errors of ranges (RangeErrors.h); the paper's receiver has none.
  double rangeNoise = 0.0;         ///< b, m, standard deviation at a signal-to-noise ratio of 1
  double rangeNoiseExponent = 2.0; ///< p, 0 to 10
  double rangeNoiseFloor = 0.0;    ///< a, m, standard deviation of the strongest echoes
  double rangeWalk = 0.0;          ///< m, at the lower limit
  double rangeQuantum = 0.0;       ///< m, step of the ranges; 0: none

  /// Energy of one photon, J.
  double photonEnergy() const { return PlanckConstant * this->frequency; }

  /// True if the beam is a cone.
  bool hasRoundBeam() const
  {
    return this->beamOutline == BeamOutline::Ellipse &&
      (this->halfBeamwidthAcross == 0.0 || this->halfBeamwidthAcross == this->halfBeamwidth);
  }

  /// Solid angle of the beam, sr; of an ellipse within 1e-4 of it.
  double solidAngle() const;

  /// True if the mean of the air's echo is taken off.
  bool followsAir() const
  {
    return this->receiverModel == ReceiverModel::Photons &&
      this->thresholdLaw == ThresholdLaw::FollowsAir;
  }

  /// True if what a beam looks at decides on its background.
  bool seesDaylight() const
  {
    return this->receiverModel == ReceiverModel::Photons && this->sunlight > 0.0;
  }

  /// True if it receives less of near echoes than of far ones.
  bool losesNearRange() const { return this->overlapRange > 0.0 || this->defocusRange > 0.0; }

  /// Share of the light from a range, m, that reaches the detector: (1 - exp(-(r/r_o)^2))/(1 +
  /// (r_d/r)^2), r_o the range of overlap, r_d that of defocus.
  double nearRangeShare(double range) const;

  /// Length of one range unit, m: c tau_s / 2.
  double rangeUnitLength() const { return 0.5 * SpeedOfLight * this->samplingInterval; }
};

/// Which beams must say a number of the sensor; of others it is the default.
enum class NeededOf
{
  All,
  Photons, ///< those of a photon receiver
  None
};

/// A number of the sensor, for all that goes through them: checks, keys, field data, files.
struct SensorField
{
  const char* name; ///< as field data and sensor files have it
  const char* unit; ///< "1": a pure number
  double Sensor::*member;
  double least, most;
  const char* expected; ///< the range in words, also where it depends on other fields
  NeededOf neededOf;
};

/// All numbers of the sensor; profile and receiver model are choices.
const std::vector<SensorField>& sensorFields();

/// The row of a member.
const SensorField& sensorField(double Sensor::*member);

/// Range, m, from which echoes arrive after the next pulse has left. @param pulseInterval s
double unambiguousRange(double pulseInterval);

/// Empty, or a sentence on a gate that ends after the next pulse has left. @param pulseInterval s
std::string warningOnAmbiguity(const Sensor& sensor, double pulseInterval);

/// Empty if the sensor is usable; otherwise a sentence that names the value and what was expected.
std::string checkSensor(const Sensor& sensor);
}

#endif
