// SPDX-License-Identifier: BSD-3-Clause
// A scan has the same bits for any number of threads, order and parts of the beams, tree and size
// of the cache, by rays, over polygons and in cells. TestScanAgain has changes,
// TestStabilityCoordinates places of the scene.
#include "GeometryTestScene.h"
#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace echotest;

namespace
{
/// The town, and a wall of so many parts that wide beams which meet it are divided into cells.
Scene townWithWall()
{
  Scene scene = town();
  addFineWall(scene);
  return scene;
}

Sensor wide()
{
  Sensor sensor;
  sensor.halfBeamwidth = 0.03;
  return sensor;
}

/// By rays, and where beams need none without them.
std::vector<EchoSettings> bothSources()
{
  std::vector<EchoSettings> both(2, usual());
  both[0].beamSamples = BeamSampleSource::Rays;
  both[1].beamSamples = BeamSampleSource::Cells;
  return both;
}
}

TEST(Scan, AnyNumberOfThreadsGivesTheSameBits)
{
  const ScanBeams beams = horizon(180, 4);
  for (const EchoSettings& settings : bothSources())
  {
    const ScanSetup setup = makeSetup(townWithWall(), wide(), settings);
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
}

TEST(Scan, AnyOrderAndAnyPartsOfTheBeamsGiveTheSameBits)
{
  const ScanSetup setup = makeSetup(townWithWall(), wide(), usual());
  const ScanBeams beams = horizon(180, 4);
  const ScanResult whole = runScan(setup, beams);
  std::vector<std::size_t> order(beams.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
  for (std::size_t parts : { 1, 2, 5 })
  {
    // Every part by itself; then put back in the order of the beam ids.
    std::vector<std::pair<std::uint64_t, Echo>> all;
    for (std::size_t part = 0; part < parts; ++part)
    {
      const std::size_t begin = order.size() * part / parts;
      const std::size_t end = order.size() * (part + 1) / parts;
      const ScanBeams some = chosen(beams, { order.begin() + begin, order.begin() + end });
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

TEST(Scan, AnyTreeAndWayDownGivesTheSameBits)
{
  const Scene scene = townWithWall();
  const ScanBeams beams = horizon(90, 4);
  std::vector<std::pair<Sensor, EchoSettings>> ways;
  for (const EchoSettings& settings : bothSources())
  {
    ways.emplace_back(wide(), settings);
  }
  ways.push_back(ways.back());
  ways.back().first.rangeGate = 130.0; // ends in the middle of the town
  for (auto& [sensor, settings] : ways)
  {
    const ScanResult reference = runScan(makeSetup(scene, sensor, settings), beams);
    int beamsIn[5] = {};
    for (const BeamReport& report : reference.reports)
    {
      ++beamsIn[static_cast<int>(report.direct)];
    }
    if (settings.beamSamples == BeamSampleSource::Cells)
    {
      EXPECT_GT(beamsIn[static_cast<int>(DirectEcho::Polygons)], 20);
      EXPECT_GT(beamsIn[static_cast<int>(DirectEcho::Cells)], 10);
    }
    for (const TreeOptions& options : geometrytest::allTreeOptions({ 1, 16 }))
    {
      expectSame(reference, runScan(makeSetup(scene, sensor, settings, options), beams));
    }
    for (const TraceMode mode : { TraceMode::SingleRays, TraceMode::Beams })
    {
      settings.traceMode = mode;
      expectSame(reference, runScan(makeSetup(scene, sensor, settings), beams));
    }
  }
}

TEST(Scan, SurfacesBehindTheGateChangeNoEcho)
{
  // Some far surfaces are large or begin before the gate ends, and some share a beam with near
  // ones.
  const Scene near = townWithWall();
  Scene both = townWithWall();
  Sensor sensor = wide();
  sensor.rangeGate = 600.0;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 2000; ++i)
  {
    const double angle = 2.0 * Pi * uniform(random);
    const double range = 700.0 + 2000.0 * uniform(random);
    const double half = i % 100 == 0 ? 60.0 : 4.0;
    both.box(Vec3(range * std::cos(angle), range * std::sin(angle), half - 2.0), Vec3(half), Wall,
      1000 + i);
  }
  const ScanBeams beams = horizon(180, 4);
  const ScanResult alone = runScan(makeSetup(near, sensor, usual()), beams);
  const ScanResult gated = runScan(makeSetup(both, sensor, usual()), beams);
  ASSERT_GT(alone.echoes.size(), 100u);
  expectSame(alone, gated);
  sensor.rangeGate = 4000.0;
  const ScanResult open = runScan(makeSetup(both, sensor, usual()), beams);
  std::size_t behind = 0;
  std::uint64_t nodes[2] = {};
  for (std::size_t b = 0; b < beams.size(); ++b)
  {
    // A beam that meets nothing near meets something behind the gate if it does without a gate.
    const bool isBehind = alone.reports[b].status == BeamStatus::NoSurface &&
      open.reports[b].status != BeamStatus::NoSurface;
    behind += isBehind ? 1 : 0;
    EXPECT_EQ(gated.reports[b].status, isBehind ? BeamStatus::OutsideGate : alone.reports[b].status)
      << b;
    nodes[0] += gated.reports[b].counters.nodesVisited;
    nodes[1] += open.reports[b].counters.nodesVisited;
  }
  EXPECT_GT(behind, 10u);
  EXPECT_LT(nodes[0], nodes[1]);
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
      const std::size_t always = beams.size() * (sizeof(KeptBeam) + sizeof(BeamKey));
      EXPECT_GE(cache.bytes(), always);
      EXPECT_LE(cache.bytes(), bytes + always);
    }
  }
}

TEST(Scan, AbortIsHeardWithinABeamOfManyRaysAndWithinNoise)
{
  // Between blocks of beams nothing is asked before they are done. One beam, all on the ground;
  // then empty sky with some 90,000 false alarms, in one beam or in one block of beams.
  EchoSettings settings = usual();
  settings.raysPerBeam = 100000;
  settings.beamSamples = BeamSampleSource::Rays;
  std::vector<std::pair<ScanSetup, ScanBeams>> scans = { { makeSetup(town(), Sensor{}, settings),
    oneBeam(Vec3(0.0, 0.0, -1.0)) } };
  for (const int count : { 1, 100 })
  {
    Sensor sensor;
    sensor.samplingInterval = 1e-9;
    sensor.pulseWidth = 0.0;
    sensor.rangeGate = 15000.0 / count;
    sensor.noisePhotonRate = 2e9; // 2 photons in a range unit
    sensor.lowerEnergyLimit = 0.0;
    settings = usual();
    settings.returnMode = ReturnMode::Strongest;
    scans.emplace_back(makeSetup(Scene(), sensor, settings), horizon(count, 1));
  }
  for (const auto& [setup, beams] : scans)
  {
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
    EXPECT_TRUE(cache.beams.empty());
  }
}
