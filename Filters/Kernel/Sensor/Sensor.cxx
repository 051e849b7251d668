// SPDX-License-Identifier: BSD-3-Clause
#include "Sensor.h"

#include "PhotonReceiver.h"
#include "ValueError.h"

namespace avianlidar
{
namespace
{
/// False for NaN.
bool within(double value, double least, double most)
{
  return value >= least && value <= most;
}
}

std::string checkSensor(const Sensor& s)
{
  if (!within(s.halfBeamwidth, MinimumHalfBeamwidth, MaximumHalfBeamwidth))
  {
    return valueError("half_beamwidth", s.halfBeamwidth, "1e-9 to pi/3 rad (60 degrees)");
  }
  if (s.beamProfile != BeamProfile::Uniform && s.beamProfile != BeamProfile::Gaussian)
  {
    return valueError(
      "beam_profile", static_cast<int>(s.beamProfile), "0 (uniform) or 1 (Gaussian)");
  }
  if (!within(s.pulseEnergy, MinimumPulseEnergy, MaximumEnergy))
  {
    return valueError("pulse_energy", s.pulseEnergy, "1e-50 to 1e50 J");
  }
  if (!within(s.samplingInterval, MinimumSamplingInterval, MaximumSamplingInterval))
  {
    return valueError("sampling_interval", s.samplingInterval, "1e-30 to 1e20 s");
  }
  if (!within(s.pulseWidth, 0.0, 1000.0 * s.samplingInterval))
  {
    return valueError("pulse_width", s.pulseWidth, "0 s to 1000 times sampling_interval");
  }
  if (!within(s.frequency, MinimumFrequency, MaximumFrequency))
  {
    return valueError("frequency", s.frequency, "1 to 1e30 Hz");
  }
  if (!(s.rangeGate > 0.0) || s.rangeGate > MaximumRangeGate)
  {
    return valueError("range_gate", s.rangeGate, "more than 0 and at most 1e30 m");
  }
  if (2.0 * s.rangeGate > MaximumGateUnits * SpeedOfLight * s.samplingInterval)
  {
    return valueError(
      "range_gate", s.rangeGate, "at most 2^52 range units (c/2 sampling_interval each)");
  }
  if (!within(s.noisePhotonRate, 0.0, MaximumNoisePhotonRate))
  {
    return valueError("noise_photon_rate", s.noisePhotonRate, "0 to 1e50 Hz");
  }
  if (!within(s.lowerEnergyLimit, 0.0, MaximumEnergy))
  {
    return valueError("lower_energy_limit", s.lowerEnergyLimit, "0 to 1e50 J");
  }
  if (!within(s.upperEnergyLimit, s.lowerEnergyLimit, MaximumEnergy))
  {
    return valueError("upper_energy_limit", s.upperEnergyLimit, "lower_energy_limit to 1e50 J");
  }
  if (!within(s.receiverAperture, 0.0, MaximumReceiverAperture))
  {
    return valueError("receiver_aperture", s.receiverAperture, "0 to 1e20 m2");
  }
  if (s.receiverModel != ReceiverModel::EnergyLimits && s.receiverModel != ReceiverModel::Photons)
  {
    return valueError(
      "receiver_model", static_cast<int>(s.receiverModel), "0 (energy limits) or 1 (photons)");
  }
  return checkPhotonReceiver(s);
}
}
