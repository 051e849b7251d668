// SPDX-License-Identifier: BSD-3-Clause
// A scan is the same bits for any number of threads, order and parts of the beams, tree, and state
// of the cache; and the same to a micrometre wherever the scene stands.
#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace echotest;

TEST(Scan, AnyNumberOfThreadsGivesTheSameBits)
{
  const ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  const ScanBeams beams = horizon(180, 4);
  const ScanResult one = runScan(setup, beams, 1);
  ASSERT_GT(one.echoes.size(), 100u);
  for (int threads : { 2, 3, 7 })
  {
    const ScanResult several = runScan(setup, beams, threads);
    expectSame(one, several);
    for (std::size_t b = 0; b < beams.size(); ++b)
    {
      const TraceCounters& x = one.reports[b].counters;
      const TraceCounters& y = several.reports[b].counters;
      ASSERT_TRUE(x.candidates == y.candidates && x.nodesVisited == y.nodesVisited &&
        x.raysTraced == y.raysTraced)
        << "beam " << b << ", " << threads << " threads";
    }
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

TEST(Scan, ABeamThatMeetsNothingHearsNoiseAlone)
{
  // Five photons a range unit on the average; more than twelve, as some eleven units of a beam
  // receive, are perceived.
  Sensor sensor;
  sensor.noisePhotonRate = 1e9;
  sensor.lowerEnergyLimit = 12.0 * sensor.photonEnergy();
  const ScanSetup setup = makeSetup(town(), sensor, usual());
  const ScanBeams beams = horizon(90, 4);
  ScanResult joined;
  int empty = 0;
  for (std::size_t i = 0; i < beams.size(); ++i)
  {
    ScanBeams one = oneBeam(beams.directions[i]);
    one.ids[0] = beams.ids[i];
    const ScanResult alone = runScan(setup, one);
    const auto isAlarm = [](const Echo& echo) { return echo.objectId < 0; };
    empty += std::all_of(alone.echoes.begin(), alone.echoes.end(), isAlarm);
    joined.echoes.insert(joined.echoes.end(), alone.echoes.begin(), alone.echoes.end());
    joined.beamOfEcho.resize(joined.echoes.size(), i);
  }
  EXPECT_GT(empty, 10);
  EXPECT_GT(joined.echoes.size(), 9 * beams.size());
  expectSame(joined, runScan(setup, beams));
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
  EchoSettings settings = usual();
  settings.beamSamples = BeamSampleSource::Rays; // it depends on materials whether a beam has rays
  ScanSetup setup = makeSetup(scene, Sensor{}, settings);
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
  // Some triangles alone: where a beam's rays hit, and where its mirror paths end.
  const Material before = setup.materials[0];
  for (std::size_t first = 0; first < 12; ++first)
  {
    edit(setup.materials,
      [&](std::vector<Material>& materials)
      {
        for (std::size_t t = first; t < materials.size(); t += 12)
        {
          materials[t] = { before.kd, before.ks, 0.9 * before.kp };
        }
      });
    check(true);
  }
  setup.settings.lightEnergyConstraint = false;
  check(true);
  setup.materials = std::vector<Material>(setup.materials.size(), Glass);
  check(false); // now everything is known
  setup.settings.numberOfConnections = 3;
  check(true);
  setup.settings.raysPerBeam = 41;
  check(true);
  setup.settings.seed = 5;
  check(true);
}

TEST(Scan, ALightKeyIsNewWhereMaterialsModelOrApertureAre)
{
  ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  LightKey light;
  EXPECT_FALSE(updateKey(light, setup));
  EXPECT_TRUE(updateKey(light, setup));
  edit(setup.materials, [](std::vector<Material>& materials) { materials[7].kp *= 0.5; });
  EXPECT_FALSE(updateKey(light, setup));
  setup.settings.reflectanceModel = ReflectanceModel::Phong;
  EXPECT_FALSE(updateKey(light, setup));
  setup.sensor.receiverAperture = 1.0;
  EXPECT_FALSE(updateKey(light, setup));
  setup.largestReflectance *= 0.5;
  EXPECT_FALSE(updateKey(light, setup));
  EXPECT_TRUE(updateKey(light, setup));
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
      const std::size_t always = beams.size() * (sizeof(BeamTrace) + sizeof(BeamKey));
      EXPECT_GE(cache.bytes(), always);
      EXPECT_LE(cache.bytes(), bytes + always);
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
  // One beam, all on the ground: between blocks nothing is asked before it is done.
  EchoSettings settings = usual();
  settings.raysPerBeam = 100000;
  settings.beamSamples = BeamSampleSource::Rays;
  ScanBeams beams = horizon(4, 1);
  beams.ids.resize(1);
  beams.origins.resize(1);
  beams.directions.assign(1, Vec3(0.0, 0.0, -1.0));
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

TEST(Scan, AbortIsHeardWithinNoise)
{
  // Empty sky with some 90,000 false alarms, in one beam or in one block of beams: between blocks
  // nothing is asked before they are drawn.
  for (const int count : { 1, 100 })
  {
    Sensor sensor;
    sensor.samplingInterval = 1e-9;
    sensor.pulseWidth = 0.0;
    sensor.rangeGate = 15000.0 / count;
    sensor.noisePhotonRate = 2e9; // 2 photons in a range unit
    sensor.lowerEnergyLimit = 0.0;
    EchoSettings settings = usual();
    settings.returnMode = ReturnMode::Strongest;
    const ScanSetup setup = makeSetup(Scene(), sensor, settings);
    const ScanBeams beams = horizon(count, 1);
    TraceCache cache;
    ScanResult result;
    int calls = 0;
    double fraction = 0.0;
    const auto go = [&](double done)
    {
      EXPECT_GE(done, fraction);
      fraction = done;
      return ++calls > 0;
    };
    ASSERT_TRUE(simulateScan(setup, beams, 1, cache, 0, go, result));
    EXPECT_GT(calls, 15);
    calls = 0;
    const auto stop = [&calls](double) { return ++calls < 5; };
    EXPECT_FALSE(simulateScan(setup, beams, 1, cache, 0, stop, result));
    EXPECT_EQ(calls, 5);
    EXPECT_TRUE(result.echoes.empty());
  }
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
  EXPECT_GE(calls, 10); // some thousand rays with hits each
}

TEST(Scan, SceneInUtmAndEcefCoordinates)
{
  // Multiples of 2^-20 m survive the move to 6.4e6 m without rounding.
  const double snap = 1.0 / (1 << 20);
  const ScanBeams here = horizon(120, 4);
  const EchoSettings settings = usual();
  const ScanResult reference = runScan(makeSetup(town(Vec3(0.0), snap), Sensor{}, settings), here);
  ASSERT_GT(reference.echoes.size(), 50u);
  for (const Vec3& at : { Vec3(342000.0, 3453000.0, 3.0), Vec3(-2839000.0, 4663000.0, 3285000.0) })
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
