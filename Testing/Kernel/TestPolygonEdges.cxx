// SPDX-License-Identifier: BSD-3-Clause
// Integrated beams: nothing wrong at an edge, and what very many rays see.
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <map>

using namespace echotest;
using geometrytest::Numbers;

TEST(PolygonEdges, AWallWhoseEdgeJustEntersTheBeam)
{
  // The edge lies at 1 - depth half-beamwidths from the axis.
  double whole = 0.0; // of a wall whose edge is far outside
  for (const double depth : { -1e3, -1e-1, -1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-8,
         1e-7, 1e-6, 1e-4, 1e-2, 1e-1 })
  {
    Scene scene;
    const double edge = 100.0 * std::tan(5.6e-3) * (1.0 - depth);
    scene.plate(Vec3(100.0, edge - 600.0, 0.0), Vec3(0.0, 600.0, 0.0), Vec3(0.0, 0.0, 20.0),
      { 0.146, 0.0, 0.0 });
    const ScanResult result = runScan(makeSetup(scene, openSensor(), inCells(100)), oneBeam());
    ASSERT_TRUE(isIntegrated(result));
    ASSERT_EQ(result.echoes.size(), 1u);
    // The segment beyond the edge.
    const double outside = statistics::shareBeyond(1.0 - depth);
    const double energy = result.echoes[0].energyReceived;
    whole = whole > 0.0 ? whole : energy;
    EXPECT_NEAR(energy / whole, 1.0 - outside, 1e-5) << depth;
  }
}

TEST(PolygonEdges, ScenesOfBoxes)
{
  // Range units, pulses and profiles of every kind; whatever is integrated is what 20,000 rays see.
  Numbers random(5);
  int integrated = 0;
  for (int k = 0; k < 150; ++k)
  {
    Scene scene;
    for (int box = 0; box < 4; ++box)
    {
      const Vec3 half(random(0.5, 8.0), random(0.5, 8.0), random(0.5, 8.0));
      const Material materials[] = { Wall, Glass, Metal, Wood };
      scene.box(Vec3(random(15.0, 80.0), random(-10.0, 10.0), random(-10.0, 10.0)), half,
        materials[random.index(4)], box);
    }
    Sensor sensor = openSensor(random.logUniform(1e-3, 0.1));
    sensor.samplingInterval = random.logUniform(2e-10, 1e-7);
    sensor.pulseWidth = sensor.samplingInterval * random(0.0, 3.0);
    sensor.beamProfile = k % 3 == 0 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    EchoSettings settings = integrating();
    settings.returnMode = ReturnMode::RangeUnits;
    settings.attenuationCoefficient = 1e-3;
    settings.numberOfReflections = 2;
    settings.reflectanceModel = static_cast<ReflectanceModel>(random.index(4));
    ScanSetup setup = makeSetup(scene, sensor, settings);
    const ScanBeams beam = oneBeam(Vec3(1.0, random(-0.25, 0.25), random(-0.25, 0.25)));
    const ScanResult one = runScan(setup, beam);
    if (!isIntegrated(one))
    {
      continue;
    }
    ++integrated;
    setup.settings.beamSamples = BeamSampleSource::Rays;
    setup.settings.raysPerBeam = 20000;
    const ScanResult two = runScan(setup, beam);
    std::map<double, const Echo*> sampled;
    double energy = 0.0;
    double errors = 0.0;
    for (const Echo& echo : two.echoes)
    {
      sampled[echo.range] = &echo;
      energy += echo.energyReceived;
      errors += echo.energyStdError;
    }
    double sum = 0.0;
    for (const Echo& echo : one.echoes)
    {
      sum += echo.energyReceived;
      const auto at = sampled.find(echo.range);
      const double other = at == sampled.end() ? 0.0 : at->second->energyReceived;
      const double error = at == sampled.end() ? 0.0 : at->second->energyStdError;
      // A unit that no ray reached, or few, has 1e-4 of the beam at most.
      EXPECT_NEAR(echo.energyReceived, other, 5.0 * error + echo.energyStdError + 2e-4 * energy)
        << k;
    }
    EXPECT_NEAR(sum, energy, 5e-3 * energy + 5.0 * errors) << k;
  }
  EXPECT_GE(integrated, 50);
}
