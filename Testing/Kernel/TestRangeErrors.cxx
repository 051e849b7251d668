// SPDX-License-Identifier: BSD-3-Clause
// What a receiver makes of ranges: standard deviation, walk, quantum. Scans are
// TestRangeNoise.py's.
#include "RangeErrors.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace avianlidar;

namespace
{
Sensor photons()
{
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.receiverAperture = 0.00785;
  sensor.lowerEnergyLimit = 1e-16;
  sensor.upperEnergyLimit = 1.0;
  return sensor;
}

/// Energy at which the strongest unit gets so many electrons, J.
double energyOf(const Sensor& sensor, double electrons)
{
  return electrons / PhotonReceiver(sensor).electronsPerJoule;
}

/// Range that the receiver reports, m. @param normal a standard normal deviate
double reported(
  const Sensor& sensor, double range, double energy, double normal, bool hasNoise = true)
{
  return RangeErrors(sensor, hasNoise).of(energy, normal).reported(range, sensor);
}
}

TEST(RangeErrors, DeviationByItsFormula)
{
  Sensor sensor = photons();
  sensor.rangeNoise = 0.486;
  sensor.rangeNoiseFloor = 0.01;
  const PhotonReceiver receiver(sensor);
  for (const double exponent : { 0.0, 1.1, 2.0 })
  {
    sensor.rangeNoiseExponent = exponent;
    const RangeErrors errors(sensor, true);
    for (const double n : { 600.0, 2000.0, 1e6 })
    {
      const double dark = receiver.darkVariance;
      const double ratio = (n - std::sqrt(dark + 3.0 * n)) / std::sqrt(dark + 0.75 * n);
      EXPECT_NEAR(errors.deviation(energyOf(sensor, n)),
        std::sqrt(1e-4 + 0.486 * 0.486 / std::pow(ratio, exponent)), 1e-12);
    }
    // A saturated receiver knows no more than one at its upper limit.
    sensor.upperEnergyLimit = energyOf(sensor, 2000.0);
    EXPECT_EQ(RangeErrors(sensor, true).deviation(energyOf(sensor, 1e6)),
      errors.deviation(energyOf(sensor, 2000.0)));
    sensor.upperEnergyLimit = 1.0;
    // Not more than the noise of a ratio of 1, also where nothing is left of the signal.
    EXPECT_NEAR(errors.deviation(energyOf(sensor, 1.0)), std::hypot(0.01, 0.486), 1e-12);
  }
}

TEST(RangeErrors, WalkAndQuantum)
{
  Sensor sensor = photons();
  EXPECT_EQ(reported(sensor, 123.456, 1e-12, 2.0), 123.456); // none by default
  sensor.rangeWalk = 0.3;
  const double low = sensor.lowerEnergyLimit;
  EXPECT_NEAR(reported(sensor, 100.0, low, 0.0), 100.3, 1e-12);
  EXPECT_NEAR(reported(sensor, 100.0, 10.0 * low, 0.0), 100.03, 1e-12);
  sensor.rangeQuantum = 0.25;
  EXPECT_EQ(reported(sensor, 100.0, low, 0.0), 100.25);
  sensor.rangeNoise = 7.0; // of a photon receiver alone
  sensor.receiverModel = ReceiverModel::EnergyLimits;
  EXPECT_EQ(RangeErrors(sensor, true).deviation(low), 0.0);
  sensor.rangeNoiseFloor = 1.0;
  EXPECT_EQ(reported(sensor, 100.0, low, 2.0), 102.25);
  EXPECT_EQ(reported(sensor, 100.0, low, 2.0, false), 100.25);
  // No range is before or beyond the gate.
  EXPECT_EQ(reported(sensor, 1.0, low, -5.0), 3.75);
  EXPECT_EQ(reported(sensor, sensor.rangeGate - 1.0, low, 3.0), sensor.rangeGate - 2.25);
  sensor.minimumRange = 2.0;
  EXPECT_EQ(reported(sensor, 3.0, low, -5.0), 5.75);
  sensor.minimumRange = 0.0;
  sensor.rangeNoiseFloor = 1e9;
  EXPECT_EQ(reported(sensor, 1.0, low, 1.0), 0.0);
  sensor.rangeQuantum = 1e-310; // multiples of it would overflow
  statistics::expectSays(checkSensor(sensor), "range_quantum");
}
