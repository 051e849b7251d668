// SPDX-License-Identifier: BSD-3-Clause
// Scans that are lit again where many paths are on the edge of what counts: towns of
// dark houses, limits and air that drop paths one after the other and bring them back.
#include "ScanSeries.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

using namespace echotest;

namespace
{
/// Sanitizers see the same limits in fewer, larger steps.
#if defined(AVIANLIDAR_SANITIZED)
constexpr int StepsAtOnce = 14;
#else
constexpr int StepsAtOnce = 1;
#endif

/// Of beams so wide that they meet several houses.
Sensor wideSensor()
{
  Sensor sensor;
  sensor.halfBeamwidth = 0.06;
  sensor.upperEnergyLimit = 1.0;
  return sensor;
}

/// The town with other materials. @param paint is called with an object, its material, and numbers
/// in [0, 1)
template <class Paint>
Scene repainted(unsigned seed, Paint paint)
{
  Scene scene = town();
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t t = 0; t < scene.materials.size(); ++t)
  {
    paint(scene.objects[t], scene.materials[t], [&]() { return uniform(random); });
  }
  return scene;
}

/// Houses so dark that the light-energy constraint drops them one after the other, beside others
/// that are perceived.
Scene darkTown()
{
  return repainted(11,
    [](int object, Material& material, const auto& uniform)
    {
      if (object % 3 == 1)
      {
        material = { std::pow(10.0, -6.0 - 5.0 * uniform()), 0.0, 1.0 };
      }
      if (object % 3 == 2)
      {
        const double gloss = std::pow(10.0, -4.0 - 5.0 * uniform());
        material = { 0.1 * gloss, gloss, 20.0 };
      }
    });
}

/// Matt houses, most of them dark: paths over two reflections are few and weak, some skipped
/// together.
Scene mattTown()
{
  return repainted(12,
    [](int object, Material& material, const auto& uniform)
    {
      const bool bright = object % 3 == 1;
      material = { bright ? 0.2 : std::pow(10.0, -4.0 - 5.0 * uniform()), 0.0, 1.0 };
    });
}
}

TEST(ScanAgainTowns, PathsThatTheLightEnergyConstraintDropsOneByOne)
{
  for (const Scene& scene : { darkTown(), mattTown() })
  {
    for (const int rays : { 8, 40 })
    {
      EchoSettings settings = usual();
      settings.raysPerBeam = rays;
      Sensor sensor = wideSensor();
      sensor.lowerEnergyLimit = 1e-10;
      ScanSeries series(sensor, settings, scene);
      for (const double step : { 1.15, 1.0 / 1.16 })
      {
        for (int i = 0; i < 70; i += StepsAtOnce)
        {
          series.setup.sensor.lowerEnergyLimit *= std::pow(step, StepsAtOnce);
          series.check(std::to_string(rays) + " rays, step " + std::to_string(i));
        }
      }
    }
  }
}

TEST(ScanAgainTowns, BeforeTheGateAndBeyond)
{
  // Dark houses before the gate are dropped while bright ones arrive beyond it: reports change
  // without an echo.
  Sensor sensor = wideSensor();
  sensor.rangeGate = 100.0;
  sensor.lowerEnergyLimit = 1e-9;
  ScanSeries series(sensor, usual(), mattTown());
  for (const double step : { 1.3, 1.0 / 1.4 })
  {
    for (int i = 0; i < 40; ++i)
    {
      series.setup.sensor.lowerEnergyLimit *= step;
      series.check("step " + std::to_string(i));
    }
  }
  const auto beyond = [&series]()
  {
    return std::count_if(series.result.reports.begin(), series.result.reports.end(),
      [](const BeamReport& report) { return report.status == BeamStatus::OutsideGate; });
  };
  EXPECT_GT(beyond(), 10);
  series.setup.sensor.upperEnergyLimit = 10.0;
  series.setup.sensor.lowerEnergyLimit = 5.0;
  series.check("nothing perceived");
}

TEST(ScanAgainTowns, AirFromNoneToFog)
{
  for (const Scene& scene : { town(), darkTown() })
  {
    ScanSeries series({}, usual(), scene);
    for (const double attenuation :
      { 0.0, 3.5e-5, 1e-3, 8.8e-4, 0.02, 0.021, 0.5, 1e-3, 1e-5, 0.0, 1e3, 3.5e-5 })
    {
      series.setup.settings.attenuationCoefficient = attenuation;
      series.check(std::to_string(attenuation));
    }
    for (double attenuation = 1e-4; attenuation < 0.2; attenuation *= 1.2)
    {
      series.setup.settings.attenuationCoefficient = attenuation;
      series.check(std::to_string(attenuation));
    }
  }
}

TEST(ScanAgainTowns, WhereNothingIsDroppedSilentBeamsAreFollowedInFull)
{
  EchoSettings settings = usual();
  settings.lightEnergyConstraint = false;
  ScanSeries series({}, settings, darkTown());
  for (const double attenuation : { 1e-3, 0.02, 0.0 })
  {
    series.setup.settings.attenuationCoefficient = attenuation;
    series.check(std::to_string(attenuation));
    for (const BeamReport& report : series.result.reports)
    {
      ASSERT_EQ(report.skipped & SkippedBeam, 0u);
      ASSERT_EQ(report.lost, 0.0);
    }
  }
}

TEST(ScanAgainTowns, AirAndLimitsAtRandom)
{
  Scene bright = town();
  std::fill(bright.materials.begin(), bright.materials.end(), Material{ 0.95, 0.0, 1.0 });
  Scene mirrors = town();
  for (std::size_t t = 0; t < mirrors.materials.size(); t += 2)
  {
    mirrors.materials[t] = { 1e-6, 0.9, 1e5 };
  }
  for (const Scene& scene : { darkTown(), bright, mirrors })
  {
    for (const int rays : { 6, 40 })
    {
      std::mt19937_64 random(rays);
      std::uniform_real_distribution<double> uniform(0.0, 1.0);
      EchoSettings settings = usual();
      settings.raysPerBeam = rays;
      settings.numberOfConnections = rays == 6 ? 1 : 8;
      ScanSeries series(wideSensor(), settings, scene);
      for (int step = 0; step < 60; step += StepsAtOnce)
      {
        Sensor& sensor = series.setup.sensor;
        double& attenuation = series.setup.settings.attenuationCoefficient;
        const bool small = uniform(random) < 0.5;
        attenuation = small ? attenuation * (0.9 + 0.2 * uniform(random))
                            : std::pow(10.0, -5.0 * uniform(random));
        if (uniform(random) < 0.3)
        {
          sensor.lowerEnergyLimit = std::pow(10.0, -5.0 - 6.0 * uniform(random));
        }
        series.check(std::to_string(rays) + " rays, step " + std::to_string(step));
      }
    }
  }
}
