// SPDX-License-Identifier: BSD-3-Clause
// Integrated beams that see two reflections: whose echoes those are, and what is left out of them.
#include "CellTestScene.h"
#include "IntegrationTestScene.h"
#include "Sanitized.h"
#include "SecondaryTestScene.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
const Material Mirror{ 0.0, 0.8, 1e4 };

void expectMirrors(const Echo& echo)
{
  EXPECT_TRUE(echo.objectId == 7 || echo.objectId == 9) << echo.objectId;
  EXPECT_EQ(echo.materialId, 10 * echo.objectId);
  EXPECT_GE(echo.labelShare, 0.5);
  EXPECT_LT(echo.labelShare, 0.7);
  EXPECT_EQ(echo.secondaryShare, 1.0);
  EXPECT_NEAR(echo.incidenceAngle, 45.0 * Degree, 0.01);
}
}

TEST(PolygonPaths, AnEchoOfPathsAloneIsLabelledByTheSurfacesThatTheyMeet)
{
  EchoSettings settings = secondarySettings(100, 8, BeamSampleSource::Cells);
  // Range units so short that surfaces as steep as a groove's lie in many of them.
  Sensor sensor = openSensor(2e-3);
  sensor.samplingInterval = 5e-11;
  sensor.rangeGate = 120.0;
  sensor.lowerEnergyLimit = 1e-6;
  // Mirrors, which have no direct echo, and a wall that no beam along x meets; an object and a
  // material each.
  Scene scene = groove(45.0 * Degree, Mirror);
  scene.objects = { 7, 7, 9, 9 };
  scene.square(Vec3(-50.0, 0.0, 0.0), 9.0, Wall, 3);
  ScanSetup setup = makeSetup(scene, sensor, settings);
  setup.materialIds = std::vector<int>{ 70, 70, 90, 90, 30, 30 };
  finishSetup(setup);
  // As the first beam of a scan, and after another of which something may be left.
  for (const bool after : { false, true })
  {
    ScanBeams beams = after ? oneBeam({ -1.0, 0.0, 0.0 }) : ScanBeams();
    addBeam(beams, Vec3(1.0, 0.0, 0.0));
    const ScanResult result = runScan(setup, beams);
    ASSERT_EQ(result.echoes.size(), beams.size());
    expectMirrors(result.echoes.back());
    EXPECT_EQ(result.reports.back().status, BeamStatus::Echo);
    EXPECT_TRUE(std::isfinite(result.echoes.back().energyStdError));
    if (after)
    {
      EXPECT_TRUE(isIntegrated(result));
      EXPECT_EQ(result.echoes[0].objectId, 3);
      EXPECT_EQ(result.echoes[0].materialId, 30);
    }
  }
  // Rays alone say the same.
  setup.settings.raysPerBeam = 1000;
  finishSetup(setup);
  const double integrated = receivedFrom(runScan(setup, oneBeam()));
  setup.settings.beamSamples = BeamSampleSource::Rays;
  const ScanResult sampled = runScan(setup, oneBeam());
  ASSERT_EQ(sampled.echoes.size(), 1u);
  expectMirrors(sampled.echoes[0]);
  EXPECT_NEAR(integrated, receivedFrom(sampled), 0.02 * integrated);
}

namespace
{
/// A corner that the beam looks into, of a mirror and a matt wall, and before it a small mirror
/// that throws light on the wall, and a small matt plate.
Scene cornerWithThings(int parts)
{
  Scene scene;
  const Vec3 edge(100.0, 0.0, 0.0);
  const Vec3 up(0.0, 0.0, 3.0);
  const Material matt{ 0.5, 0.0, 1.0 };
  celltest::fine(scene, edge + Vec3(-2.5, 2.5, 0.0), Vec3(2.5, -2.5, 0.0), up, parts, Metal, 1);
  celltest::fine(scene, edge + Vec3(-2.5, -2.5, 0.0), Vec3(2.5, 2.5, 0.0), up, parts, matt, 2);
  scene.plate(Vec3(97.0, 0.6, 0.2), Vec3(0.1, 0.09, 0.0), Vec3(0.0, 0.0, 0.1), Metal, 3);
  scene.square(Vec3(98.0, -0.6, 0.2), 0.1, matt, 4);
  return scene;
}
}

TEST(PolygonPaths, TheirMeanIsThatOfRaysFromPolygonsAndInCells)
{
  struct Way
  {
    BeamSampleSource source;
    int parts; ///< many: the beam is divided into cells
    DirectEcho direct;
  };
  const Way ways[] = { { BeamSampleSource::Rays, 1, DirectEcho::Rays },
    { BeamSampleSource::Cells, 1, DirectEcho::Polygons },
    { BeamSampleSource::Cells, 12, DirectEcho::Cells } };
  constexpr int seeds = IsSanitized ? 100 : 1000;
  statistics::Moments energies[3][2]; // of all, and of what came after two reflections
  for (int way = 0; way < 3; ++way)
  {
    SCOPED_TRACE(way);
    EchoSettings settings = secondarySettings(40);
    settings.beamSamples = ways[way].source;
    ScanSetup setup = makeSetup(cornerWithThings(ways[way].parts), openSensor(0.02), settings);
    for (int seed = 0; seed < seeds; ++seed)
    {
      setup.settings.seed = seed;
      finishSetup(setup);
      TraceCache cache;
      ScanResult result;
      simulateScan(setup, oneBeam(), 1, cache, std::size_t(1) << 30, {}, result);
      ASSERT_EQ(cache.beams[0].view.direct(), ways[way].direct);
      energies[way][0].add(receivedFrom(result));
      energies[way][1].add(secondaryOf(result));
    }
    for (int k = 0; k < 2; ++k)
    {
      const statistics::Moments& rays = energies[0][k];
      const statistics::Moments& these = energies[way][k];
      EXPECT_NEAR(these.mean(), rays.mean(), 4.0 * std::hypot(these.error(), rays.error())) << k;
      EXPECT_LT(these.error(), 1.5 / std::sqrt(double(seeds)) * energies[way][1].mean()) << k;
    }
  }
}

//--- bounds ---------------------------------------------------------------------------------------

namespace
{
/// A groove before which a box may stand, all of any materials.
Scene facingWalls(Numbers& random)
{
  const Material materials[] = { Wall, Glass, Metal, Wood, Mirror, { 0.5, 0.3, 1000.0 },
    { 1e-3, 0.0, 0.0 }, { 0.0, 0.1, 300.0 }, { 0.0, 1.0, 100.0 } };
  const auto any = [&]() -> const Material& { return materials[random.index(9)]; };
  // A right angle reflects light back to where it comes from.
  const double half = random.index(2) == 0 ? 45.0 : random(30.0, 60.0);
  Scene scene = groove(half * Degree, any(), random(0.0, 0.1));
  if (random.index(2) == 0)
  {
    std::fill_n(scene.materials.begin(), 2, any());
  }
  if (random.index(3) == 0)
  {
    scene.box(Vec3(90.0, random(-1.0, 1.0), 0.0), Vec3(0.2), any(), 2);
  }
  return scene;
}

using Units = std::map<std::pair<std::size_t, double>, double>;

double strongestOf(const Units& units)
{
  double strongest = 0.0;
  for (const auto& [range, energy] : units)
  {
    strongest = std::max(strongest, energy);
  }
  return strongest;
}

/// What the scan leaves out is bounded as it says. @return the report of its beam
BeamReport expectWithinBounds(ScanSetup setup, const Units& all)
{
  const double lower = setup.sensor.lowerEnergyLimit;
  setup.settings.lightEnergyConstraint = true;
  finishSetup(setup);
  const ScanResult result = runScan(setup, oneBeam());
  const BeamReport& report = result.reports[0];
  const Units units = unitsOf(result);
  const double tolerance = setup.settings.lightEnergyFraction * lower;
  if ((report.skipped & SkippedBeam) != 0)
  {
    EXPECT_TRUE(units.empty());
    EXPECT_LT(report.lost, lower);
  }
  else
  {
    EXPECT_LE(report.lost, 1.001 * tolerance);
  }
  const double missing = report.lost * SurelyAbove;
  for (const auto& [range, energy] : all)
  {
    const auto found = units.find(range);
    if (found == units.end())
    {
      EXPECT_LE(energy, lower + std::min(missing, tolerance)) << range.second;
      EXPECT_TRUE((report.skipped & SkippedBeam) == 0 || energy <= missing) << range.second;
    }
    else
    {
      EXPECT_NEAR(found->second, energy, missing + 1e-12 * energy) << range.second;
    }
  }
  for (const auto& [range, energy] : units)
  {
    EXPECT_EQ(all.count(range), 1u) << range.second;
  }
  return report;
}
}

TEST(PolygonPaths, NoUnitLosesMoreByPathsThanTheReportSays)
{
  Numbers random(31);
  int integrated = 0;
  int lit = 0;
  int left = 0;
  int withoutPaths = 0; // without some of them
  int byPathsAlone = 0; // beams perceived by paths with two reflections alone
  for (int k = 0; k < 60; ++k)
  {
    SCOPED_TRACE(k);
    Sensor sensor;
    sensor.lowerEnergyLimit = 0.0;
    sensor.upperEnergyLimit = 1.0;
    sensor.pulseEnergy = 1.0;
    EchoSettings settings = secondarySettings(100, 8, BeamSampleSource::Cells);
    settings.returnMode = ReturnMode::RangeUnits;
    settings.lightEnergyConstraint = false;
    settings.attenuationCoefficient = k % 2 ? 1e-3 : 0.0;
    settings.reflectanceModel = static_cast<ReflectanceModel>(random.index(4));
    ScanSetup setup = makeSetup(facingWalls(random), sensor, settings);
    const Units all = unitsOf(runScan(setup, oneBeam()));
    const double strongest = strongestOf(all);
    if (strongest == 0.0)
    {
      continue;
    }
    ScanSetup once = setup;
    once.settings.numberOfReflections = 1;
    finishSetup(once);
    const ScanResult direct = runScan(once, oneBeam());
    ASSERT_TRUE(isIntegrated(direct));
    ++integrated;
    byPathsAlone += strongestOf(unitsOf(direct)) < 0.3 * strongest;
    for (const double limit : { 1e-2, 0.5, 0.99, 1.01, 1.5, 3.0, 10.0, 1e3 })
    {
      SCOPED_TRACE(limit);
      setup.sensor.lowerEnergyLimit = limit * strongest;
      const BeamReport report = expectWithinBounds(setup, all);
      const bool isLeft = (report.skipped & SkippedBeam) != 0;
      lit += isLeft ? 0 : 1;
      left += isLeft ? 1 : 0;
      withoutPaths += !isLeft && (report.skipped & SkippedSecondaryPaths) != 0;
    }
  }
  EXPECT_GT(integrated, 40);
  EXPECT_GT(lit, 100);
  EXPECT_GT(left, 20);
  EXPECT_GT(withoutPaths, 20);
  EXPECT_GT(byPathsAlone, 5);
}

//--- standard errors ------------------------------------------------------------------------------

TEST(PolygonPaths, FewMirrorPathsStateTheirError)
{
  // A mirror path may be blocked, or arrive in another unit. Few paths do not show how often.
  Numbers random(32);
  int echoes = 0;
  int within = 0;
  for (int k = 0; k < 60; ++k)
  {
    EchoSettings settings = secondarySettings(20000, 0, BeamSampleSource::Cells);
    settings.returnMode = ReturnMode::RangeUnits;
    settings.lightEnergyConstraint = false;
    Sensor sensor;
    sensor.lowerEnergyLimit = 0.0;
    ScanSetup setup = makeSetup(facingWalls(random), sensor, settings);
    const Units expected = unitsOf(runScan(setup, oneBeam()));
    setup.settings.raysPerBeam = 25;
    for (int seed = 0; seed < 20; ++seed)
    {
      setup.settings.seed = seed;
      finishSetup(setup);
      for (const Echo& echo : runScan(setup, oneBeam()).echoes)
      {
        const auto unit = expected.find({ 0, echo.range });
        if (unit != expected.end() && echo.secondaryShare > 0.02)
        {
          ++echoes;
          within += std::fabs(echo.energyReceived - unit->second) <= 1.96 * echo.energyStdError;
        }
      }
    }
  }
  EXPECT_GT(echoes, 1000);
  EXPECT_GE(within, 0.95 * echoes) << "of " << echoes;
}
