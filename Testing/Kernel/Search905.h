// SPDX-License-Identifier: BSD-3-Clause
// Receivers of photons in daylight, as data sheets give them; first of all the search lidar of
// 905 nm.
#ifndef Search905_h
#define Search905_h

#include "PhotonReceiver.h"

#include <gtest/gtest.h>

namespace echotest
{
struct Instrument
{
  double energy, wavelength, halfBeamwidth; ///< J, m, rad
  double diameter, efficiency; ///< diameter of the aperture, m; efficiency of the detector
  double radiance, bandwidth;  ///< W/(m2 sr nm), nm
  double beams, gate;          ///< beams of a scan; m
};

constexpr Instrument Search905{ 3.6e-4, 905e-9, 5.6e-3, 0.1, 0.4, 0.05, 10.0, 15360.0, 4000.0 };
constexpr Instrument Search1550{ 1e-3, 1550e-9, 3e-3, 0.15, 0.3, 0.01, 10.0, 53000.0, 4000.0 };
constexpr Instrument Automotive16{ 4e-7, 905e-9, 1.5e-3, 0.025, 0.4, 0.05, 20.0, 64000.0, 300.0 };

/// One false alarm a scan, and a dynamic range of 40 dB.
inline avianlidar::Sensor sensorOf(const Instrument& of)
{
  avianlidar::Sensor sensor;
  sensor.receiverModel = avianlidar::ReceiverModel::Photons;
  sensor.pulseEnergy = of.energy;
  sensor.frequency = avianlidar::SpeedOfLight / of.wavelength;
  sensor.halfBeamwidth = of.halfBeamwidth;
  sensor.receiverAperture = 0.25 * avianlidar::Pi * of.diameter * of.diameter;
  sensor.receiverEfficiency = of.efficiency;
  sensor.backgroundRadiance = of.radiance;
  sensor.filterBandwidth = of.bandwidth;
  sensor.rangeGate = of.gate;
  EXPECT_EQ(setPhotonLimits(sensor, 1.0, 40.0, of.beams), "");
  EXPECT_EQ(checkSensor(sensor), "");
  return sensor;
}

inline avianlidar::Sensor search905(double pulseWidth = 5e-9)
{
  avianlidar::Sensor sensor = sensorOf(Search905);
  sensor.pulseWidth = pulseWidth;
  return sensor;
}
}

#endif
