// SPDX-License-Identifier: BSD-3-Clause
#include "RangeErrors.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
RangeErrors::RangeErrors(const Sensor& sensor, bool noise)
  : Instrument(sensor)
  , Receiver(sensor)
{
  if (sensor.receiverModel != ReceiverModel::Photons)
  {
    this->Instrument.rangeNoise = 0.0; // the ratio of signal to noise is unknown
  }
  this->Noise = noise && (this->Instrument.rangeNoise > 0.0 || sensor.rangeNoiseFloor > 0.0);
}

double RangeErrors::deviation(double energy) const
{
  const Sensor& sensor = this->Instrument;
  if (!this->Noise)
  {
    return 0.0;
  }
  double ofSignal = 0.0;
  if (sensor.rangeNoise > 0.0)
  {
    const double electrons =
      this->Receiver.electronsPerJoule * std::min(energy, sensor.upperEnergyLimit);
    const double ratio = (electrons - this->Receiver.deviation(electrons)) /
      this->Receiver.deviation(0.25 * electrons);
    ofSignal = sensor.rangeNoise * std::pow(std::max(1.0, ratio), -0.5 * sensor.rangeNoiseExponent);
  }
  return std::hypot(sensor.rangeNoiseFloor, ofSignal);
}

RangeError RangeErrors::of(double energy, double normal) const
{
  const Sensor& sensor = this->Instrument;
  RangeError error;
  if (sensor.rangeWalk > 0.0)
  {
    error.walk = sensor.rangeWalk * std::min(1.0, sensor.lowerEnergyLimit / energy);
  }
  if (this->Noise)
  {
    error.noise = this->deviation(energy) * normal;
  }
  return error;
}

double RangeError::reported(double range, const Sensor& sensor) const
{
  range += this->walk;
  range += this->noise;
  // Nothing is recorded outside the gate. Ranges outside are mirrored at its ends, so that they do
  // not pile up there.
  const double begin = sensor.minimumRange;
  range = begin + std::abs(range - begin);
  range = range > sensor.rangeGate ? std::max(begin, 2.0 * sensor.rangeGate - range) : range;
  if (sensor.rangeQuantum > 0.0)
  {
    range = sensor.rangeQuantum * std::round(range / sensor.rangeQuantum);
  }
  return range;
}
}
