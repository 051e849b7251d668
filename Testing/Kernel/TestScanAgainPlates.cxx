// SPDX-License-Identifier: BSD-3-Clause
// Scans that are lit again where a few plates make a conclusion from the run before
// wrong: paths once dropped, cut, or not traced that count in other air and under other limits.
#include "ScanSeries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

using namespace echotest;

namespace
{
/// Of beams half a radian wide about the mirror and its image.
Sensor mirrorSensor()
{
  Sensor sensor;
  sensor.halfBeamwidth = 0.5;
  sensor.pulseWidth = 0.0;
  sensor.lowerEnergyLimit = 0.0;
  sensor.upperEnergyLimit = 1e3;
  return sensor;
}

/// No noise at any Qlow, no air.
EchoSettings quiet(int rays, int connections = 0)
{
  EchoSettings settings = usual();
  settings.raysPerBeam = rays;
  settings.numberOfConnections = connections;
  settings.attenuationCoefficient = 0.0;
  settings.noise = false;
  return settings;
}

/// A surface 20 m away that reflects towards a wall 11 m beside it, at which the lidar looks
/// askance: the way by the mirror is some 54 m long, there and back to the wall directly 46 m.
Scene mirrorAndWall(const Material& mirror)
{
  Scene scene;
  scene.plate(Vec3(20.0, -5.0, 0.0), Vec3(3.36, 2.17, 0.0), Vec3(0.0, 0.0, 6.0), mirror, 1);
  scene.plate(Vec3(22.0, 6.0, 0.0), Vec3(4.0, 0.0, 0.0), Vec3(0.0, 0.0, 8.0), { 0.3, 0.0, 1.0 }, 2);
  return scene;
}

std::vector<double> strongestOf(const ScanResult& result)
{
  std::vector<double> energies(result.reports.size(), 0.0);
  for (std::size_t e = 0; e < result.echoes.size(); ++e)
  {
    double& energy = energies[result.beamOfEcho[e]];
    energy = std::max(energy, result.echoes[e].energyReceived);
  }
  return energies;
}

/// From air in which nothing is perceived to other air, with Qlow just below what each of the beams
/// receives there: what was concluded from the first must not keep it silent.
void expectHeardInOtherAir(ScanSeries& series, double first, double second)
{
  series.setup.settings.attenuationCoefficient = second;
  series.setup.sensor.lowerEnergyLimit = 0.0;
  series.check("energies");
  const std::vector<double> energies = strongestOf(series.result);
  for (std::size_t b = 0; b < energies.size(); ++b)
  {
    series.setup.settings.attenuationCoefficient = first;
    series.setup.sensor.lowerEnergyLimit = 1e3;
    series.check("silence");
    ASSERT_TRUE(series.result.echoes.empty());
    series.setup.settings.attenuationCoefficient = second;
    series.setup.sensor.lowerEnergyLimit = energies[b] * (1.0 - 1e-6);
    series.check("beam " + std::to_string(b));
    ASSERT_TRUE(energies[b] == 0.0 || series.result.reports[b].status == BeamStatus::Echo);
  }
}
}

TEST(ScanAgainPlates, DroppedPathsCountAgainUnderALowerLimit)
{
  // Two plates in two range units, each below Qlow, and beside the stronger one a surface so dark
  // that its rays are dropped under the higher limit.
  Sensor sensor = mirrorSensor();
  sensor.halfBeamwidth = 0.05;
  EchoSettings settings = quiet(40);
  settings.numberOfReflections = 1;
  settings.beamSamples = BeamSampleSource::Rays;
  Scene scene;
  const Vec3 across(0.0, 10.0, 0.0);
  scene.plate(Vec3(50.0, -10.0, -9.0), across, Vec3(0.0, 0.0, 10.0), { 0.5, 0.0, 1.0 }, 1);
  scene.plate(Vec3(50.0, -10.0, 11.0), across, Vec3(0.0, 0.0, 10.0), { 1.4e-4, 0.0, 1.0 }, 2);
  scene.plate(Vec3(60.0, 0.0, 0.0), across, Vec3(0.0, 0.0, 10.0), { 0.3, 0.0, 1.0 }, 3);
  ScanSeries series(sensor, settings, scene, alike(1));
  const double energy = strongestOf(series.result)[0];
  series.setup.sensor.lowerEnergyLimit = 1.5 * energy;
  series.check("dropped");
  ASSERT_GT(series.result.reports[0].lost, 2e-5 * energy);
  series.setup.sensor.lowerEnergyLimit = (1.0 - 1e-5) * energy;
  series.check("counted");
  EXPECT_EQ(series.result.echoes.size(), 1u);
}

TEST(ScanAgainPlates, PathsOverTwoReflectionsGainMoreThanAllHitsWhereAirClears)
{
  EchoSettings settings = quiet(16);
  settings.lightEnergyConstraint = false;
  ScanSeries series(mirrorSensor(), settings, mirrorAndWall({ 1e-6, 0.9, 1e5 }), alike(12));
  expectHeardInOtherAir(series, 0.1, 0.01);
}

TEST(ScanAgainPlates, PathsThatWereCutToTheBudgetLoseNothingInDenserAir)
{
  // Walls in a corner, so bright that connections use up the budget; one to each ray, and some
  // within a stratum of two rays, which weigh more than the mean.
  Sensor sensor = mirrorSensor();
  sensor.halfBeamwidth = 0.05;
  sensor.samplingInterval = 1e-3;
  sensor.rangeGate = 1e6;
  EchoSettings settings = quiet(6, 1);
  settings.lightEnergyConstraint = false;
  Scene scene;
  for (const double side : { -1.0, 1.0 })
  {
    scene.plate(Vec3(191.0, side * 6.0, 0.0), Vec3(9.0, -side * 6.0, 0.0), Vec3(0.0, 0.0, 20.0),
      { 0.95, 0.0, 1.0 }, 1);
  }
  ScanSeries series(sensor, settings, scene, alike(40));
  expectHeardInOtherAir(series, 8e-4, 9.6e-4);
}

TEST(ScanAgainPlates, PathsNotYetTracedArriveUnderALowerLimit)
{
  // What mirrors up leads nowhere, but keeps all paths together from being skipped; the faint gloss
  // of the other surface is traced under a lower limit, and arrives.
  Sensor sensor = mirrorSensor();
  sensor.samplingInterval = 1e-3;
  sensor.rangeGate = 1e6;
  sensor.lowerEnergyLimit = 2e-5;
  Scene scene = mirrorAndWall({ 0.1, 1e-6, 1e5 });
  scene.plate(Vec3(20.0, 0.0, 8.5), Vec3(0.0, 8.0, 0.0), Vec3(2.0, 0.0, 2.0), { 0.1, 0.5, 1e5 }, 3);
  ScanSeries series(sensor, quiet(40), scene, alike(4));
  for (int i = 0; i < 60; ++i)
  {
    series.setup.sensor.lowerEnergyLimit /= 1.2;
    series.check("step " + std::to_string(i));
  }
}

TEST(ScanAgainPlates, WhatIsKnownOfPathsDoesNotChangeTheReport)
{
  // The mirror is so dark from ahead that its direct echoes are dropped; what comes back by the
  // wall arrives beyond the gate.
  for (const int rays : { 1, 2, 3 })
  {
    Sensor sensor = mirrorSensor();
    sensor.rangeGate = 24.0;
    sensor.lowerEnergyLimit = 1e-3;
    ScanSeries series(sensor, quiet(rays), mirrorAndWall({ 1e-12, 0.9, 1e5 }), alike(40));
    for (const double step : { 0.8, 1.3 })
    {
      for (int i = 0; i < 30; ++i)
      {
        series.setup.sensor.lowerEnergyLimit *= step;
        series.check(std::to_string(rays) + " rays, step " + std::to_string(i));
      }
    }
  }
}

TEST(ScanAgainPlates, WhereEnergiesUnderflow)
{
  for (const bool constraint : { true, false })
  {
    for (const double gate : { 4000.0, 15.0 })
    {
      Sensor sensor = mirrorSensor();
      sensor.rangeGate = gate;
      EchoSettings settings = quiet(16);
      settings.lightEnergyConstraint = constraint;
      Scene scene = mirrorAndWall({ 1e-6, 0.9, 1e5 });
      ScanSeries series(sensor, settings, scene, alike(12));
      for (double first = 10.0; first < 22.0; first += 0.7)
      {
        series.setup.sensor.upperEnergyLimit = 1e9;
        for (const double second : { first + 0.3, first + 3.0, 5.0, 0.5 })
        {
          series.setup.settings.attenuationCoefficient = second;
          series.setup.sensor.lowerEnergyLimit = 0.0;
          series.check("energies");
          const double energy = strongestOf(series.result)[3];
          series.setup.settings.attenuationCoefficient = first;
          series.setup.sensor.lowerEnergyLimit = 1e8;
          series.check("first");
          series.setup.settings.attenuationCoefficient = second;
          for (const double limit : { energy * (1.0 - 1e-6), 1e-322, 1e8 })
          {
            series.setup.sensor.lowerEnergyLimit = limit;
            series.check(
              "from " + std::to_string(first) + " to " + std::to_string(second) + " per m");
          }
        }
      }
    }
  }
}
