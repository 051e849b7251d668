// SPDX-License-Identifier: BSD-3-Clause
// Daylight that a beam looks at: radiance, noise, threshold and false alarms by closed form.
#include "Background.h"
#include "EchoTestScene.h"
#include "PhotonReceiver.h"
#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace avianlidar;
using namespace echotest;

namespace
{
constexpr double Sky = 0.05;
constexpr double Sun = 0.7;
constexpr double Far = 100.0; // of the plates, m

Sensor noonSensor()
{
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.receiverAperture = 0.00785;
  sensor.rangeGate = 300.0;
  sensor.backgroundRadiance = Sky;
  sensor.sunlight = Sun;
  sensor.sunAzimuth = 270.0; // behind a lidar that looks east
  sensor.sunElevation = 30.0;
  EXPECT_EQ(setPhotonLimits(sensor, 20.0, 40.0, 2000.0), "");
  return sensor;
}

/// A plate across the beam towards x, from y on. @param kd matt
Scene plateFrom(double y, double kd)
{
  Scene scene;
  scene.square(Vec3(Far, y + 50.0, 0.0), 50.0, { kd, 0.0, 0.0 });
  return scene;
}

EchoSettings noisySettings(BeamSampleSource samples = BeamSampleSource::Cells)
{
  EchoSettings settings;
  settings.numberOfReflections = 1;
  settings.attenuationCoefficient = 0.0;
  settings.beamSamples = samples;
  return settings;
}

/// Radiance that the first echo with light says.
double radianceOf(const Scene& scene, const Sensor& sensor, BeamSampleSource samples)
{
  for (const Echo& echo :
    runScan(makeSetup(scene, sensor, noisySettings(samples)), oneBeam()).echoes)
  {
    if (echo.objectId >= 0)
    {
      return echo.background;
    }
  }
  return -1.0;
}
}

TEST(Background, OfPlatesByClosedForm)
{
  const double cosine = std::cos(30.0 * RadiansPerDegree); // the plate faces west
  for (const auto samples : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    Sensor sensor = noonSensor();
    const double lit = 0.4 * (Sky + Sun * cosine / Pi);
    EXPECT_NEAR(radianceOf(plateFrom(-50.0, 0.4), sensor, samples), lit, 1e-10);
    // Half of the beam looks past it.
    EXPECT_NEAR(radianceOf(plateFrom(0.0, 0.4), sensor, samples), 0.5 * (lit + Sky), 0.02 * lit);
    // The sun behind the plate: the side that the lidar sees lies in the sky's light alone.
    sensor.sunAzimuth = 90.0;
    EXPECT_NEAR(radianceOf(plateFrom(-50.0, 0.4), sensor, samples), 0.4 * Sky, 1e-10);
    // The sun below the horizon, on the side of the plate.
    sensor.sunAzimuth = 270.0;
    sensor.sunElevation = -30.0;
    EXPECT_NEAR(radianceOf(plateFrom(-50.0, 0.4), sensor, samples), 0.4 * Sky, 1e-10);
    sensor.sunlight = 0.0;
    EXPECT_EQ(radianceOf(plateFrom(-50.0, 0.4), sensor, samples), Sky);
  }
}

TEST(Background, SurfacesBehindTheGateCount)
{
  // A near plate fills one half of the beam, and a plate behind the gate the other half.
  const double lit = 0.4 * (Sky + Sun * std::cos(30.0 * RadiansPerDegree) / Pi);
  Scene scene = plateFrom(0.0, 0.4);
  scene.square(Vec3(600.0, -50.0, 0.0), 50.0, { 0.4, 0.0, 0.0 });
  const Sensor sensor = noonSensor();
  EXPECT_NEAR(radianceOf(scene, sensor, BeamSampleSource::Cells), lit, 0.02 * lit);
  // Also for a beam without near surfaces that was seen at night before.
  Scene far = squareAt(600.0, 50.0, { 0.4, 0.0, 0.0 });
  Sensor night = sensor;
  night.sunlight = 0.0;
  TraceCache cache;
  ScanResult result;
  const ScanBeams beams = alike(2000);
  const std::size_t most = std::size_t{ 1 } << 30;
  ASSERT_TRUE(
    simulateScan(makeSetup(far, night, noisySettings()), beams, 1, cache, most, {}, result));
  EXPECT_EQ(result.reports[0].status, BeamStatus::OutsideGate);
  ASSERT_TRUE(
    simulateScan(makeSetup(far, sensor, noisySettings()), beams, 1, cache, most, {}, result));
  ASSERT_FALSE(result.echoes.empty()); // false alarms
  EXPECT_NEAR(result.echoes[0].background, lit, 1e-10);
}

TEST(Background, GroundThatIsFaintToTheLaserCounts)
{
  // Level ground, 2 m below, seen at 0.4 degrees: over many range units.
  Scene scene;
  scene.plate({ 0.0, 0.0, -2.0 }, { 5000.0, 0.0, 0.0 }, { 0.0, 5000.0, 0.0 }, { 0.3, 0.0, 0.0 });
  Sensor sensor = noonSensor();
  sensor.halfBeamwidth = 1e-3;
  sensor.backgroundRadiance = 0.01; // the ground is brighter
  ASSERT_EQ(setPhotonLimits(sensor, 20.0, 40.0, 2000.0), "");
  const double angle = 0.4 * RadiansPerDegree;
  ScanBeams beams = alike(2000);
  beams.directions.assign(2000, { std::cos(angle), 0.0, -std::sin(angle) });
  for (const bool constraint : { false, true })
  {
    EchoSettings settings = noisySettings();
    settings.lightEnergyConstraint = constraint;
    const ScanSetup setup = makeSetup(scene, sensor, settings);
    for (const double energy : { 1e-15, 1e-6 })
    {
      ScanSetup faint = setup;
      faint.sensor.pulseEnergy = energy;
      finishSetup(faint);
      // Of false alarms, too: all echoes of the beam look at the same.
      const auto echoes = runScan(faint, beams).echoes;
      EXPECT_GT(echoes.size(), 0u);
      for (const Echo& echo : echoes)
      {
        EXPECT_NEAR(echo.background, 0.3 * (0.01 + 0.5 * Sun / Pi), 1e-6);
      }
    }
  }
}

TEST(Background, NoiseOfEchoesFollows)
{
  const Sensor sensor = noonSensor();
  const PhotonReceiver sky(sensor);
  for (const double kd : { 0.05, 0.9 })
  {
    const ScanSetup setup = makeSetup(plateFrom(-50.0, kd), sensor, noisySettings());
    EchoSettings quiet = noisySettings();
    quiet.noise = false;
    const ScanSetup exact = makeSetup(plateFrom(-50.0, kd), sensor, quiet);
    const Echo light = runScan(exact, oneBeam()).echoes.at(0);
    const PhotonReceiver receiver(lookingAt(sensor, light.background));
    EXPECT_NEAR(receiver.background, sky.background * light.background / Sky, 1e-6);
    const double mean = receiver.electronsPerJoule * light.energyReceived;
    double squares = 0.0;
    int count = 0;
    for (const Echo& echo : runScan(setup, alike(4000)).echoes)
    {
      if (echo.objectId >= 0 && std::fabs(echo.range - Far) < 1.0)
      {
        const double off = receiver.electronsPerJoule * echo.energyReceived - mean;
        squares += off * off;
        ++count;
      }
    }
    ASSERT_GT(count, 3900);
    // Four standard errors of a deviation.
    EXPECT_NEAR(std::sqrt(squares / count) / receiver.deviation(mean), 1.0, 4.0 / std::sqrt(8000.0))
      << kd;
  }
}

TEST(Background, BrightWallsRaiseNoMoreFalseAlarmsThanTheSky)
{
  // 2,000 beams were promised 20 false alarms a scan.
  const Sensor sensor = noonSensor();
  const auto alarmsBefore = [&](double kd)
  {
    EchoSettings settings = noisySettings();
    int alarms = 0;
    for (int seed = 0; seed < 20; ++seed)
    {
      settings.seed = seed;
      for (const Echo& echo :
        runScan(makeSetup(plateFrom(-50.0, kd), sensor, settings), alike(2000)).echoes)
      {
        alarms += echo.objectId < 0 ? 1 : 0;
      }
    }
    return alarms;
  };
  EXPECT_NEAR(alarmsBefore(0.9), 400.0, 4.0 * 20.0);
  EXPECT_LT(alarmsBefore(0.01), 40); // dark ground: the threshold stays that of the sky
}

TEST(Background, WhatFollowsIsKeptAsItIs)
{
  // Scans that keep light, and again with another seed and another sun, as fresh ones.
  ScanSeries series(noonSensor(), noisySettings(), plateFrom(0.0, 0.9), alike(300));
  for (int scan = 0; scan < 6; ++scan)
  {
    series.setup.settings.seed = scan;
    series.setup.sensor.sunAzimuth = scan < 4 ? 270.0 : 90.0;
    series.check("sun");
  }
}

TEST(NearRange, ShareByItsFormulaAndInScans)
{
  Sensor sensor = noonSensor();
  EXPECT_EQ(sensor.nearRangeShare(1e-3), 1.0);
  EchoSettings quiet = noisySettings();
  quiet.noise = false;
  const auto energy = [&](const Sensor& s, BeamSampleSource samples)
  {
    quiet.beamSamples = samples;
    return runScan(makeSetup(plateFrom(-50.0, 0.4), s, quiet), oneBeam())
      .echoes.at(0)
      .energyReceived;
  };
  Sensor near = sensor;
  near.overlapRange = 80.0;
  near.defocusRange = 60.0;
  const double share = (1.0 - std::exp(-std::pow(Far / 80.0, 2))) / (1.0 + 0.36);
  EXPECT_NEAR(near.nearRangeShare(Far), share, 1e-15);
  for (const auto samples : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    EXPECT_NEAR(energy(near, samples) / energy(sensor, samples), share, 1e-4);
  }
  EXPECT_NEAR(
    energyFromTarget(near, Far, 1.0, 0.3, 0.0) / energyFromTarget(sensor, Far, 1.0, 0.3, 0.0),
    share, 1e-12);
  EXPECT_EQ(near.nearRangeShare(0.0), 0.0);
}
