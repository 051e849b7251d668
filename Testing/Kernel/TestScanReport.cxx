// SPDX-License-Identifier: BSD-3-Clause
// What a scan says of its beams and echoes: status, ranges, standard errors, false alarms, and the
// settings it refuses.
#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

using namespace echotest;

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
    const double x = std::min(1.0, std::abs(edge) / 0.56);
    const double smaller = (std::acos(x) - x * std::sqrt(1.0 - x * x)) / Pi;
    EXPECT_NEAR(echo.labelShare, 1.0 - smaller, 0.01) << edge;
    EXPECT_EQ(echo.labelShare == 1.0, smaller == 0.0);
  }
}

TEST(ScanReport, StatusOfABeamTellsWhatBecameOfIt)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall); // near
  scene.plate(
    Vec3(0.0, 5000.0, 0.0), Vec3(300.0, 0.0, 0.0), Vec3(0.0, 0.0, 300.0), Wall); // beyond the gate
  scene.plate(
    Vec3(-100.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), { 1e-4, 0, 0 }); // dark
  scene.plate(
    Vec3(0.0, -100.0, 0.0), Vec3(5.0, 0.0, 0.0), Vec3(0.0, 0.0, 5.0), { 0.9, 0, 0 }); // bright
  ScanBeams beams;
  for (const Vec3& d :
    { Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 1, 0) })
  {
    beams.ids.push_back(beams.ids.size());
    beams.origins.push_back(Vec3(0.0));
    beams.directions.push_back(d);
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
  scene.plate(Vec3(150.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall);
  const ScanResult gated = runScan(makeSetup(scene, wide, usual()), beams);
  EXPECT_EQ(gated.reports[0].status, BeamStatus::OutsideGate);
  EXPECT_TRUE(gated.echoes.empty());
}

TEST(ScanReport, FewRaysHaveNoStandardError)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall);
  for (const int rays : { 1, 2, 7, 8 })
  {
    const Echo echo = onlyEcho(scene, openSensor(), directSettings(rays));
    EXPECT_GT(echo.energyReceived, 0.0);
    EXPECT_EQ(std::isnan(echo.energyStdError), rays < 8) << rays;
  }
}

TEST(ScanReport, FalseAlarmsComeFromEmptyUnitsOnlyWhereNoiseMatters)
{
  Scene empty;
  Sensor sensor;
  sensor.noisePhotonRate = 1e9;
  sensor.lowerEnergyLimit = 8.0 * sensor.photonEnergy(); // mean 5 photons a unit
  const ScanResult result = runScan(makeSetup(empty, sensor, usual()), horizon(4, 4), 2);
  ASSERT_GT(result.echoes.size(), 100u);
  for (const Echo& echo : result.echoes)
  {
    EXPECT_EQ(echo.objectId, -1);
    EXPECT_GT(echo.energyReceived, sensor.lowerEnergyLimit);
  }
  expectSame(result, runScan(makeSetup(empty, sensor, usual()), horizon(4, 4), 1));
}

TEST(ScanReport, ABeamAimedAtTheMiddleOfABoxMeetsItWithAnyTree)
{
  // The centres of volumes lie on the axis but for round-off.
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Scene scene;
  ScanBeams beams;
  for (int i = 0; i < 200; ++i)
  {
    const Vec3 direction = unitVector(Vec3(uniform(random), uniform(random), uniform(random)));
    const Vec3 center = (100.0 + 900.0 * i / 200.0) * direction;
    scene.box(center, Vec3(3.0), Wall, i);
    beams.ids.push_back(i);
    beams.origins.push_back(Vec3(0.0));
    beams.directions.push_back(center);
  }
  for (int volume = 0; volume < 3; ++volume)
  {
    for (const TraceMode mode : { TraceMode::Automatic, TraceMode::SingleRays, TraceMode::Beams })
    {
      EchoSettings settings = usual();
      settings.traceMode = mode;
      const TreeOptions options{ SplitRule::SurfaceAreaHeuristic,
        static_cast<BoundingVolumeType>(volume), 4 };
      const ScanResult result = runScan(makeSetup(scene, Sensor{}, settings, options), beams);
      for (const BeamReport& report : result.reports)
      {
        EXPECT_NE(report.status, BeamStatus::NoSurface) << volume << static_cast<int>(mode);
      }
    }
  }
}

TEST(ScanReport, StatusAndRangeOfTheReportDoNotDependOnWhatIsShown)
{
  // A small bright plate before a large wall: two returns, the second stronger and saturated.
  Scene scene;
  scene.plate(Vec3(50.0, 0.0, 0.0), Vec3(0.0, 0.12, 0.0), Vec3(0.0, 0.0, 0.12), { 0.3, 0, 0 });
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), { 0.3, 0, 0 });
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

TEST(ScanReport, RangesAreNeverNegative)
{
  Scene scene;
  scene.plate(Vec3(3.1, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall);
  Sensor sensor;
  sensor.pulseWidth = 100e-9;
  sensor.lowerEnergyLimit = 1e-8;
  EchoSettings settings = usual();
  settings.returnMode = ReturnMode::RangeUnits;
  const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam());
  ASSERT_GT(result.echoes.size(), 5u);
  for (const Echo& echo : result.echoes)
  {
    EXPECT_GT(echo.range, 0.0);
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

TEST(ScanReport, DetailIsMissedByAllRaysOnceInTwentyBeams)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), { 0.25, 0.0, 0.0 });
  for (const BeamSampleSource source : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    for (const auto& [number, grid] :
      { std::pair<int, double>{ 50, 1024.0 }, { 14, 64.0 }, { 200, 1024.0 }, { 400, 4096.0 } })
    {
      EchoSettings settings = directSettings(number);
      settings.beamSamples = source;
      const Sensor sensor = openSensor();
      const double share =
        makeSetup(scene, sensor, settings).needs.missedDetailEnergy / (0.25 * sensor.pulseEnergy);
      const double rays = source == BeamSampleSource::Rays ? number : Pi * grid;
      EXPECT_NEAR(std::pow(1.0 - share, rays), 0.05, 1e-9) << number;
    }
  }
}

TEST(ScanReport, SettingsThatWouldOverflowThePathsAreRefused)
{
  EchoSettings settings;
  settings.raysPerBeam = 70000;
  settings.numberOfConnections = 69999;
  EXPECT_NE(checkSettings(settings).find("NumberOfConnections"), std::string::npos);
  settings.numberOfConnections = 8;
  EXPECT_EQ(checkSettings(settings), "");
  settings.raysPerBeam = 1000000;
  EXPECT_EQ(checkSettings(settings), "");
  Sensor sensor;
  sensor.samplingInterval = 1e-21;
  sensor.pulseWidth = 9e-19;
  EXPECT_NE(checkSensor(sensor).find("range_gate"), std::string::npos);
}
