// SPDX-License-Identifier: BSD-3-Clause
#include "PhotonReceiver.h"

#include "Distributions.h"
#include "Figures.h"
#include "ValueError.h"

#include <boost/math/special_functions/erf.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace avianlidar
{
namespace
{
/// Ratio of false alarms to requested false alarms above which a warning is given.
constexpr double MostFalseAlarmsUnsaid = 10.0;

std::string checkDynamicRange(double dynamicRange)
{
  return rangeError("dynamic_range", dynamicRange, 0.0, 1000.0, "0 to 1000 dB");
}

void setLimits(Sensor& sensor, double lower, double dynamicRange)
{
  sensor.lowerEnergyLimit = lower;
  sensor.upperEnergyLimit = std::min(MaximumEnergy, lower * std::pow(10.0, 0.1 * dynamicRange));
}
}

PhotonReceiver::PhotonReceiver(const Sensor& sensor)
  : electronsPerJoule(sensor.receiverEfficiency / sensor.photonEnergy())
  , background(0.0)
  , darkVariance(0.0)
  , excess(sensor.excessNoiseFactor)
{
  this->background = this->electronsPerJoule * sensor.backgroundRadiance * sensor.filterBandwidth *
    sensor.solidAngle() * sensor.receiverAperture * sensor.samplingInterval;
  this->darkVariance =
    this->excess * this->background + sensor.amplifierNoise * sensor.amplifierNoise;
}

double PhotonReceiver::deviation(double electrons) const
{
  return std::sqrt(this->darkVariance + this->excess * std::max(0.0, electrons));
}

double PhotonReceiver::signalToNoise(double electrons) const
{
  return electrons / this->deviation(electrons);
}

double PhotonReceiver::detectionProbability(double electrons, double threshold, double air) const
{
  return 0.5 * std::erfc((threshold - electrons) / (Root2 * this->deviation(electrons + air)));
}

Sensor lookingAt(const Sensor& sensor, double radiance)
{
  Sensor there = sensor;
  if (radiance == sensor.backgroundRadiance)
  {
    return there;
  }
  there.backgroundRadiance = radiance;
  there.lowerEnergyLimit *=
    std::max(1.0, PhotonReceiver(there).deviation(0.0) / PhotonReceiver(sensor).deviation(0.0));
  there.upperEnergyLimit = std::max(there.upperEnergyLimit, there.lowerEnergyLimit);
  return there;
}

double perceptionProbability(
  const Sensor& sensor, const PhotonReceiver& receiver, double energy, double air)
{
  if (sensor.receiverModel == ReceiverModel::Photons)
  {
    const double ofAir = sensor.followsAir() ? receiver.electronsPerJoule * air : 0.0;
    return receiver.detectionProbability(receiver.electronsPerJoule * energy,
      receiver.electronsPerJoule * sensor.lowerEnergyLimit * receiver.growthInAir(ofAir), ofAir);
  }
  return energy > sensor.lowerEnergyLimit ? 1.0 : 0.0;
}

double falseAlarmsOfElectrons(const Sensor& sensor)
{
  const PhotonReceiver receiver(sensor);
  const double deviation = receiver.deviation(0.0);
  const double k = sensor.lowerEnergyLimit * receiver.electronsPerJoule / deviation;
  const double skewness =
    receiver.excess / deviation * receiver.excess / deviation * receiver.background / deviation;
  const double shape = 4.0 / (skewness * skewness);
  constexpr double gaussian = 1e12; // shape from which the ratio differs from 1 by less than 1e-4
  return shape < gaussian
    ? gammaTail(shape, shape + k * std::sqrt(shape)) / (0.5 * std::erfc(k / Root2))
    : 1.0;
}

std::string warningOnElectrons(const Sensor& sensor)
{
  const double times =
    sensor.receiverModel == ReceiverModel::Photons ? falseAlarmsOfElectrons(sensor) : 1.0;
  if (!(times > MostFalseAlarmsUnsaid))
  {
    return {};
  }
  std::ostringstream text;
  text << "noise of so few electrons is not Gaussian: a receiver of "
       << figures(PhotonReceiver(sensor).background, 4)
       << " background electrons in a range unit and an "
       << "amplifier_noise of " << figures(sensor.amplifierNoise, 4) << " would raise some "
       << figures(times, 4) << " times the false_alarms_per_scan asked for";
  return text.str();
}

double thresholdFactor(double falseAlarms, double units)
{
  return Root2 * boost::math::erfc_inv(2.0 * falseAlarms / units);
}

double rangeUnitsOf(const Sensor& sensor, double beams)
{
  return beams *
    static_cast<double>(unitsInsideGate(sensor.samplingInterval, sensor.rangeGate) -
      firstUnitInsideGate(sensor.samplingInterval, sensor.minimumRange));
}

std::string checkPhotonLimits(double falseAlarms, double dynamicRange)
{
  return firstError({ rangeError("false_alarms_per_scan", falseAlarms, AboveZero,
                        MaximumFalseAlarmsPerScan, "more than 0 and at most 1e8"),
    checkDynamicRange(dynamicRange) });
}

std::string setPhotonLimits(Sensor& sensor, double falseAlarms, double dynamicRange, double beams)
{
  const double units = rangeUnitsOf(sensor, beams);
  const std::string error = firstError({ checkPhotonLimits(falseAlarms, dynamicRange),
    falseAlarms < 0.1 * units
      ? ""
      : valueError("false_alarms_per_scan", falseAlarms,
          "less than a tenth of the range units of the scan (beams times range_gate over c/2 "
          "sampling_interval)") });
  if (error.empty())
  {
    const PhotonReceiver receiver(sensor);
    setLimits(sensor,
      thresholdFactor(falseAlarms, units) * receiver.deviation(0.0) / receiver.electronsPerJoule,
      dynamicRange);
  }
  return error;
}

std::string setDataSheetLimits(
  Sensor& sensor, double range, double reflectance, double attenuation, double dynamicRange)
{
  const double energy = energyFromTarget(sensor, range, Infinity, reflectance, attenuation);
  const std::string error = firstError({
    rangeError("range", range, AboveZero, MaximumRangeGate, "more than 0 and at most 1e30 m"),
    rangeError("reflectance", reflectance, AboveZero, 1.0, "more than 0 and at most 1"),
    rangeError("attenuation", attenuation, 0.0, LargestFinite, "at least 0 1/m"),
    rangeError("receiver_aperture", sensor.receiverAperture, AboveZero, LargestFinite,
      "more than 0 m2: without it no energy falls with the range"),
    checkDynamicRange(dynamicRange),
    energy > 0.0 ? ""
                 : valueError("attenuation", attenuation, "one through which light comes back"),
  });
  if (error.empty())
  {
    setLimits(sensor, energy, dynamicRange);
  }
  return error;
}

double energyFromTarget(
  const Sensor& sensor, double range, double area, double reflectance, double attenuation)
{
  const double range2 = range * range;
  const double met = std::min(1.0, area / (sensor.solidAngle() * range2));
  const double gathered = sensor.receiverAperture > 0.0
    ? std::min(1.0, reflectance * sensor.receiverAperture / (Pi * range2))
    : reflectance;
  return sensor.pulseEnergy * met * gathered * sensor.nearRangeShare(range) *
    std::exp(-2.0 * attenuation * range);
}

std::string checkPhotonReceiver(const Sensor& s)
{
  return firstError({ rangeError("receiver_aperture", s.receiverAperture, AboveZero, LargestFinite,
                        "more than 0 m2 with receiver_model 1 (photons)"),
    PhotonReceiver(s).darkVariance > 0.0
      ? ""
      : valueError("amplifier_noise", s.amplifierNoise,
          "more than 0 where no background light arrives (background_radiance, "
          "filter_bandwidth)") });
}
}
