// SPDX-License-Identifier: BSD-3-Clause
// Standard errors of beams in cells. Oracles: one plate, polygons, many seeds.
#include "CellTestScene.h"

#include <cmath>

using namespace celltest;

namespace
{
double meanOf(const ScanResult& result)
{
  return receivedFrom(result) / static_cast<double>(result.echoes.size());
}

/// How far the echoes of like beams are from a value, beside the standard errors that they state.
struct Spread
{
  double within = 0.0; ///< share of the echoes within two stated errors
  double rms = 0.0;    ///< J
  double stated = 0.0; ///< J, rms
};

Spread spreadAbout(const ScanResult& result, double truth)
{
  Spread spread;
  const double share = 1.0 / static_cast<double>(result.echoes.size());
  for (const Echo& echo : result.echoes)
  {
    const double off = echo.energyReceived - truth;
    spread.within += std::fabs(off) <= 2.0 * echo.energyStdError ? share : 0.0;
    spread.rms += share * off * off;
    spread.stated += share * echo.energyStdError * echo.energyStdError;
  }
  spread.rms = std::sqrt(spread.rms);
  spread.stated = std::sqrt(spread.stated);
  return spread;
}
}

TEST(CellErrors, LobesAreInTheStandardError)
{
  for (const double exponent : { 1e5, 1e6 })
  {
    const Material shiny{ 0.0005, 0.9, exponent };
    Scene plate;
    plate.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.004, 4.0, 0.0), Vec3(0.003, 0.0, 4.0), shiny, 1);
    Scene parts;
    fine(parts, Vec3(100.0, 0.0, 0.0), Vec3(0.004, 4.0, 0.0), Vec3(0.003, 0.0, 4.0), 60, shiny, 1);
    const double truth = received(plate, openSensor(), directSettings(1000000));
    const Spread spread =
      spreadAbout(runScan(makeSetup(parts, openSensor(), inCells()), alike(24)), truth);
    EXPECT_LT(spread.rms, 2.0 * spread.stated + 1e-3 * truth) << exponent;
    EXPECT_LT(spread.stated, 0.05 * truth) << exponent;
  }
}

TEST(CellErrors, WhatIsHiddenChangesNoMoreThanTheStatedError)
{
  // A box and a wall are integrated; what is hidden behind the wall makes cells of the beam, with
  // lists of surfaces or with rays through the tree.
  for (const int parts : { 20, 70 })
  {
    Numbers random(41);
    int beyond = 0;
    int farBeyond = 0;
    constexpr int beams = 300;
    for (int k = 0; k < beams; ++k)
    {
      Scene scene;
      scene.box(Vec3(60.0, random(-0.2, 0.2), random(-0.2, 0.2)),
        Vec3(0.02, random(0.003, 0.1), random(0.003, 0.1)), Matt, 2);
      scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.9, 2.0, 0.0), Vec3(0.3, 0.0, 2.0), Wall, 1);
      EchoSettings settings = inCells(100, k);
      settings.returnMode = ReturnMode::First;
      Sensor sensor = openSensor();
      sensor.samplingInterval = 5e-8;
      const Echo before = onlyEcho(scene, sensor, settings);
      fine(scene, Vec3(120.0, 0.0, 0.0), Vec3(0.9, 1.0, 0.0), Vec3(0.3, 0.0, 1.0), parts, Matt, 3);
      const Echo after = onlyEcho(scene, sensor, settings);
      const double off = std::fabs(after.energyReceived - before.energyReceived);
      const double stated = after.energyStdError + before.energyStdError;
      beyond += off > stated ? 1 : 0;
      farBeyond += off > 2.0 * stated ? 1 : 0;
    }
    EXPECT_LE(beyond, beams / 4) << parts; // of a normal distribution a third would be
    EXPECT_LE(farBeyond, beams / 50) << parts;
  }
}

TEST(CellErrors, HalvesOfUnlikeMaterialsHaveAnError)
{
  // A plate before many others, one half of it dark: rays of the grid fall on either side of its
  // diagonal in one range unit.
  Scene scene = fineWall(40);
  scene.plate(Vec3(90.0, 0.1, 0.0), Vec3(0.0, 2.0, 0.3), Vec3(0.0, 0.0, 2.0), Matt, 1);
  scene.materials.back() = { 0.02, 0.0, 1.0 };
  const ScanResult result = runScan(makeSetup(scene, openSensor(), inCells()), alike(200));
  ASSERT_EQ(result.echoes.size(), 200u);
  const Spread spread = spreadAbout(result, meanOf(result));
  EXPECT_GT(spread.within, 0.9);
  EXPECT_LT(spread.stated, 6.0 * spread.rms);
}

TEST(CellErrors, TheGaussianProfileOfAPlateHasAnError)
{
  // One surface fills the beam in one range unit: weights differ by where the rays fall.
  Scene scene = fineWall(40);
  scene.square(Vec3(90.0, 0.0, 0.0), 2.0, Matt, 1);
  Sensor sensor = openSensor();
  sensor.beamProfile = BeamProfile::Gaussian;
  Scene plate = squareAt(90.0, 2.0, Matt, 1);
  const double truth = received(plate, sensor, inCells());
  for (const int rays : { 10, 100, 400 })
  {
    const Spread spread =
      spreadAbout(runScan(makeSetup(scene, sensor, inCells(rays)), alike(150)), truth);
    EXPECT_GT(spread.within, 0.95) << rays;
    EXPECT_LT(spread.stated, 5.0 * spread.rms) << rays;
  }
}

TEST(CellErrors, WhatNoRayMeetsIsPartOfTheStandardError)
{
  // A black patch of the wall's own object, smaller than what a ray stands for, before a bright
  // wall.
  const Sensor sensor = openSensor();
  const double half = 0.002;
  Scene plain = squareAt(100.0, 2.0, Matt, 1);
  const double bright = received(plain, sensor, inCells());
  const double lost = sensor.pulseEnergy * Matt.kd * 4.0 * half * half * 4.0 /
    (100.0 * 100.0 * 2.0 * Pi * (1.0 - std::cos(sensor.halfBeamwidth)));
  Numbers random(31);
  int within = 0;
  int missed = 0;
  constexpr int beams = 200;
  for (int k = 0; k < beams; ++k)
  {
    Scene scene = fineWall(30); // one plate hides what makes cells of the beam
    scene.square(Vec3(99.0, 0.0, 0.0), 2.0, Matt, 1);
    scene.square(Vec3(50.0, random(-0.15, 0.15), random(-0.15, 0.15)), half, { 0.0, 0.0, 1.0 }, 1);
    const Echo echo = onlyEcho(scene, sensor, inCells());
    const double off = std::fabs(echo.energyReceived - (bright - lost));
    missed += echo.energyReceived > bright - 0.1 * lost;
    within += off <= 2.0 * echo.energyStdError;
  }
  EXPECT_GT(missed, beams / 4);
  EXPECT_GE(within, 0.95 * beams) << missed;
}

TEST(CellErrors, ConnectionsInABrightCornerAreMostlyWithinTheirErrors)
{
  // Two walls of albedo 0.8 that meet in the beam. Few connections, close to the corner, carry
  // most.
  Scene scene = fineWall(40, Vec3(0.0, 2.0, 0.0));
  const Material bright{ 0.8, 0.0, 1.0 };
  scene.plate(Vec3(91.0, 1.0, 0.0), Vec3(1.0, -1.0, 0.0), Vec3(0.0, 0.0, 2.0), bright, 1);
  scene.plate(Vec3(91.0, -1.0, 0.0), Vec3(1.0, 1.0, 0.0), Vec3(0.0, 0.0, 2.0), bright, 2);
  EchoSettings settings = inCells();
  settings.numberOfReflections = 2;
  const ScanResult result = runScan(makeSetup(scene, openSensor(), settings), alike(1000));
  ASSERT_EQ(result.echoes.size(), 1000u);
  EXPECT_GT(spreadAbout(result, meanOf(result)).within, 0.94);
}
