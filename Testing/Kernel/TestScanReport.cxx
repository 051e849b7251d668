// SPDX-License-Identifier: BSD-3-Clause
// What a scan says of its beams and echoes: labels, status, ranges, standard errors, and the
// settings it refuses.
#include "GeometryTestScene.h"
#include "ScanTestTown.h"
#include "SecondaryTestScene.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <map>

using namespace echotest;
using geometrytest::Numbers;

TEST(ScanReport, TheLabelIsThatOfTheLargestShare)
{
  // Two plates side by side, before a beam of 0.56 m of radius: their edge cuts off a part of it.
  for (const double edge : { -1.0, -0.2, 0.2, 1.0 })
  {
    Scene scene;
    const Vec3 up(0.0, 0.0, 5.0);
    scene.plate(Vec3(100.0, edge + 5.0, 0.0), Vec3(0.0, 5.0, 0.0), up, { 0.3, 0.0, 1.0 }, 1);
    scene.plate(Vec3(100.0, edge - 5.0, 0.0), Vec3(0.0, 5.0, 0.0), up, { 0.3, 0.0, 1.0 }, 2);
    const Echo echo = onlyEcho(scene, openSensor(), directSettings(2000));
    EXPECT_EQ(echo.objectId, edge > 0.0 ? 2 : 1);
    const double smaller = statistics::shareBeyond(std::abs(edge) / 0.56);
    EXPECT_NEAR(echo.labelShare, 1.0 - smaller, 0.01) << edge;
    EXPECT_EQ(echo.labelShare == 1.0, smaller == 0.0);
  }
}

TEST(ScanReport, StatusOfABeamTellsWhatBecameOfIt)
{
  Scene scene;
  scene.square(Vec3(100.0, 0.0, 0.0), 5.0, Wall); // near
  scene.plate(
    Vec3(0.0, 5000.0, 0.0), Vec3(300.0, 0.0, 0.0), Vec3(0.0, 0.0, 300.0), Wall); // beyond the gate
  scene.square(Vec3(-100.0, 0.0, 0.0), 5.0, { 1e-4, 0, 0 });                     // dark
  scene.plate(
    Vec3(0.0, -100.0, 0.0), Vec3(5.0, 0.0, 0.0), Vec3(0.0, 0.0, 5.0), { 0.9, 0, 0 }); // bright
  ScanBeams beams;
  for (const Vec3& d :
    { Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 1, 0) })
  {
    addBeam(beams, d);
  }
  const ScanResult result = runScan(makeSetup(scene, Sensor{}, usual()), beams);
  const BeamStatus expected[] = { BeamStatus::Saturated, BeamStatus::NoSurface,
    BeamStatus::BelowLimit, BeamStatus::Saturated, BeamStatus::OutsideGate };
  for (int i = 0; i < 5; ++i)
  {
    EXPECT_EQ(result.reports[i].status, expected[i]) << i;
  }
  Sensor wide;
  wide.upperEnergyLimit = 1e-3;
  const ScanResult unclamped = runScan(makeSetup(scene, wide, usual()), beams);
  EXPECT_EQ(unclamped.reports[0].status, BeamStatus::Echo);
  EXPECT_NEAR(unclamped.reports[0].range, 100.0, 1e-2);
  EXPECT_TRUE(std::isnan(unclamped.reports[1].range));
  // What is nearer than the minimum range hides what is behind, and is no echo.
  wide.minimumRange = 100.1;
  scene.square(Vec3(150.0, 0.0, 0.0), 5.0, Wall);
  const ScanResult gated = runScan(makeSetup(scene, wide, usual()), beams);
  EXPECT_EQ(gated.reports[0].status, BeamStatus::OutsideGate);
  EXPECT_TRUE(gated.echoes.empty());
}

TEST(ScanReport, StatusAndRangeOfTheReportDoNotDependOnWhatIsShown)
{
  // A small bright plate before a large wall: two returns, the second stronger and saturated.
  Scene scene = squareAt(50.0, 0.12, { 0.3, 0, 0 });
  scene.square(Vec3(100.0, 0.0, 0.0), 5.0, { 0.3, 0, 0 });
  Sensor sensor;
  sensor.upperEnergyLimit = 3e-5;
  for (ReturnMode mode :
    { ReturnMode::All, ReturnMode::First, ReturnMode::Last, ReturnMode::Strongest })
  {
    EchoSettings settings = usual();
    settings.returnMode = mode;
    const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam());
    EXPECT_EQ(result.echoes.size(), mode == ReturnMode::All ? 2u : 1u);
    EXPECT_EQ(result.reports[0].status, BeamStatus::Saturated);
    EXPECT_NEAR(result.reports[0].range, 100.0, 0.01);
  }
}

TEST(ScanReport, StandardErrorsHoldWhereAPlaneSpreadsOverRangeUnits)
{
  // The borders of a range unit cut the plane like edges.
  constexpr int rays = 100;
  constexpr int seeds = 1500;
  for (double alpha : { 50.0, 80.0 })
  {
    Scene scene;
    const Vec3 along(std::sin(alpha * Degree), std::cos(alpha * Degree), 0.0);
    scene.plate(Vec3(200.0, 0.0, 0.0), 500.0 * along, Vec3(0.0, 0.0, 500.0), { 0.146, 0, 0 });
    Sensor sensor = openSensor();
    sensor.samplingInterval = 5e-9;
    EchoSettings settings = directSettings(200000);
    settings.returnMode = ReturnMode::RangeUnits;
    std::map<int, double> truth;
    double peak = 0.0;
    for (const Echo& echo : runScan(makeSetup(scene, sensor, settings), oneBeam()).echoes)
    {
      truth[static_cast<int>(echo.range / sensor.rangeUnitLength())] = echo.energyReceived;
      peak = std::max(peak, echo.energyReceived);
    }
    settings = directSettings(rays);
    settings.returnMode = ReturnMode::RangeUnits;
    ScanSetup setup = makeSetup(scene, sensor, settings);
    int inside = 0;
    int all = 0;
    for (int seed = 1; seed <= seeds; ++seed)
    {
      setup.settings.seed = seed;
      for (const Echo& echo : runScan(setup, oneBeam()).echoes)
      {
        const double exact = truth[static_cast<int>(echo.range / sensor.rangeUnitLength())];
        if (exact > 0.5 * peak)
        {
          ++all;
          inside += std::abs(echo.energyReceived - exact) <= 1.96 * echo.energyStdError;
        }
      }
    }
    EXPECT_GT(inside, 0.93 * all) << alpha;
  }
}

TEST(ScanReport, SettingsThatWouldOverflowThePathsAreRefused)
{
  EchoSettings settings;
  settings.raysPerBeam = 1000000;
  EXPECT_EQ(checkSettings(settings), "");
  Sensor sensor;
  sensor.samplingInterval = 1e-21;
  sensor.pulseWidth = 9e-19;
  statistics::expectSays(checkSensor(sensor), "range_gate");
}

namespace
{
/// Specks that no ray meets: corners of a cube, each of three triangles that face each other.
Scene specks(int count, const Vec3& at)
{
  Scene scene;
  Numbers random(33);
  constexpr double size = 1e-5;
  for (int k = 0; k < count; ++k)
  {
    const Vec3 tip = at + Vec3(0.1 * k, random(-0.2, 0.2), random(-0.2, 0.2));
    const Vec3 rim[] = { tip + size * Vec3(-1.0, 1.0, 0.0), tip + size * Vec3(-1.0, -0.5, 0.8),
      tip + size * Vec3(-1.0, -0.5, -0.8) };
    for (int i = 0; i < 3; ++i)
    {
      scene.triangle(tip, rim[i], rim[(i + 1) % 3], Wall, k);
    }
  }
  return scene;
}
}

TEST(ScanReport, ABeamWhoseRaysMissWhatEntersItMeetsNothing)
{
  for (const BeamSampleSource source : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    for (const double limit : { 0.0, 25.0, 12.0 }) // photons, of 5 that are noise; 0: no noise
    {
      SCOPED_TRACE(testing::Message() << static_cast<int>(source) << ' ' << limit);
      EchoSettings settings = secondarySettings(40, 8, source);
      settings.noise = limit > 0.0;
      Sensor sensor;
      sensor.noisePhotonRate = 1e9;
      sensor.lowerEnergyLimit = limit * sensor.photonEnergy();
      // More triangles than may be integrated.
      const ScanSetup setup = makeSetup(specks(40, Vec3(100.0, 0.0, 0.0)), sensor, settings);
      const ScanSetup without = makeSetup(specks(40, Vec3(-100.0, 0.0, 0.0)), sensor, settings);
      const ScanResult nothing = runScan(without, oneBeam());
      EXPECT_EQ(
        nothing.reports[0].status, limit == 12.0 ? BeamStatus::Echo : BeamStatus::NoSurface);
      EXPECT_EQ(nothing.echoes.empty(), limit != 12.0);
      EXPECT_EQ(without.noise.active, limit > 0.0);
      const ScanResult missed = runScan(setup, oneBeam());
      EXPECT_EQ(missed.raysTraced, tracedRaysOf(settings));
      expectSame(missed, nothing);
      EXPECT_EQ(missed.reports[0].status, nothing.reports[0].status);
      EXPECT_TRUE(sameBits(missed.reports[0].range, nothing.reports[0].range));
      EXPECT_EQ(missed.reports[0].skipped, nothing.reports[0].skipped);
      EXPECT_EQ(missed.reports[0].lost, nothing.reports[0].lost);
    }
  }
}

TEST(ScanReport, ASpeckThatNoRayMeetsIsIntegrated)
{
  EchoSettings settings = directSettings(40);
  settings.beamSamples = BeamSampleSource::Cells;
  Sensor sensor;
  sensor.lowerEnergyLimit = 0.0;
  const ScanResult speck =
    runScan(makeSetup(specks(1, Vec3(100.0, 0.0, 0.0)), sensor, settings), oneBeam());
  EXPECT_EQ(speck.reports[0].counters.raysTraced, 0u);
  EXPECT_EQ(speck.reports[0].status, BeamStatus::Echo);
}
