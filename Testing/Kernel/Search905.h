// SPDX-License-Identifier: BSD-3-Clause
// The search lidar of 905 nm, in daylight.
#ifndef Search905_h
#define Search905_h

#include "PhotonReceiver.h"

#include <gtest/gtest.h>

namespace echotest
{
/// What is not set has the same values by default.
inline avianlidar::Sensor search905(double pulseWidth = 5e-9)
{
  avianlidar::Sensor sensor;
  sensor.receiverModel = avianlidar::ReceiverModel::Photons;
  sensor.frequency = avianlidar::SpeedOfLight / 905e-9;
  sensor.receiverAperture = 0.25 * avianlidar::Pi * 0.01;
  sensor.pulseWidth = pulseWidth;
  EXPECT_EQ(setPhotonLimits(sensor, 1.0, 40.0, 15360.0), "");
  return sensor;
}
}

#endif
