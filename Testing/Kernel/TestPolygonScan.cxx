// SPDX-License-Identifier: BSD-3-Clause
// Scans of which some beams are integrated: the same bits however they are made.
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"
#include "PolygonQuadrature.h"
#include "ScanTestTown.h"
#include "SecondaryTestScene.h"
#include "VisiblePolygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <vector>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
void expectSameBits(const ScanResult& one, const ScanResult& two)
{
  ASSERT_EQ(one.echoes.size(), two.echoes.size());
  ASSERT_EQ(one.beamOfEcho, two.beamOfEcho);
  for (std::size_t i = 0; i < one.echoes.size(); ++i)
  {
    EXPECT_EQ(one.echoes[i].range, two.echoes[i].range);
    EXPECT_EQ(one.echoes[i].energyReceived, two.echoes[i].energyReceived);
    EXPECT_EQ(one.echoes[i].returnEnergy, two.echoes[i].returnEnergy);
    EXPECT_EQ(one.echoes[i].energyStdError, two.echoes[i].energyStdError);
    EXPECT_EQ(one.echoes[i].incidenceAngle, two.echoes[i].incidenceAngle);
    EXPECT_EQ(one.echoes[i].materialId, two.echoes[i].materialId);
  }
}

/// Boxes all around, some hundred beams.
ScanSetup boxesAround()
{
  Scene scene;
  Numbers random(7);
  for (int box = 0; box < 12; ++box)
  {
    const double azimuth = 2.0 * Pi * box / 12;
    scene.box(random(40.0, 90.0) * Vec3(std::cos(azimuth), std::sin(azimuth), 0.0),
      Vec3(6.0, 6.0, 15.0), box % 2 ? Wall : Glass, box);
  }
  EchoSettings settings;
  settings.planeIntegration = true;
  settings.noise = false;
  Sensor sensor;
  sensor.lowerEnergyLimit = 2e-7;
  return makeSetup(scene, sensor, settings);
}

std::vector<bool> integratedOf(const ScanResult& result)
{
  std::vector<bool> integrated;
  for (const BeamReport& report : result.reports)
  {
    integrated.push_back(report.status != BeamStatus::NoSurface && report.counters.raysTraced == 0);
  }
  return integrated;
}

ScanBeams ring(int count)
{
  ScanBeams beams;
  for (int i = 0; i < count; ++i)
  {
    const double azimuth = 2.0 * Pi * i / count;
    beams.ids.push_back(i);
    beams.origins.emplace_back(0.0, 0.0, 0.0);
    beams.directions.emplace_back(std::cos(azimuth), std::sin(azimuth), 0.01 * (i % 5));
  }
  return beams;
}
}

TEST(PolygonScan, TheSameBitsHoweverItIsDone)
{
  ScanSetup setup = boxesAround();
  const ScanBeams beams = ring(400);
  const ScanResult once = runScan(setup, beams);
  const std::vector<bool> integrated = integratedOf(once);
  const auto number = std::count(integrated.begin(), integrated.end(), true);
  EXPECT_GT(number, 50);
  EXPECT_LT(number, 350);
  expectSameBits(once, runScan(setup, beams, 3));
  setup.settings.traceMode = TraceMode::SingleRays;
  expectSameBits(once, runScan(setup, beams));
  setup.settings.traceMode = TraceMode::Automatic;
  // A triangle beside the disc may reach the search or not.
  const std::shared_ptr<const CollisionTree> tree = setup.tree;
  for (const int leaf : { 1, 2, 16 })
  {
    for (const BoundingVolumeType volume : { BoundingVolumeType::AABB, BoundingVolumeType::Sphere })
    {
      TreeOptions options;
      options.maximumLeafSize = leaf;
      options.boundingVolume = volume;
      setup.tree = buildCollisionTree(tree->mesh, options);
      finishSetup(setup);
      expectSameBits(once, runScan(setup, beams));
    }
  }
  setup.tree = tree;
  finishSetup(setup);
  std::vector<bool> before(beams.size(), false);
  for (const int rays : { 32, 45, 100, 1000 })
  {
    setup.settings.raysPerBeam = rays;
    const std::vector<bool> now = integratedOf(runScan(setup, beams));
    for (std::size_t b = 0; b < beams.size(); ++b)
    {
      EXPECT_LE(before[b], now[b]) << b;
      // Those before it decide when a beam is looked at, not how it ends.
      ScanBeams one;
      one.ids.push_back(beams.ids[b]);
      one.origins.push_back(beams.origins[b]);
      one.directions.push_back(beams.directions[b]);
      EXPECT_EQ(isIntegrated(runScan(setup, one)), now[b]) << b;
    }
    before = now;
  }
  // A beam of N rays is not integrated over more than N triangles.
  setup.settings.raysPerBeam = 2;
  const std::vector<bool> few = integratedOf(runScan(setup, beams));
  EXPECT_LT(std::count(few.begin(), few.end(), true), number);
}

TEST(PolygonScan, LitAgainIsFresh)
{
  ScanSetup setup = boxesAround();
  const ScanBeams beams = ring(400);
  TraceCache cache;
  ScanResult result;
  const auto check = [&](const char* what)
  {
    SCOPED_TRACE(what);
    finishSetup(setup);
    ASSERT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
    expectSameBits(result, runScan(setup, beams));
  };
  check("first");
  setup.settings.attenuationCoefficient = 1e-3;
  check("air");
  setup.sensor.lowerEnergyLimit = 1e-6;
  check("limit");
  setup.sensor.samplingInterval = 2e-9;
  check("range units");
  std::vector<Material> materials(setup.tree->mesh->size(), Wall);
  setup.materials = materials;
  check("all walls");
  materials[0] = Glass; // its plane is no longer of one material
  setup.materials = materials;
  check("one triangle");
  materials[0] = Wall;
  setup.materials = materials;
  check("walls again");
  setup.settings.planeIntegration = false;
  check("off");
}

TEST(PolygonScan, LitAgainWhereRaysToldThatASearchWasInVain)
{
  for (const double target : { 0.0, 0.2 })
  {
    SCOPED_TRACE(target);
    ScanSetup setup = boxesAround();
    setup.settings.targetRelativeError = target;
    setup.settings.lightEnergyConstraint = false; // no polygon is dropped
    const ScanBeams beams = ring(400);
    TraceCache cache;
    ScanResult result;
    const auto integratedNow = [&]() -> std::ptrdiff_t
    {
      finishSetup(setup);
      EXPECT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
      const ScanResult fresh = runScan(setup, beams);
      expectSameBits(result, fresh);
      const std::vector<bool> integrated = integratedOf(fresh);
      return std::count(integrated.begin(), integrated.end(), true);
    };
    // So many units that no wall fits.
    const Sensor sensor = setup.sensor;
    setup.sensor.samplingInterval = 1e-16;
    setup.sensor.pulseWidth = 0.0;
    EXPECT_EQ(integratedNow(), 0);
    setup.sensor = sensor;
    EXPECT_GT(integratedNow(), 50);
    setup.sensor.samplingInterval = 1e-16;
    setup.sensor.pulseWidth = 0.0;
    EXPECT_EQ(integratedNow(), 0);
  }
}

//--- beams of paths alone, and of nothing ---------------------------------------------------------

namespace
{
const Material Mirror{ 0.0, 0.8, 1e4 };

/// A sensor of so short range units that surfaces as steep as a groove's lie in many of them.
Sensor sensorOfShortUnits()
{
  Sensor sensor = openSensor(2e-3);
  sensor.samplingInterval = 5e-11;
  sensor.rangeGate = 120.0;
  sensor.lowerEnergyLimit = 1e-6;
  return sensor;
}

/// A wall that no beam along x meets, then a groove of mirrors, which has no direct echo. The
/// groove has the objects 7 and 9, each with its material.
Scene grooveOfMirrors()
{
  Scene scene;
  scene.plate(Vec3(-50.0, 0.0, 0.0), Vec3(0.0, 9.0, 0.0), Vec3(0.0, 0.0, 9.0), Wall, 3);
  const Scene mirrors = groove(45.0 * Degree, Mirror);
  for (std::size_t t = 0; t < mirrors.mesh->triangles.size(); ++t)
  {
    const std::array<std::uint32_t, 3>& corners = mirrors.mesh->triangles[t];
    scene.triangle(mirrors.mesh->points[corners[0]], mirrors.mesh->points[corners[1]],
      mirrors.mesh->points[corners[2]], Mirror, mirrors.objects[t] ? 9 : 7);
  }
  return scene;
}

ScanSetup withMaterialIds(const Scene& scene, const Sensor& sensor, const EchoSettings& settings)
{
  ScanSetup setup = makeSetup(scene, sensor, settings);
  edit(setup.materialIds,
    [&](std::vector<int>& ids)
    {
      for (std::size_t t = 0; t < ids.size(); ++t)
      {
        ids[t] = 10 * scene.objects[t];
      }
    });
  finishSetup(setup);
  return setup;
}

void expectFalseAlarm(const Echo& echo)
{
  EXPECT_EQ(echo.objectId, -1);
  EXPECT_EQ(echo.materialId, -1);
  EXPECT_EQ(echo.labelShare, 0.0);
  EXPECT_TRUE(std::isnan(echo.incidenceAngle));
}

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

TEST(PolygonScan, AnEchoOfPathsAloneIsLabelledByTheSurfacesThatTheyMeet)
{
  EchoSettings settings = secondarySettings(100);
  settings.planeIntegration = true;
  ScanSetup setup = withMaterialIds(grooveOfMirrors(), sensorOfShortUnits(), settings);
  // As the first beam of a scan, and after another of which something may be left.
  for (const bool after : { false, true })
  {
    ScanBeams beams = after ? oneBeam({ -1.0, 0.0, 0.0 }) : ScanBeams();
    beams.ids.push_back(1);
    beams.origins.emplace_back(0.0);
    beams.directions.emplace_back(1.0, 0.0, 0.0);
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
  const double integrated = receivedFrom(runScan(setup, oneBeam()));
  setup.settings.planeIntegration = false;
  const ScanResult sampled = runScan(setup, oneBeam());
  ASSERT_EQ(sampled.echoes.size(), 1u);
  expectMirrors(sampled.echoes[0]);
  EXPECT_NEAR(integrated, receivedFrom(sampled), 0.02 * integrated);
}

TEST(PolygonScan, AnIntegratedBeamThatBringsNothingHasFalseAlarmsAlone)
{
  EchoSettings settings = integrating(100);
  settings.noise = true;
  Sensor sensor = sensorOfShortUnits();
  sensor.noisePhotonRate = 1e11; // 5 photons a unit
  sensor.lowerEnergyLimit = 8.0 * sensor.photonEnergy();
  const ScanResult alarms =
    runScan(withMaterialIds(grooveOfMirrors(), sensor, settings), oneBeam());
  EXPECT_TRUE(isIntegrated(alarms));
  EXPECT_GT(alarms.echoes.size(), 100u);
  for (const Echo& echo : alarms.echoes)
  {
    expectFalseAlarm(echo);
  }
  // With its paths it has one echo that is no false alarm.
  settings = secondarySettings(100);
  settings.planeIntegration = settings.noise = true;
  const ScanResult both = runScan(withMaterialIds(grooveOfMirrors(), sensor, settings), oneBeam());
  int labelled = 0;
  for (const Echo& echo : both.echoes)
  {
    if (echo.objectId != -1)
    {
      ++labelled;
      EXPECT_NEAR(echo.range, 100.0, 0.1);
      EXPECT_TRUE(echo.objectId == 7 || echo.objectId == 9) << echo.objectId;
      EXPECT_EQ(echo.materialId, 10 * echo.objectId);
    }
    else
    {
      expectFalseAlarm(echo);
    }
  }
  EXPECT_EQ(labelled, 1);
  // A wall whose edge touches the beam, by less than rounding or more.
  for (const double depth : { 0.0, 1e-16, 3e-16, 1e-15, 1e-14, 1e-12, 1e-9 })
  {
    Scene scene;
    scene.plate(Vec3(-50.0, 0.0, 0.0), Vec3(0.0, 9.0, 0.0), Vec3(0.0, 0.0, 9.0), Wall, 3);
    const double edge = 100.0 * std::tan(sensor.halfBeamwidth) * (1.0 - depth);
    scene.plate(Vec3(100.0, edge + 9.0, 0.0), Vec3(0.0, 9.0, 0.0), Vec3(0.0, 0.0, 9.0), Wall, 5);
    const ScanResult touched = runScan(withMaterialIds(scene, sensor, integrating(100)), oneBeam());
    EXPECT_EQ(touched.reports[0].counters.raysTraced, 0u);
    for (const Echo& echo : touched.echoes)
    {
      EXPECT_EQ(echo.objectId, 5) << depth;
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

/// Energies by range, J.
std::map<double, double> unitsOf(const ScanResult& result)
{
  std::map<double, double> units;
  for (const Echo& echo : result.echoes)
  {
    units[echo.range] = echo.energyReceived;
  }
  return units;
}

double strongestOf(const std::map<double, double>& units)
{
  double strongest = 0.0;
  for (const auto& [range, energy] : units)
  {
    strongest = std::max(strongest, energy);
  }
  return strongest;
}

/// What the scan leaves out is bounded as it says. @return the report of its beam
BeamReport expectWithinBounds(ScanSetup setup, const std::map<double, double>& all)
{
  const double lower = setup.sensor.lowerEnergyLimit;
  setup.settings.lightEnergyConstraint = true;
  finishSetup(setup);
  const ScanResult result = runScan(setup, oneBeam());
  const BeamReport& report = result.reports[0];
  const std::map<double, double> units = unitsOf(result);
  const double tolerance = LightEnergyTolerance * lower;
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
      EXPECT_LE(energy, lower + std::min(missing, tolerance)) << range;
      EXPECT_TRUE((report.skipped & SkippedBeam) == 0 || energy <= missing) << range;
    }
    else
    {
      EXPECT_NEAR(found->second, energy, missing + 1e-12 * energy) << range;
    }
  }
  for (const auto& [range, energy] : units)
  {
    EXPECT_EQ(all.count(range), 1u) << range;
  }
  return report;
}
}

TEST(PolygonScan, NoUnitLosesMoreByPathsThanTheReportSays)
{
  Numbers random(31);
  int integrated = 0;
  int lit = 0;
  int left = 0;
  int withoutPaths = 0; // without some of them
  int byPathsAlone = 0; // beams perceived by paths over two reflections alone
  for (int k = 0; k < 60; ++k)
  {
    SCOPED_TRACE(k);
    Sensor sensor;
    sensor.lowerEnergyLimit = 0.0;
    sensor.upperEnergyLimit = 1.0;
    sensor.pulseEnergy = 1.0;
    EchoSettings settings = secondarySettings(100);
    settings.planeIntegration = true;
    settings.returnMode = ReturnMode::RangeUnits;
    settings.lightEnergyConstraint = false;
    settings.attenuationCoefficient = k % 2 ? 1e-3 : 0.0;
    settings.reflectanceModel = static_cast<ReflectanceModel>(random.index(3));
    ScanSetup setup = makeSetup(facingWalls(random), sensor, settings);
    const std::map<double, double> all = unitsOf(runScan(setup, oneBeam()));
    const double strongest = strongestOf(all);
    if (strongest == 0.0)
    {
      continue;
    }
    ScanSetup once = setup;
    once.settings.numberOfReflections = 1;
    finishSetup(once);
    const ScanResult direct = runScan(once, oneBeam());
    if (!isIntegrated(direct))
    {
      continue; // too sharp a lobe
    }
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

TEST(PolygonScan, WherePathsOfAWholeSceneCannotMatterTheirBoundIsReported)
{
  Scene scene = groove(45.0 * Degree, { 1e-4, 0.0, 0.0 });
  Sensor sensor = openSensor();
  sensor.pulseEnergy = 1.0;
  EchoSettings settings = secondarySettings(100);
  settings.planeIntegration = true;
  settings.returnMode = ReturnMode::RangeUnits;
  settings.lightEnergyConstraint = false;
  ScanSetup setup = makeSetup(scene, sensor, settings);
  const ScanResult full = runScan(setup, oneBeam());
  ASSERT_EQ(full.echoes.size(), 1u);
  ASSERT_GT(secondaryOf(full), 0.0);
  setup.sensor.lowerEnergyLimit = 0.5 * full.echoes[0].energyReceived;
  const BeamReport report = expectWithinBounds(setup, unitsOf(full));
  EXPECT_EQ(report.status, BeamStatus::Echo);
  EXPECT_EQ(report.skipped, SkippedSecondaryPaths);
  EXPECT_GE(report.lost, secondaryOf(full));
}

//--- nodes ----------------------------------------------------------------------------------------

namespace
{
struct Nodes
{
  bool fits;
  std::size_t count; ///< of a beam that fits
};

/// The nodes of a beam along x.
Nodes nodesOf(const ScanSetup& setup)
{
  const BeamFrame frame =
    makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), BeamWidth(setup.sensor.halfBeamwidth));
  PolygonFinder finder(*setup.tree, mostTrianglesIntegrated(setup.settings));
  finder.begin(frame);
  std::vector<std::uint32_t> triangles(setup.tree->mesh->size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  std::unique_ptr<VisiblePolygons> found;
  PolygonQuadrature quadrature(setup);
  if (!finder.add(triangles.data(), triangles.size()) || finder.find(found) != SeenByBeam::Polygons)
  {
    return { false, 0 };
  }
  quadrature.begin(frame, *found);
  return quadrature.fits() ? Nodes{ true, quadrature.place().samples.size() } : Nodes{ false, 0 };
}

double mostNodes(int rays)
{
  return std::max(3000.0, 5.0 * rays);
}

/// Ground below the lidar, up to a distance.
Scene groundUpTo(double distance)
{
  Scene scene;
  scene.plate(
    Vec3(0.0, 0.0, -3.0), Vec3(distance, 0.0, 0.0), Vec3(0.0, 100.0, 0.0), { 0.3, 0.0, 0.0 });
  return scene;
}
}

TEST(PolygonScan, GroundOverMoreRangeUnitsThanNodesAllowIsSampled)
{
  // The beam is about the horizon: the ground fills range units from where it enters the beam on.
  Sensor sensor;
  sensor.lowerEnergyLimit = 0.0; // nothing is faint
  const double first = 3.0 / std::tan(sensor.halfBeamwidth);
  int sampled = 0;
  int integrated = 0;
  for (const int rays : { 20, 600, 1000, 1500 })
  {
    for (const double share : { 0.1, 0.5, 0.8, 1.2, 2.0 })
    {
      SCOPED_TRACE(testing::Message() << rays << " rays, " << share);
      // Two nodes a unit.
      const double units = 0.5 * share * mostNodes(rays);
      const double last = first + units * sensor.rangeUnitLength();
      if (last > sensor.rangeGate)
      {
        continue;
      }
      const ScanSetup setup = makeSetup(groundUpTo(last), sensor, integrating(rays));
      const ScanResult result = runScan(setup, oneBeam());
      EXPECT_EQ(isIntegrated(result), share < 1.0);
      EXPECT_EQ(result.raysTraced, share < 1.0 ? 0u : rays);
      const Nodes nodes = nodesOf(setup);
      EXPECT_EQ(nodes.fits, share < 1.0);
      EXPECT_LE(nodes.count, mostNodes(rays));
      EXPECT_GE(nodes.count, share < 1.0 ? 0.9 * share * mostNodes(rays) : 0.0);
      sampled += share > 1.0;
      integrated += share < 1.0;
    }
  }
  EXPECT_GE(sampled, 3);
  EXPECT_GE(integrated, 9);
}

TEST(PolygonScan, NoProfileAndNoLobeAsksForMoreNodesThanAllowed)
{
  Numbers random(32);
  int fitting = 0;
  int byRules = 0;
  int refused = 0;
  for (int k = 0; k < 3000; ++k)
  {
    SCOPED_TRACE(k);
    Sensor sensor = openSensor(random.logUniform(1e-3, 0.1));
    sensor.samplingInterval = random.logUniform(2e-10, 1e-7);
    sensor.pulseWidth = sensor.samplingInterval * random(0.0, 3.0);
    sensor.beamProfile = k % 2 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    Scene scene;
    const std::size_t count = 1 + random.index(30);
    for (std::size_t i = 0; i < count; ++i)
    {
      const double x = random(20.0, 100.0);
      const double spot = x * std::tan(sensor.halfBeamwidth);
      const auto corner = [&]()
      {
        return Vec3(x, 0.0, 0.0) +
          spot * Vec3(random(-9.0, 9.0), random(-2.0, 2.0), random(-2.0, 2.0));
      };
      const Material material{ random(0.0, 0.5), random(0.0, 0.5), random.logUniform(1.0, 1e6) };
      const Vec3 a = corner();
      const Vec3 b = corner();
      scene.triangle(a, b, corner(), material, static_cast<int>(i));
    }
    const int rays = k % 3 ? 100 : 1000;
    const Nodes nodes = nodesOf(makeSetup(scene, sensor, integrating(rays)));
    // Rules are counted by an estimate that misses some strips.
    EXPECT_LE(nodes.count, 2.0 * mostNodes(rays));
    fitting += nodes.fits;
    byRules += nodes.fits && sensor.beamProfile == BeamProfile::Gaussian;
    refused += !nodes.fits;
  }
  EXPECT_GT(fitting, 300);
  EXPECT_GT(byRules, 30);
  EXPECT_GT(refused, 300);
}

TEST(PolygonScan, WhereNothingMayBeDroppedFaintGroundIsBoundedToo)
{
  // Faint ground of 50,000 nodes, or of 150,000; none where it is dropped.
  Sensor sensor = openSensor(1e-3);
  sensor.samplingInterval = 0.02 / (0.5 * SpeedOfLight);
  sensor.rangeGate = 5000.0;
  sensor.lowerEnergyLimit = 0.01;
  sensor.upperEnergyLimit = 1.0;
  for (const double distance : { 3500.0, 4500.0 })
  {
    SCOPED_TRACE(distance);
    ScanSetup setup = makeSetup(groundUpTo(distance), sensor, integrating(100));
    const Nodes dropped = nodesOf(setup);
    EXPECT_TRUE(dropped.fits);
    EXPECT_EQ(dropped.count, 0u);
    setup.settings.fullModel = true;
    finishSetup(setup);
    const Nodes full = nodesOf(setup);
    EXPECT_EQ(full.fits, distance < 4000.0);
    EXPECT_EQ(isIntegrated(runScan(setup, oneBeam())), distance < 4000.0);
    EXPECT_LE(full.count, 1e5);
  }
}

//--- costs ----------------------------------------------------------------------------------------

namespace
{
/// Small boxes on a circle of 60 m, and the beams of a ring that surely pass all of them.
constexpr double Circle = 60.0;

Scene smallBoxes(int count)
{
  Scene scene;
  for (int box = 0; box < count; ++box)
  {
    const double azimuth = 2.0 * Pi * box / count;
    scene.box(Circle * Vec3(std::cos(azimuth), std::sin(azimuth), 0.0), Vec3(1.0),
      box % 2 ? Wall : Glass, box);
  }
  return scene;
}

bool surelyPassesAll(const Vec3& direction, int count, double halfBeamwidth)
{
  for (int box = 0; box < count; ++box)
  {
    const double azimuth = 2.0 * Pi * box / count;
    const Vec3 center(std::cos(azimuth), std::sin(azimuth), 0.0);
    const double angle = std::acos(glm::dot(unitVector(direction), center));
    if (angle <= 1.01 * (std::asin(std::sqrt(3.0) / Circle) + halfBeamwidth))
    {
      return false;
    }
  }
  return true;
}
}

TEST(PolygonScan, WithATargetErrorBeamsKnownToMeetNothingTraceNoRays)
{
  constexpr int boxes = 24;
  const ScanBeams beams = ring(400);
  for (const TraceMode mode : { TraceMode::Automatic, TraceMode::SingleRays, TraceMode::Beams })
  {
    SCOPED_TRACE(static_cast<int>(mode));
    EchoSettings settings = integrating(400);
    settings.targetRelativeError = 0.05;
    settings.numberOfReflections = 2;
    settings.smallTargets = true;
    settings.traceMode = mode;
    Sensor sensor;
    sensor.halfBeamwidth = 0.01;
    ScanSetup setup = makeSetup(smallBoxes(boxes), sensor, settings);
    TraceCache cache;
    ScanResult result;
    for (const double interval : { 5e-9, 1e-16, 5e-9 })
    {
      SCOPED_TRACE(interval);
      setup.sensor.samplingInterval = interval; // of 1e-16 s no box fits
      setup.sensor.pulseWidth = 0.0;
      setup.settings.lightEnergyConstraint = false;
      finishSetup(setup);
      ASSERT_TRUE(simulateScan(setup, beams, 1, cache, std::size_t(1) << 30, {}, result));
      int passing = 0;
      int sampled = 0;
      for (std::size_t b = 0; b < beams.size(); ++b)
      {
        const BeamReport& report = result.reports[b];
        if (surelyPassesAll(beams.directions[b], boxes, sensor.halfBeamwidth))
        {
          ++passing;
          EXPECT_EQ(report.status, BeamStatus::NoSurface) << b;
          EXPECT_EQ(report.counters.raysTraced, 0u) << b;
          EXPECT_EQ(report.counters.candidates, 0u) << b;
        }
        sampled += report.counters.raysTraced >= static_cast<std::uint64_t>(PilotRays);
      }
      EXPECT_GT(passing, 100);
      EXPECT_LT(passing, 350);
      EXPECT_EQ(sampled > 50, interval < 1e-10);
    }
  }
}

namespace
{
/// Grooves all around that open towards the lidar: light goes from one side to the other.
Scene groovesAround()
{
  Scene scene;
  for (int k = 0; k < 12; ++k)
  {
    const double azimuth = 2.0 * Pi * k / 12;
    const Vec3 along(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Vec3 across(-along.y, along.x, 0.0);
    for (const double side : { -1.0, 1.0 })
    {
      const Vec3 half = 4.0 * (side * across - along);
      scene.plate(60.0 * along + half, half, Vec3(0.0, 0.0, 20.0), k % 2 ? Wall : Metal, k);
    }
  }
  return scene;
}

/// What the beams of a scan cost.
struct Costs
{
  std::ptrdiff_t integrated = 0; ///< beams that traced no rays
  std::uint64_t rays = 0;        ///< of all beams
};
}

TEST(PolygonScan, RaysOfABeamThatIsNowIntegratedNoLongerCount)
{
  for (const double target : { 0.0, 0.2 })
  {
    for (const bool refine : { false, true })
    {
      for (const int reflections : { 1, 2 })
      {
        SCOPED_TRACE(testing::Message() << target << ' ' << refine << ' ' << reflections);
        EchoSettings settings = secondarySettings(100, 2);
        settings.planeIntegration = true;
        settings.targetRelativeError = target;
        settings.refineNearLimit = refine;
        settings.numberOfReflections = reflections;
        settings.lightEnergyConstraint = false; // no polygon is dropped, and no path
        ScanSetup setup = makeSetup(groovesAround(), Sensor{}, settings);
        const ScanBeams beams = ring(120);
        TraceCache cache;
        ScanResult result;
        const auto costsNow = [&](const char* what)
        {
          SCOPED_TRACE(what);
          finishSetup(setup);
          EXPECT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
          const ScanResult fresh = runScan(setup, beams);
          expectSame(result, fresh);
          Costs costs;
          for (std::size_t b = 0; b < beams.size(); ++b)
          {
            const BeamReport& one = result.reports[b];
            const BeamReport& two = fresh.reports[b];
            EXPECT_EQ(one.status, two.status) << b;
            EXPECT_EQ(one.counters.raysTraced, two.counters.raysTraced) << b;
            EXPECT_EQ(one.targetsLeftOut, two.targetsLeftOut) << b;
            costs.rays += one.counters.raysTraced;
          }
          const std::vector<bool> integrated = integratedOf(result);
          costs.integrated = std::count(integrated.begin(), integrated.end(), true);
          for (std::size_t b = 0; b < beams.size(); ++b)
          {
            EXPECT_TRUE(!integrated[b] || result.reports[b].counters.candidates == 0) << b;
          }
          return costs;
        };
        const auto setInterval = [&](double interval)
        {
          setup.sensor.samplingInterval = interval;
          setup.sensor.pulseWidth = 0.0;
        };
        setInterval(1e-16); // no wall fits
        const Costs none = costsNow("none");
        EXPECT_EQ(none.integrated, 0);
        setInterval(5e-9);
        const Costs all = costsNow("all");
        EXPECT_GT(all.integrated, reflections > 1 ? 10 : 50);
        EXPECT_LT(all.rays, none.rays);
        EXPECT_EQ(all.rays > 0, reflections > 1);
        setInterval(1e-16);
        EXPECT_EQ(costsNow("none again").rays, none.rays);
        setInterval(5e-9);
        EXPECT_EQ(costsNow("all again").rays, all.rays);
        // Sharp lobes ask for more nodes than beams may have.
        const SharedVector<Material> materials = setup.materials;
        edit(setup.materials,
          [](std::vector<Material>& copy) {
            std::fill(copy.begin(), copy.end(), Material{ 0.0, 0.5, 1e6 });
          });
        EXPECT_LT(costsNow("lobes").integrated, all.integrated);
        setup.materials = materials;
        EXPECT_EQ(costsNow("no lobes").rays, all.rays);
        setup.settings.raysPerBeam = 30;
        costsNow("fewer rays");
        setup.settings.raysPerBeam = 100;
        EXPECT_EQ(costsNow("more rays").rays, all.rays);
      }
    }
  }
}

//--- status ---------------------------------------------------------------------------------------

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

void expectSameButForCosts(const ScanResult& one, const ScanResult& two)
{
  expectSame(one, two);
  const BeamReport& a = one.reports[0];
  const BeamReport& b = two.reports[0];
  EXPECT_EQ(a.status, b.status);
  EXPECT_TRUE(sameBits(a.range, b.range));
  EXPECT_EQ(a.skipped, b.skipped);
  EXPECT_EQ(a.lost, b.lost);
  EXPECT_EQ(a.targetsLeftOut, b.targetsLeftOut);
}
}

TEST(PolygonScan, ABeamWhoseRaysMissWhatEntersItMeetsNothing)
{
  for (const double target : { 0.0, 0.2 })
  {
    for (const bool refine : { false, true })
    {
      for (const double limit : { 0.0, 25.0, 12.0 }) // photons, of 5 that are noise; 0: no noise
      {
        SCOPED_TRACE(testing::Message() << target << ' ' << refine << ' ' << limit);
        EchoSettings settings = secondarySettings(40);
        settings.planeIntegration = true;
        settings.targetRelativeError = target;
        settings.refineNearLimit = refine;
        settings.smallTargets = false;
        settings.noise = limit > 0.0;
        Sensor sensor;
        sensor.noisePhotonRate = 1e9;
        sensor.lowerEnergyLimit = limit * sensor.photonEnergy();
        // More triangles than may be integrated; and one speck, whose polygons do not fit.
        for (const int count : { 40, 1 })
        {
          SCOPED_TRACE(count);
          ScanSetup setup = makeSetup(specks(count, Vec3(100.0, 0.0, 0.0)), sensor, settings);
          ScanSetup without = makeSetup(specks(count, Vec3(-100.0, 0.0, 0.0)), sensor, settings);
          const ScanResult nothing = runScan(without, oneBeam());
          ASSERT_EQ(nothing.raysTraced, 0u);
          EXPECT_EQ(
            nothing.reports[0].status, limit == 12.0 ? BeamStatus::Echo : BeamStatus::NoSurface);
          EXPECT_EQ(nothing.echoes.empty(), limit != 12.0);
          EXPECT_EQ(without.noise.active, limit > 0.0);
          if (count > 1)
          {
            const ScanResult missed = runScan(setup, oneBeam());
            EXPECT_GE(missed.raysTraced, 32u);
            expectSameButForCosts(missed, nothing);
            continue;
          }
          // Sampled, integrated, and sampled again from what is kept.
          setup.settings.lightEnergyConstraint = false;
          TraceCache cache;
          for (const bool fits : { false, true, false })
          {
            SCOPED_TRACE(fits);
            setup.sensor.samplingInterval = without.sensor.samplingInterval = fits ? 5e-9 : 1e-16;
            setup.sensor.pulseWidth = without.sensor.pulseWidth = 0.0;
            setup.sensor.rangeGate = without.sensor.rangeGate = fits ? 4000.0 : 110.0;
            finishSetup(setup);
            finishSetup(without);
            ScanResult result;
            ASSERT_TRUE(simulateScan(setup, oneBeam(), 1, cache, std::size_t(1) << 30, {}, result));
            if (fits)
            {
              EXPECT_EQ(result.reports[0].counters.raysTraced, 0u);
              EXPECT_EQ(result.reports[0].status, BeamStatus::Echo);
            }
            else
            {
              EXPECT_GE(result.reports[0].counters.raysTraced, 32u);
              expectSameButForCosts(result, runScan(without, oneBeam()));
            }
          }
        }
      }
    }
  }
}
