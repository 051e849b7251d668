// SPDX-License-Identifier: BSD-3-Clause
// Thresholds and energies of the preset Paper at the extremes. Its hits and scales are
// TestStabilityCoordinates'.
#include "StabilityScenes.h"
#include "StabilityTable.h"

#include "SameEchoes.h"
#include "SecondaryTestScene.h"

#include <gtest/gtest.h>

using namespace echotest;
using namespace stability;

TEST(StabilityPaper, ThresholdsOfAnySize)
{
  // A threshold drops what is below it, so light only grows as the limit falls; with a limit of 0
  // all of it is there.
  Worst gained;
  std::size_t unlike = 0;
  for (const LightEnergyThreshold threshold : Readings)
  {
    for (const int rays : { 1, 2, 100, 10000 })
    {
      EchoSettings settings = paper(threshold);
      settings.raysPerBeam = rays;
      Sensor sensor = intoTheCorner();
      sensor.lowerEnergyLimit = 0.0;
      EchoSettings without = settings;
      without.lightEnergyConstraint = false;
      const ScanResult all = runScan(makeSetup(corner(), sensor, without, PaperTree), oneBeam());
      unlike +=
        differingEchoes(all, runScan(makeSetup(corner(), sensor, settings, PaperTree), oneBeam()));
      double before = secondaryOf(all);
      ASSERT_TRUE(before > 0.0 || rays < 100);
      for (double limit = 1e-40; limit < 1e-3; limit *= 10.0)
      {
        sensor.lowerEnergyLimit = limit;
        const double now =
          secondaryOf(runScan(makeSetup(corner(), sensor, settings, PaperTree), oneBeam()));
        gained.see(now - before * (1.0 + 1e-12));
        before = now;
      }
    }
  }
  record({ "Preset Paper: threshold", "1 to 10,000 rays, limits Qlow and Qlow/N, Qlow = 0", "paper",
    "echoes unlike those without the light-energy constraint", 0.0, static_cast<double>(unlike) });
  record({ "Preset Paper: threshold", "1 to 10,000 rays, limits Qlow and Qlow/N, Qlow to 1e-3 J",
    "paper", "energy after two reflections gained as the limit rises, J", 0.0, gained.value() });
}

TEST(StabilityPaper, EnergiesOfAnyBeamwidthAndDistance)
{
  Worst deviation;
  for (const double t : { 1e-9, 1e-6, 5.6e-3, 0.1, 0.9 })
  {
    for (const double distance : { 1e-3, 1.0, 1e3, 1e6 })
    {
      EchoSettings settings = paper(LightEnergyThreshold::LimitPerRay);
      settings.attenuationCoefficient = 0.0;
      Sensor sensor = openSensor(t);
      sensor.samplingInterval = 4.0 * distance; // all in one range unit
      sensor.pulseWidth = 0.0;
      sensor.rangeGate = 1e9 * distance;
      const ScanResult result =
        runScan(makeSetup(wall(distance), sensor, settings, PaperTree), oneBeam());
      ASSERT_EQ(result.echoes.size(), 1u);
      const double right = energyOfWall(t);
      const Echo& echo = result.echoes[0];
      deviation.see(std::fabs(echo.energyReceived - right) / (echo.energyStdError + 1e-12 * right));
    }
  }
  record({ "Preset Paper: half-beamwidth", "1e-9 to 0.9 rad, wall at 1e-3 to 1e6 m, 100 rays",
    "paper", "deviation from the closed form, in stated standard errors", 5.0, deviation.value() });
}
