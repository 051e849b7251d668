// SPDX-License-Identifier: BSD-3-Clause
#include "Sensor.h"

#include "Complaint.h"

#include <cmath>
#include <sstream>

namespace avianlidar
{
std::string checkSensor(const Sensor& s)
{
  const auto positive = [](double v) { return std::isfinite(v) && v > 0.0; };
  const auto notNegative = [](double v) { return std::isfinite(v) && v >= 0.0; };
  if (!positive(s.halfBeamwidth) || s.halfBeamwidth > MaximumHalfBeamwidth)
  {
    return complaint(
      "half_beamwidth", s.halfBeamwidth, "more than 0 and at most pi/3 rad (60 degrees)");
  }
  if (s.beamProfile != BeamProfile::Uniform && s.beamProfile != BeamProfile::Gaussian)
  {
    return complaint(
      "beam_profile", static_cast<int>(s.beamProfile), "0 (uniform) or 1 (Gaussian)");
  }
  if (!positive(s.pulseEnergy))
  {
    return complaint("pulse_energy", s.pulseEnergy, "more than 0 J");
  }
  if (!positive(s.samplingInterval))
  {
    return complaint("sampling_interval", s.samplingInterval, "more than 0 s");
  }
  if (!notNegative(s.pulseWidth) || s.pulseWidth > 1000.0 * s.samplingInterval)
  {
    return complaint(
      "pulse_width", s.pulseWidth, "at least 0 s and at most 1000 sampling intervals");
  }
  if (!positive(s.frequency))
  {
    return complaint("frequency", s.frequency, "more than 0 Hz");
  }
  if (!positive(s.rangeGate))
  {
    return complaint("range_gate", s.rangeGate, "more than 0 m");
  }
  if (2.0 * s.rangeGate > MaximumGateUnits * SpeedOfLight * s.samplingInterval)
  {
    return complaint(
      "range_gate", s.rangeGate, "at most 2^52 range units (c/2 sampling_interval each)");
  }
  if (!notNegative(s.noisePhotonRate))
  {
    return complaint("noise_photon_rate", s.noisePhotonRate, "at least 0 Hz");
  }
  if (!notNegative(s.lowerEnergyLimit))
  {
    return complaint("lower_energy_limit", s.lowerEnergyLimit, "at least 0 J");
  }
  if (!std::isfinite(s.upperEnergyLimit) || s.upperEnergyLimit < s.lowerEnergyLimit)
  {
    return complaint("upper_energy_limit", s.upperEnergyLimit, "at least lower_energy_limit");
  }
  if (!notNegative(s.receiverAperture))
  {
    return complaint("receiver_aperture", s.receiverAperture, "at least 0 m2");
  }
  return {};
}
}
