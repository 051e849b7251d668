// SPDX-License-Identifier: BSD-3-Clause
// A scan is the same bits for any number of threads, order and parts of the beams, tree, and state
// of the cache; and the same to a micrometre wherever the scene stands.
#include "EchoTestScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>

using namespace echotest;

namespace
{
/// Boxes of four materials on a ground plane, about the point `at`.
Scene town(const Vec3& at = Vec3(0.0), double snap = 0.0)
{
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Material materials[] = { Wall, Glass, Metal, Wood };
  // On the grid that far coordinates have, so that moving the scene rounds nothing.
  const auto grid = [snap](double v) { return snap > 0.0 ? snap * std::round(v / snap) : v; };
  Scene scene;
  scene.plate(at + Vec3(0.0, 0.0, -2.0), Vec3(500.0, 0.0, 0.0), Vec3(0.0, 500.0, 0.0), Wall, 0);
  for (int i = 1; i <= 60; ++i)
  {
    const double angle = 2.0 * Pi * uniform(random);
    const double range = 30.0 + 250.0 * uniform(random);
    const Vec3 half(grid(2.0 + 8.0 * uniform(random)), grid(2.0 + 8.0 * uniform(random)),
      grid(3.0 + 9.0 * uniform(random)));
    const Vec3 center(
      grid(range * std::cos(angle)), grid(range * std::sin(angle)), grid(half.z - 2.0));
    scene.box(at + center, half, materials[i % 4], i);
  }
  return scene;
}

ScanBeams horizon(int columns, int channels, const Vec3& origin = Vec3(0.0))
{
  ScanBeams beams;
  for (int i = 0; i < columns * channels; ++i)
  {
    const double azimuth = 2.0 * Pi * (i / channels) / columns;
    const double elevation = Degree * (i % channels);
    beams.ids.push_back(i);
    beams.origins.push_back(origin);
    beams.directions.push_back(Vec3(std::sin(azimuth) * std::cos(elevation),
      std::cos(azimuth) * std::cos(elevation), std::sin(elevation)));
  }
  return beams;
}

bool sameBits(double a, double b)
{
  return std::memcmp(&a, &b, sizeof(double)) == 0;
}

void expectSame(const ScanResult& a, const ScanResult& b)
{
  ASSERT_EQ(a.echoes.size(), b.echoes.size());
  for (std::size_t i = 0; i < a.echoes.size(); ++i)
  {
    const Echo& x = a.echoes[i];
    const Echo& y = b.echoes[i];
    ASSERT_TRUE(sameBits(x.range, y.range) && sameBits(x.energyReceived, y.energyReceived) &&
      sameBits(x.energy, y.energy) && sameBits(x.returnEnergy, y.returnEnergy) &&
      sameBits(x.energyStdError, y.energyStdError) && sameBits(x.labelShare, y.labelShare) &&
      sameBits(x.incidenceAngle, y.incidenceAngle) &&
      sameBits(x.secondaryShare, y.secondaryShare) && x.objectId == y.objectId &&
      x.materialId == y.materialId && x.returnNumber == y.returnNumber &&
      x.numberOfReturns == y.numberOfReturns)
      << "echo " << i;
    ASSERT_EQ(a.beamOfEcho[i], b.beamOfEcho[i]);
  }
}

EchoSettings usual()
{
  EchoSettings settings;
  settings.raysPerBeam = 40;
  return settings;
}
}

TEST(Scan, AnyNumberOfThreadsGivesTheSameBits)
{
  const ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  const ScanBeams beams = horizon(180, 4);
  const ScanResult one = runScan(setup, beams, 1);
  ASSERT_GT(one.echoes.size(), 100u);
  for (int threads : { 2, 3, 7 })
  {
    expectSame(one, runScan(setup, beams, threads));
  }
}

TEST(Scan, AnyOrderAndAnyPartsOfTheBeamsGiveTheSameBits)
{
  const ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  const ScanBeams beams = horizon(180, 4);
  const ScanResult whole = runScan(setup, beams);
  std::vector<std::size_t> order(beams.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    order[i] = i;
  }
  std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
  for (std::size_t parts : { 1, 2, 5 })
  {
    // Every part by itself; then put back in the order of the beam ids.
    std::vector<std::pair<std::uint64_t, Echo>> all;
    for (std::size_t part = 0; part < parts; ++part)
    {
      ScanBeams some;
      for (std::size_t i = part; i < order.size(); i += parts)
      {
        some.ids.push_back(beams.ids[order[i]]);
        some.origins.push_back(beams.origins[order[i]]);
        some.directions.push_back(beams.directions[order[i]]);
      }
      const ScanResult result = runScan(setup, some, 2);
      for (std::size_t i = 0; i < result.echoes.size(); ++i)
      {
        all.emplace_back(some.ids[result.beamOfEcho[i]], result.echoes[i]);
      }
    }
    std::stable_sort(
      all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    ScanResult sorted;
    for (const auto& [id, echo] : all)
    {
      sorted.echoes.push_back(echo);
      sorted.beamOfEcho.push_back(id);
    }
    expectSame(whole, sorted);
  }
}

TEST(Scan, AnyTreeGivesTheSameBits)
{
  const Scene scene = town();
  const ScanBeams beams = horizon(90, 4);
  const ScanResult reference = runScan(makeSetup(scene, Sensor{}, usual()), beams);
  for (int rule = 0; rule < 4; ++rule)
  {
    for (int volume = 0; volume < 3; ++volume)
    {
      for (int leaf : { 1, 16 })
      {
        const TreeOptions options{ static_cast<SplitRule>(rule),
          static_cast<BoundingVolumeType>(volume), leaf };
        expectSame(reference, runScan(makeSetup(scene, Sensor{}, usual(), options), beams));
      }
    }
  }
}

TEST(Scan, ALitAgainScanIsAFreshOneBitForBit)
{
  const Scene scene = town();
  const ScanBeams beams = horizon(120, 4);
  ScanSetup setup = makeSetup(scene, Sensor{}, usual());
  TraceCache cache;
  ScanResult result;
  ASSERT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
  EXPECT_GT(result.raysTraced, 0u);
  const auto check = [&](bool mayTrace)
  {
    finishSetup(setup);
    ASSERT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
    expectSame(result, runScan(setup, beams));
    if (!mayTrace)
    {
      EXPECT_EQ(result.raysTraced, 0u);
    }
  };
  check(false);
  setup.settings.attenuationCoefficient = 1e-3;
  check(false);
  setup.sensor.upperEnergyLimit = 2e-5;
  setup.settings.returnMode = ReturnMode::Strongest;
  check(false);
  setup.sensor.pulseWidth = 20e-9;
  setup.settings.reflectanceModel = ReflectanceModel::Microfacet;
  check(true); // another model may light paths that the constraint had pruned
  setup.settings.lightEnergyConstraint = false;
  check(true);
  for (Material& m : setup.materials)
  {
    m = Glass;
  }
  check(false); // now everything is known
  setup.settings.numberOfConnections = 3;
  check(true);
  setup.settings.raysPerBeam = 41;
  check(true);
  setup.settings.seed = 5;
  check(true);
}

TEST(Scan, ACacheThatIsTooSmallChangesNothing)
{
  const ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  const ScanBeams beams = horizon(120, 4);
  TraceCache cache;
  ScanResult result;
  for (std::size_t bytes : { std::size_t(0), std::size_t(200000) })
  {
    for (int run = 0; run < 2; ++run)
    {
      ASSERT_TRUE(simulateScan(setup, beams, 2, cache, bytes, {}, result));
      expectSame(result, runScan(setup, beams));
      EXPECT_LE(cache.bytes(), bytes + beams.size() * sizeof(BeamTrace));
    }
  }
}

TEST(Scan, AbortStopsWithinABlockPerThreadAndLeavesNothing)
{
  const ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  const ScanBeams beams = horizon(360, 8);
  TraceCache cache;
  ScanResult result;
  int calls = 0;
  const auto stop = [&calls](double) { return ++calls < 5; };
  EXPECT_FALSE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, stop, result));
  EXPECT_EQ(calls, 5);
  EXPECT_TRUE(result.echoes.empty());
  EXPECT_TRUE(result.reports.empty());
  EXPECT_TRUE(cache.beams.empty());
}

TEST(Scan, AbortIsHeardWithinABeamOfManyRays)
{
  // One beam: between blocks nothing is asked before it is done.
  EchoSettings settings = usual();
  settings.raysPerBeam = 100000;
  ScanBeams beams = horizon(4, 1);
  beams.ids.resize(1);
  beams.origins.resize(1);
  beams.directions.resize(1);
  const ScanSetup setup = makeSetup(town(), Sensor{}, settings);
  TraceCache cache;
  ScanResult result;
  int calls = 0;
  const auto go = [&calls](double) { return ++calls > 0; };
  ASSERT_TRUE(simulateScan(setup, beams, 1, cache, 0, go, result));
  const int all = calls;
  EXPECT_GT(all, 20);
  calls = 0;
  const auto stop = [&calls](double) { return ++calls < 5; };
  EXPECT_FALSE(simulateScan(setup, beams, 1, cache, 0, stop, result));
  EXPECT_EQ(calls, 5);
  EXPECT_TRUE(result.echoes.empty());
  EXPECT_TRUE(cache.beams.empty());
}

TEST(Scan, ProgressRisesToOne)
{
  const ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  TraceCache cache;
  ScanResult result;
  double last = 0.0;
  int calls = 0;
  ASSERT_TRUE(simulateScan(
    setup, horizon(180, 4), 1, cache, 0,
    [&](double fraction)
    {
      EXPECT_GE(fraction, last);
      last = fraction;
      ++calls;
      return true;
    },
    result));
  EXPECT_EQ(last, 1.0);
  EXPECT_GE(calls, 45); // blocks of 16 beams
}

TEST(Scan, SceneInUtmAndEcefCoordinates)
{
  // Multiples of 2^-20 m survive the move to 6.4e6 m without rounding.
  const double snap = 1.0 / (1 << 20);
  const ScanBeams here = horizon(120, 4);
  EchoSettings settings = usual();
  for (Precision precision : { Precision::Double, Precision::Single })
  {
    settings.precision = precision;
    const ScanResult reference =
      runScan(makeSetup(town(Vec3(0.0), snap), Sensor{}, settings), here);
    ASSERT_GT(reference.echoes.size(), 50u);
    for (const Vec3& at :
      { Vec3(342000.0, 3453000.0, 3.0), Vec3(-2839000.0, 4663000.0, 3285000.0) })
    {
      const ScanResult moved =
        runScan(makeSetup(town(at, snap), Sensor{}, settings), horizon(120, 4, at));
      ASSERT_EQ(moved.echoes.size(), reference.echoes.size());
      for (std::size_t i = 0; i < moved.echoes.size(); ++i)
      {
        EXPECT_NEAR(moved.echoes[i].range, reference.echoes[i].range, 1e-6);
        EXPECT_EQ(moved.echoes[i].objectId, reference.echoes[i].objectId);
      }
    }
  }
}

TEST(Scan, SingleAndDoubleSeeTheSameTown)
{
  EchoSettings settings = usual();
  settings.precision = Precision::Single;
  const ScanResult one = runScan(makeSetup(town(), Sensor{}, settings), horizon(180, 4));
  settings.precision = Precision::Double;
  const ScanResult two = runScan(makeSetup(town(), Sensor{}, settings), horizon(180, 4));
  ASSERT_EQ(one.echoes.size(), two.echoes.size());
  for (std::size_t i = 0; i < one.echoes.size(); ++i)
  {
    EXPECT_NEAR(one.echoes[i].range, two.echoes[i].range, 1e-6 * two.echoes[i].range);
    EXPECT_NEAR(one.echoes[i].energyReceived, two.echoes[i].energyReceived,
      1e-6 * two.echoes[i].energyReceived);
  }
}

TEST(Scan, StatusOfABeamTellsWhatBecameOfIt)
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
}

TEST(Scan, TargetErrorSpendsRaysWhereTheyAreNeeded)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), { 0.146, 0, 0 });
  scene.plate(Vec3(0.0, 100.0, 50.0), Vec3(50.0, 0.0, 0.0), Vec3(0.0, 0.0, 50.0), { 0.146, 0, 0 });
  ScanBeams beams;
  beams.ids = { 0, 1 };
  beams.origins.assign(2, Vec3(0.0));
  beams.directions = { Vec3(1, 0, 0), Vec3(0, 1, 0) }; // the second sees an edge through its middle
  EchoSettings settings = directSettings(100);
  settings.targetRelativeError = 0.01;
  const ScanResult result = runScan(makeSetup(scene, openSensor(), settings), beams);
  ASSERT_EQ(result.echoes.size(), 2u);
  EXPECT_LT(result.reports[0].raysTracedNow, result.reports[1].raysTracedNow);
  EXPECT_NEAR(result.echoes[1].returnEnergy, 2.627979397e-5, 0.05 * 2.627979397e-5);
  EXPECT_LT(result.echoes[1].energyStdError, 0.02 * result.echoes[1].energyReceived);
}

TEST(Scan, OneRayHasNoStandardError)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall);
  const Echo echo = onlyEcho(scene, openSensor(), directSettings(1));
  EXPECT_GT(echo.energyReceived, 0.0);
  EXPECT_TRUE(std::isnan(echo.energyStdError));
}

TEST(Scan, FalseAlarmsComeFromEmptyUnitsOnlyWhereNoiseMatters)
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

TEST(Scan, ABeamAimedAtTheMiddleOfABoxMeetsItWithAnyTree)
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
    for (bool batch : { true, false })
    {
      EchoSettings settings = usual();
      settings.batchCollisionDetection = batch;
      const TreeOptions options{ SplitRule::SurfaceAreaHeuristic,
        static_cast<BoundingVolumeType>(volume), 4 };
      const ScanResult result = runScan(makeSetup(scene, Sensor{}, settings, options), beams);
      for (const BeamReport& report : result.reports)
      {
        EXPECT_NE(report.status, BeamStatus::NoSurface) << volume << batch;
      }
    }
  }
}

TEST(Scan, StatusAndRangeOfTheReportDoNotDependOnWhatIsShown)
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

TEST(Scan, RangesAreNeverNegative)
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

TEST(Scan, StandardErrorsHoldWhereAPlaneSpreadsOverRangeUnits)
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

TEST(Scan, SettingsThatWouldOverflowThePathsAreRefused)
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
