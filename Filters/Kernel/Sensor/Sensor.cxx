// SPDX-License-Identifier: BSD-3-Clause
#include "Sensor.h"

#include "Figures.h"
#include "MemberCount.h"
#include "PhotonReceiver.h"
#include "ValueError.h"

#include <algorithm>
#include <sstream>

namespace avianlidar
{
std::int64_t unitsInsideGate(double samplingInterval, double rangeGate)
{
  // checkSensor() refuses more than MaximumGateUnits.
  const double units = std::ceil(2.0 * rangeGate / (SpeedOfLight * samplingInterval));
  return static_cast<std::int64_t>(std::clamp(units, 1.0, MaximumGateUnits));
}

std::int64_t firstUnitInsideGate(double samplingInterval, double minimumRange)
{
  return static_cast<std::int64_t>(
    std::min(MaximumGateUnits, std::floor(2.0 * minimumRange / (SpeedOfLight * samplingInterval))));
}

const std::vector<SensorField>& sensorFields()
{
  static const std::vector<SensorField> all = {
    { "half_beamwidth", "rad", &Sensor::halfBeamwidth, 1e-9, MaximumHalfBeamwidth,
      "1e-9 to pi/3 rad (60 degrees)", NeededOf::All }, // sampling is exact from 1e-9 on
    { "gaussian_truncation", "1", &Sensor::gaussianTruncation, 0.1, 3.0, "0.1 to 3",
      NeededOf::None },
    { "half_beamwidth_across", "rad", &Sensor::halfBeamwidthAcross, 0.0,
      MaximumHalfBeamwidthNotRound, "0 (the same), or 1e-9 to 0.1 rad", NeededOf::None },
    { "beam_rotation", "deg", &Sensor::beamRotation, -360.0, 360.0, "-360 to 360 deg",
      NeededOf::None },
    { "pulse_energy", "J", &Sensor::pulseEnergy, 1e-50, MaximumEnergy, "1e-50 to 1e50 J",
      NeededOf::All },
    { "sampling_interval", "s", &Sensor::samplingInterval, 1e-30, 1e20, "1e-30 to 1e20 s",
      NeededOf::All },
    { "pulse_width", "s", &Sensor::pulseWidth, 0.0, 1e23, "0 s to 1000 times sampling_interval",
      NeededOf::All },
    { "frequency", "Hz", &Sensor::frequency, 1.0, 1e30, "1 to 1e30 Hz", NeededOf::All },
    { "range_gate", "m", &Sensor::rangeGate, AboveZero, MaximumRangeGate,
      "more than 0 and at most 1e30 m", NeededOf::All },
    { "noise_photon_rate", "Hz", &Sensor::noisePhotonRate, 0.0, 1e50, "0 to 1e50 Hz",
      NeededOf::All },
    { "lower_energy_limit", "J", &Sensor::lowerEnergyLimit, 0.0, MaximumEnergy, "0 to 1e50 J",
      NeededOf::All },
    { "upper_energy_limit", "J", &Sensor::upperEnergyLimit, 0.0, MaximumEnergy,
      "lower_energy_limit to 1e50 J", NeededOf::All },
    { "receiver_aperture", "m2", &Sensor::receiverAperture, 0.0, 1e20, "0 to 1e20 m2",
      NeededOf::All },
    { "receiver_efficiency", "1", &Sensor::receiverEfficiency, AboveZero, 1.0,
      "more than 0 and at most 1", NeededOf::Photons },
    { "filter_bandwidth", "nm", &Sensor::filterBandwidth, 0.0, 1e6, "0 to 1e6 nm",
      NeededOf::Photons },
    { "background_radiance", "W/(m2 sr nm)", &Sensor::backgroundRadiance, 0.0, 1e10,
      "0 to 1e10 W/(m2 sr nm)", NeededOf::Photons },
    { "amplifier_noise", "1", &Sensor::amplifierNoise, 0.0, 1e20, "0, or 1e-3 to 1e20 electrons",
      NeededOf::Photons },
    { "excess_noise_factor", "1", &Sensor::excessNoiseFactor, 1.0, 1e6, "1 to 1e6",
      NeededOf::Photons },
    { "sunlight", "W/(m2 nm)", &Sensor::sunlight, 0.0, 1e10, "0 to 1e10 W/(m2 nm)",
      NeededOf::None },
    { "sun_azimuth", "deg", &Sensor::sunAzimuth, -360.0, 360.0, "-360 to 360 deg", NeededOf::None },
    { "sun_elevation", "deg", &Sensor::sunElevation, -90.0, 90.0, "-90 to 90 deg", NeededOf::None },
    { "minimum_range", "m", &Sensor::minimumRange, 0.0, MaximumRangeGate,
      "0 to less than range_gate, m", NeededOf::None },
    { "overlap_range", "m", &Sensor::overlapRange, 0.0, 1e9, "0 to 1e9 m", NeededOf::None },
    { "defocus_range", "m", &Sensor::defocusRange, 0.0, 1e9, "0 to 1e9 m", NeededOf::None },
    { "range_noise", "m", &Sensor::rangeNoise, 0.0, 1e9, "0 to 1e9 m", NeededOf::None },
    { "range_noise_exponent", "1", &Sensor::rangeNoiseExponent, 0.0, 10.0, "0 to 10",
      NeededOf::None },
    { "range_noise_floor", "m", &Sensor::rangeNoiseFloor, 0.0, 1e9, "0 to 1e9 m", NeededOf::None },
    { "range_walk", "m", &Sensor::rangeWalk, 0.0, 1e9, "0 to 1e9 m", NeededOf::None },
    { "range_quantum", "m", &Sensor::rangeQuantum, 0.0, 1e9, "0, or 1e-9 to 1e9 m",
      NeededOf::None },
    { "response_time", "s", &Sensor::responseTime, 0.0, 1e23, "0 s to 1000 times sampling_interval",
      NeededOf::None },
    { "digitiser_rate", "Hz", &Sensor::digitiserRate, 0.0, 1e33,
      "0, or 1 to 100 times 1/sampling_interval, a whole multiple, Hz", NeededOf::None },
    { "digitiser_bits", "1", &Sensor::digitiserBits, 0.0, 32.0, "0, or a whole number from 4 to 32",
      NeededOf::None }
  };
  // Profile, outline, receiver model, threshold law, up axis, shape and samples of the pulse.
  constexpr std::size_t others = 7;
  static_assert(memberCount<Sensor>() == 32 + others, "is the new member a row of the table?");
  return all;
}

const SensorField& sensorField(double Sensor::*member)
{
  const std::vector<SensorField>& all = sensorFields();
  return *std::find_if(
    all.begin(), all.end(), [=](const SensorField& field) { return field.member == member; });
}

double Sensor::solidAngle() const
{
  if (this->hasRoundBeam())
  {
    const double sine = std::sin(0.5 * this->halfBeamwidth);
    return 4.0 * Pi * sine * sine;
  }
  const double one = std::tan(this->halfBeamwidth);
  const double two = this->halfBeamwidthAcross > 0.0 ? std::tan(this->halfBeamwidthAcross) : one;
  const double squares = one * one + two * two;
  return this->beamOutline == BeamOutline::Rectangle
    ? 4.0 * std::atan(one * two / std::sqrt(1.0 + squares))
    : Pi * one * two * (1.0 - 0.375 * squares); // to the second order
}

double Sensor::nearRangeShare(double range) const
{
  const double overlap = this->overlapRange > 0.0
    ? -std::expm1(-(range / this->overlapRange) * (range / this->overlapRange))
    : 1.0;
  const double image = this->defocusRange > 0.0 ? this->defocusRange / range : 0.0;
  return overlap / (1.0 + image * image);
}

double unambiguousRange(double pulseInterval)
{
  return 0.5 * SpeedOfLight * pulseInterval;
}

std::string warningOnAmbiguity(const Sensor& sensor, double pulseInterval)
{
  if (!(sensor.rangeGate > unambiguousRange(pulseInterval)))
  {
    return {};
  }
  std::ostringstream text;
  text
    << "range_gate is " << figures(sensor.rangeGate, 4) << " m, but the next pulse leaves after "
    << figures(1e6 * pulseInterval, 4) << " us, that is "
    << figures(unambiguousRange(pulseInterval), 4)
    << " m: a receiver that all channels share takes echoes from beyond for nearer ones, which is "
    << "not simulated";
  return text.str();
}

namespace
{
/// True if a range unit has a whole number of samples, 1 to 100.
bool isDigitiserGood(const Sensor& s)
{
  const double samples = s.digitiserRate * s.samplingInterval;
  const double whole = std::round(samples);
  return s.digitiserRate == 0.0 ||
    (whole >= 1.0 && whole <= 100.0 && std::fabs(samples - whole) < 1e-4 * whole);
}
}

std::string checkSensor(const Sensor& s)
{
  for (const SensorField& field : sensorFields())
  {
    const std::string error =
      rangeError(field.name, s.*field.member, field.least, field.most, field.expected);
    if (!error.empty())
    {
      return error;
    }
  }
  const auto choice = [](const char* name, auto value, const char* expected)
  { return rangeError(name, static_cast<int>(value), 0.0, 1.0, expected); };
  const auto require = [&](bool isGood, double Sensor::*member)
  {
    const SensorField& field = sensorField(member);
    return isGood ? std::string() : valueError(field.name, s.*member, field.expected);
  };
  const double across = s.halfBeamwidthAcross;
  const double ratio = across / s.halfBeamwidth;
  const bool isAcrossGood = across == 0.0 ||
    (across >= 1e-9 && ratio >= 1.0 / MaximumBeamRatio && ratio <= MaximumBeamRatio);
  return firstError({
    choice("beam_profile", s.beamProfile, "0 (uniform) or 1 (Gaussian)"),
    choice("beam_outline", s.beamOutline, "0 (ellipse) or 1 (rectangle)"),
    rangeError("half_beamwidth", s.halfBeamwidth, 0.0,
      s.hasRoundBeam() ? MaximumHalfBeamwidth : MaximumHalfBeamwidthNotRound,
      "at most 0.1 rad of a beam that is not round"),
    isAcrossGood ? ""
                 : valueError("half_beamwidth_across", across,
                     "0 (the same), or 1e-9 to 0.1 rad and 1/1000 to 1000 times half_beamwidth"),
    choice("receiver_model", s.receiverModel, "0 (energy limits) or 1 (photons)"),
    choice("threshold_law", s.thresholdLaw, "0 (fixed) or 1 (follows the air)"),
    require(s.pulseWidth <= 1000.0 * s.samplingInterval, &Sensor::pulseWidth),
    rangeError("pulse_shape", static_cast<int>(s.pulseShape), 0.0, 2.0,
      "0 (rectangle), 1 (Gaussian) or 2 (samples)"),
    s.pulseShape == PulseShape::Samples ? checkPulseSamples(s) : "",
    require(s.responseTime <= 1000.0 * s.samplingInterval, &Sensor::responseTime),
    require(isDigitiserGood(s), &Sensor::digitiserRate),
    require(s.digitiserBits == 0.0 ||
        (s.digitiserBits >= 4.0 && s.digitiserBits == std::floor(s.digitiserBits)),
      &Sensor::digitiserBits),
    rangeError("range_gate", s.rangeGate, 0.0,
      0.5 * MaximumGateUnits * SpeedOfLight * s.samplingInterval,
      "at most 2^52 range units (c/2 sampling_interval each)"),
    require(s.minimumRange < s.rangeGate, &Sensor::minimumRange),
    require(s.upperEnergyLimit >= s.lowerEnergyLimit, &Sensor::upperEnergyLimit),
    require(!(s.amplifierNoise > 0.0 && s.amplifierNoise < 1e-3), &Sensor::amplifierNoise),
    require(!(s.rangeQuantum > 0.0 && s.rangeQuantum < 1e-9), &Sensor::rangeQuantum),
    s.receiverModel == ReceiverModel::Photons ? checkPhotonReceiver(s) : "",
  });
}
}
