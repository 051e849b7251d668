// SPDX-License-Identifier: BSD-3-Clause
// Beams that a plane fills, integrated: closed forms (values by 30-digit quadrature), and nothing
// wrong at an edge.
#include "EchoTestScene.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
/// So many rays that any integral takes less time.
constexpr int Very = 10000;

EchoSettings integrating(int rays = Very)
{
  EchoSettings settings = directSettings(rays);
  settings.planeIntegration = true;
  return settings;
}

Material diffuse(double kd)
{
  return { kd, 0.0, 0.0 };
}

/// Plane whose normal makes the angle `tilt` with the axis x, at perpendicular distance `distance`.
Scene plane(double distance, double tilt, const Material& m)
{
  const Vec3 normal(std::cos(tilt), std::sin(tilt), 0.0);
  const Vec3 along(-std::sin(tilt), std::cos(tilt), 0.0);
  const double reach = 1e3 * distance;
  Scene scene;
  scene.plate(distance * normal, reach * along, Vec3(0.0, 0.0, reach), m);
  return scene;
}

bool isIntegrated(const ScanResult& result)
{
  return result.reports[0].status != BeamStatus::NoSurface &&
    result.reports[0].counters.raysTraced == 0;
}

/// The value is right to `tolerance`, and to the bound that is stated with it (the oracles have ten
/// digits).
void expectEnergy(const Scene& scene, const Sensor& sensor, const EchoSettings& settings,
  double expected, double tolerance = 2e-9)
{
  const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam());
  ASSERT_TRUE(isIntegrated(result));
  ASSERT_EQ(result.echoes.size(), 1u);
  const Echo& echo = result.echoes[0];
  EXPECT_NEAR(echo.returnEnergy, expected, tolerance * expected);
  EXPECT_NEAR(echo.returnEnergy, expected, echo.energyStdError + 2e-9 * expected);
  EXPECT_LE(echo.energyStdError, 1e-5 * expected);
  EXPECT_EQ(echo.labelShare, 1.0);
}
}

TEST(PlaneIntegration, NormalIncidenceForBeamwidthsFrom1e9ToOneRadian)
{
  const std::map<double, double> cases = { { 1e-9, 5.256e-5 }, { 1e-4, 5.255999987e-5 },
    { 5.6e-3, 5.255958793e-5 }, { 0.1, 5.242870946e-5 }, { 0.5, 4.934286973e-5 },
    { 1.0, 4.047914460e-5 } };
  for (const auto& [t, energy] : cases)
  {
    for (double h : { 1.0, 500.0 })
    {
      expectEnergy(plane(h, 0.0, diffuse(0.146)), openSensor(t), integrating(), energy);
    }
  }
}

TEST(PlaneIntegration, SpecularLobeAndAttenuation)
{
  EchoSettings settings = integrating();
  settings.attenuationCoefficient = 3.5e-5;
  const std::tuple<Material, double, double> cases[] = { { Wall, 5.6e-3, 6.945739522e-5 },
    { Wall, 0.1, 5.809126810e-5 }, { Glass, 5.6e-3, 2.395239383e-4 },
    { diffuse(0.146), 5.6e-3, 5.075180886e-5 } };
  for (const auto& [material, t, energy] : cases)
  {
    expectEnergy(plane(500.0, 0.0, material), openSensor(t), settings, energy);
  }
}

TEST(PlaneIntegration, GlintNarrowerThanTheBeam)
{
  expectEnergy(plane(500.0, 0.0, { 0.0, 0.852, 1e6 }), openSensor(), integrating(), 4.890315235e-6);
}

TEST(PlaneIntegration, ObliquePlane)
{
  const std::tuple<double, double, double> cases[] = { { 60.0, 5.6e-3, 2.627979397e-5 },
    { 80.0, 5.6e-3, 9.126876663e-6 }, { 60.0, 0.1, 2.621435473e-5 } };
  for (const auto& [alpha, t, energy] : cases)
  {
    expectEnergy(plane(10.0, alpha * Degree, diffuse(0.146)), openSensor(t), integrating(), energy);
  }
}

TEST(PlaneIntegration, ObliquePlaneSpecularAlone)
{
  const std::tuple<Material, double, double> cases[] = {
    { { 0.0, 0.054, 112.0 }, 2.0, 1.475545869e-5 }, { { 0.0, 0.852, 8046.0 }, 0.3, 1.713101409e-4 },
    { { 0.0, 0.852, 8046.0 }, 0.6, 6.063547230e-5 }
  };
  for (const auto& [material, alpha, energy] : cases)
  {
    expectEnergy(plane(10.0, alpha * Degree, material), openSensor(), integrating(), energy);
  }
}

TEST(PlaneIntegration, MeanRangeOnAGrazingPlane)
{
  const Echo echo =
    onlyEcho(plane(3.0, 89.0 * Degree, diffuse(0.146)), openSensor(), integrating());
  EXPECT_NEAR(echo.range, 171.8974132, 1e-7);
}

TEST(PlaneIntegration, GaussianProfile)
{
  for (const auto& [t, energy] :
    { std::pair<double, double>{ 5.6e-3, 5.255971692e-5 }, { 0.5, 5.034994502e-5 } })
  {
    Sensor sensor = openSensor(t);
    sensor.beamProfile = BeamProfile::Gaussian;
    expectEnergy(plane(100.0, 0.0, diffuse(0.146)), sensor, integrating(), energy);
  }
}

TEST(PlaneIntegration, WaveformOfAGrazingGroundPlane)
{
  Scene ground;
  ground.plate(Vec3(0.0, 0.0, -3.0), Vec3(2e5, 0.0, 0.0), Vec3(0.0, 2e5, 0.0), diffuse(0.146));
  const std::map<int, double> deltas = { { 173, 5.549252487e-10 }, { 174, 3.538478918e-9 },
    { 190, 1.069046563e-8 }, { 194, 1.079361529e-8 }, { 200, 1.061714625e-8 },
    { 250, 5.876652661e-9 }, { 300, 2.381221932e-9 }, { 337, 1.092043096e-10 } };
  const std::map<int, double> pulses = { { 173, 7.014949967e-10 }, { 200, 1.050578974e-8 } };
  for (const double width : { 0.0, 5e-9 })
  {
    Sensor sensor = openSensor();
    sensor.samplingInterval = 5e-9;
    sensor.pulseWidth = width;
    EchoSettings settings = integrating();
    settings.attenuationCoefficient = width > 0.0 ? 3.5e-5 : 0.0;
    settings.returnMode = ReturnMode::RangeUnits;
    const ScanResult result = runScan(
      makeSetup(ground, sensor, settings), oneBeam({ std::cos(Degree), 0.0, -std::sin(Degree) }));
    ASSERT_TRUE(isIntegrated(result));
    std::map<std::int64_t, Echo> units;
    double total = 0.0;
    for (const Echo& echo : result.echoes)
    {
      units[static_cast<std::int64_t>(std::floor(echo.range / sensor.rangeUnitLength()))] = echo;
      total += echo.energyReceived;
    }
    for (const auto& [m, energy] : width > 0.0 ? pulses : deltas)
    {
      EXPECT_NEAR(units.at(m).energyReceived, energy, 2e-9 * energy) << m;
      EXPECT_LE(units.at(m).energyStdError, 1e-4 * energy) << m;
    }
    EXPECT_EQ(units.begin()->first, 173);
    EXPECT_EQ(units.rbegin()->first, width > 0.0 ? 338 : 337);
    if (width == 0.0)
    {
      EXPECT_NEAR(total, 9.172912907e-7, 2e-9 * total);
    }
  }
}

TEST(PlaneIntegration, RangesBeyondWholeNumbersOfUnitsAreSampled)
{
  // One more than 2^53 is 2^53: borders of units could be counted for ever.
  Sensor sensor = openSensor(3e-8);
  sensor.samplingInterval = 1e-12;
  sensor.rangeGate = 1e11;
  const ScanResult result =
    runScan(makeSetup(plane(1e13, 0.0, diffuse(0.146)), sensor, integrating()), oneBeam());
  EXPECT_FALSE(isIntegrated(result));
}

//--- edges ----------------------------------------------------------------------------------------

namespace
{
/// A wall of 40 x 40 m in the plane x = 100, object 0.
void addWall(Scene& scene, const Material& m = Wall)
{
  scene.plate(Vec3(100.0, 3.0, -2.0), Vec3(0.0, 20.0, 0.0), Vec3(0.0, 0.0, 20.0), m);
}

/// In one range unit, so that the energy of the beam is that of its echo.
ScanResult scanOf(const Scene& scene, bool integrate, int rays = 100, double t = 5.6e-3)
{
  EchoSettings settings = directSettings(rays);
  settings.planeIntegration = integrate;
  return runScan(makeSetup(scene, openSensor(t), settings), oneBeam());
}

/// The integrated beam gives what very many rays give; or it was sampled. @return whether it was
/// integrated
bool agrees(const Scene& scene, int rays = 100000)
{
  const ScanResult integrated = scanOf(scene, true, 1000);
  if (!isIntegrated(integrated))
  {
    return false;
  }
  const ScanResult sampled = scanOf(scene, false, rays);
  EXPECT_EQ(integrated.echoes.size(), 1u);
  EXPECT_EQ(sampled.echoes.size(), 1u);
  if (integrated.echoes.size() == 1 && sampled.echoes.size() == 1)
  {
    const Echo& one = integrated.echoes[0];
    const Echo& two = sampled.echoes[0];
    EXPECT_NEAR(one.returnEnergy, two.returnEnergy, 5.0 * two.energyStdError + one.energyStdError);
    EXPECT_EQ(one.objectId, two.objectId);
    EXPECT_EQ(one.materialId, two.materialId);
    EXPECT_NEAR(one.range, two.range, 1e-3);
  }
  return true;
}
}

TEST(PlaneIntegrationEdges, AWallWhoseEdgeJustEntersTheBeam)
{
  // The edge lies at 1 - depth half-beamwidths from the axis.
  for (const double depth :
    { -1e-1, -1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4, 1e-2, 1e-1 })
  {
    Scene scene;
    const double edge = 100.0 * std::tan(5.6e-3) * (1.0 - depth);
    scene.plate(Vec3(100.0, edge - 20.0, 0.0), Vec3(0.0, 20.0, 0.0), Vec3(0.0, 0.0, 20.0), Wall);
    const bool integrated = agrees(scene);
    if (depth <= -1e-9)
    {
      EXPECT_TRUE(integrated) << depth;
    }
    if (depth > 2e-7)
    {
      EXPECT_FALSE(integrated) << depth;
    }
    // What lies beyond the edge where it is left out of account is less than the stated bound.
    if (integrated && depth > 0.0)
    {
      const double outside = 4.0 / 3.0 * std::sqrt(2.0) * std::pow(depth, 1.5) / Pi;
      const Echo echo = scanOf(scene, true).echoes.at(0);
      EXPECT_LT(outside, echo.energyStdError / echo.energyReceived) << depth;
    }
  }
}

TEST(PlaneIntegrationEdges, WallsOfManyTriangles)
{
  // A grid whose corners are moved within the plane: sides and corners everywhere in the beam.
  Numbers random(3);
  int integrated = 0;
  constexpr int walls = 40;
  for (int wall = 0; wall < walls; ++wall)
  {
    Scene scene;
    constexpr int n = 4;
    const double size = random(0.8, 20.0);
    const Vec3 u = unitVector(Vec3(random(-0.9, 0.9), 1.0, 0.0));
    const Vec3 v(0.0, 0.0, 1.0);
    Vec3 points[n + 1][n + 1];
    for (int i = 0; i <= n; ++i)
    {
      for (int j = 0; j <= n; ++j)
      {
        points[i][j] = Vec3(100.0, 0.0, 0.0) +
          size * ((i - 0.5 * n + random(-0.3, 0.3)) * u + (j - 0.5 * n + random(-0.3, 0.3)) * v);
      }
    }
    for (int i = 0; i < n; ++i)
    {
      for (int j = 0; j < n; ++j)
      {
        scene.triangle(points[i][j], points[i + 1][j], points[i + 1][j + 1], Wall, 0);
        scene.triangle(points[i][j], points[i + 1][j + 1], points[i][j + 1], Wall, 0);
      }
    }
    integrated += agrees(scene, 20000);
  }
  EXPECT_GE(integrated, walls * 3 / 4);
}

TEST(PlaneIntegrationEdges, WhatStandsInFrontOfAWallIsSeen)
{
  // A small triangle, a thin wire, one that pokes through the wall: anywhere in the beam.
  Numbers random(4);
  for (int k = 0; k < 60; ++k)
  {
    Scene scene;
    addWall(scene);
    const double far = 100.0 * std::tan(5.6e-3);
    const double x = k % 3 == 2 ? 100.0 : random(20.0, 99.9);
    const double shrink = x / 100.0;
    const double angle = random(0.0, 2.0 * Pi);
    const double off = far * shrink * std::sqrt(random(0.0, 0.8));
    const Vec3 at(x, off * std::cos(angle), off * std::sin(angle));
    const double size = random.logUniform(1e-6, 0.2);
    const Vec3 a = at + Vec3(k % 3 == 2 ? -size : 0.0, size, 0.0);
    const Vec3 b = at + Vec3(0.0, k % 3 == 1 ? -50.0 : -size, 0.0);
    const Vec3 c = at + Vec3(k % 3 == 2 ? size : 0.0, 0.0, size);
    scene.triangle(a, b, c, Glass, 1);
    EXPECT_FALSE(isIntegrated(scanOf(scene, true))) << k;
  }
}

TEST(PlaneIntegrationEdges, WhatStandsBehindAWallIsNotSeen)
{
  Scene scene;
  addWall(scene);
  scene.box(Vec3(120.0, 0.0, 0.0), Vec3(5.0, 1.0, 30.0), Glass, 1);
  scene.plate(Vec3(0.0, 0.0, -0.4), Vec3(3000.0, 0.0, 0.0), Vec3(0.0, 3000.0, 0.0), Metal, 2);
  // A floor and a partition that begin at the wall.
  scene.plate(Vec3(105.0, 0.0, 0.1), Vec3(5.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Wood, 3);
  EXPECT_FALSE(agrees(scene)); // the ground enters the beam before the wall
  Scene without;
  addWall(without);
  without.box(Vec3(120.0, 0.0, 0.0), Vec3(5.0, 1.0, 30.0), Glass, 1);
  without.plate(Vec3(105.0, 0.0, 0.1), Vec3(5.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Wood, 3);
  without.plate(Vec3(0.0, 0.0, -2.0), Vec3(3000.0, 0.0, 0.0), Vec3(0.0, 3000.0, 0.0), Metal, 2);
  EXPECT_TRUE(agrees(without));
}

TEST(PlaneIntegrationEdges, DoubtfulWallsAreSampled)
{
  std::map<std::string, Scene> scenes;
  const Vec3 corners[4] = { { 100.0, -20.0, -20.0 }, { 100.0, 20.0, -20.0 }, { 100.0, 20.0, 20.0 },
    { 100.0, -20.0, 20.0 } };
  const auto wallWithout = [&](int skip, const Vec3& middle)
  {
    Scene scene;
    for (int i = 0; i < 4; ++i)
    {
      if (i != skip)
      {
        scene.triangle(corners[i], corners[(i + 1) % 4], middle, Wall, 0);
      }
    }
    return scene;
  };
  const Vec3 inside(100.0, 0.1, 0.2);
  ASSERT_TRUE(isIntegrated(scanOf(wallWithout(-1, inside), true)));
  scenes["hole"] = wallWithout(2, inside);
  scenes["concave"] = wallWithout(-1, inside + Vec3(1e-3, 0.0, 0.0));
  scenes["convex"] = wallWithout(-1, inside - Vec3(1e-3, 0.0, 0.0));
  scenes["twice"] = wallWithout(-1, inside);
  scenes["twice"].triangle(corners[0], corners[1], inside, Wall, 0);
  scenes["overlap of another material"] = wallWithout(-1, inside);
  scenes["overlap of another material"].triangle(
    Vec3(100.0, -9.0, -9.0), Vec3(100.0, 9.0, -9.0), Vec3(100.0, 0.0, 9.0), Glass, 1);
  scenes["T-junction"] = wallWithout(1, inside);
  scenes["T-junction"].triangle(corners[1], corners[2], Vec3(100.0, 10.1, 0.1), Wall, 0);
  scenes["T-junction"].triangle(corners[1], Vec3(100.0, 10.1, 0.1), inside, Wall, 0);
  const Vec3 onSide = 0.998 * inside + 0.002 * corners[2];
  scenes["T-junction"].triangle(Vec3(100.0, 10.1, 0.1), corners[2], onSide, Wall, 0);
  scenes["T-junction"].triangle(Vec3(100.0, 10.1, 0.1), onSide, inside, Wall, 0);
  scenes["crack"] = wallWithout(1, inside);
  scenes["crack"].triangle(corners[1], corners[2], inside + Vec3(0.0, 1e-9, 0.0), Wall, 0);
  scenes["lidar in the plane"].plate(
    Vec3(100.0, 0.0, 0.0), Vec3(50.0, 0.0, 0.0), Vec3(0.0, 0.0, 20.0), Wall);
  scenes["small"].plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 0.3, 0.0), Vec3(0.0, 0.0, 0.3), Wall);
  for (const auto& [name, scene] : scenes)
  {
    EXPECT_FALSE(isIntegrated(scanOf(scene, true))) << name;
    // And so it is as if nothing had been asked for.
    const ScanResult one = scanOf(scene, true);
    const ScanResult two = scanOf(scene, false);
    ASSERT_EQ(one.echoes.size(), two.echoes.size()) << name;
    for (std::size_t i = 0; i < one.echoes.size(); ++i)
    {
      EXPECT_EQ(one.echoes[i].returnEnergy, two.echoes[i].returnEnergy) << name;
      EXPECT_EQ(one.echoes[i].energyStdError, two.echoes[i].energyStdError) << name;
    }
  }
  Scene painted = wallWithout(1, inside);
  painted.triangle(corners[1], corners[2], inside, Glass, 0);
  EXPECT_TRUE(agrees(painted));
  Scene ofTwo = wallWithout(1, inside);
  ofTwo.triangle(corners[1], corners[2], inside, Wall, 1);
  EXPECT_TRUE(agrees(ofTwo));
  Scene turned = wallWithout(-1, inside); // the sides of a triangle are alike
  for (auto& triangle : turned.mesh->triangles)
  {
    std::swap(triangle[0], triangle[1]);
  }
  EXPECT_TRUE(agrees(turned));
}

TEST(PlaneIntegrationEdges, ScenesOfBoxes)
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
    settings.reflectanceModel = static_cast<ReflectanceModel>(random.index(3));
    ScanSetup setup = makeSetup(scene, sensor, settings);
    const ScanBeams beam = oneBeam(Vec3(1.0, random(-0.25, 0.25), random(-0.25, 0.25)));
    const ScanResult one = runScan(setup, beam);
    if (!isIntegrated(one))
    {
      continue;
    }
    ++integrated;
    setup.settings.planeIntegration = false;
    setup.settings.raysPerBeam = 20000;
    const ScanResult two = runScan(setup, beam);
    std::map<double, const Echo*> sampled;
    double energy = 0.0;
    for (const Echo& echo : two.echoes)
    {
      sampled[echo.range] = &echo;
      energy += echo.energyReceived;
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
    EXPECT_NEAR(sum, energy, 2e-3 * energy) << k;
  }
  EXPECT_GE(integrated, 30);
}

//--- scans ----------------------------------------------------------------------------------------

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

TEST(PlaneIntegrationScan, TheSameBitsHoweverItIsDone)
{
  ScanSetup setup = boxesAround();
  const ScanBeams beams = ring(400);
  const ScanResult once = runScan(setup, beams);
  const std::vector<bool> integrated = integratedOf(once);
  const auto number = std::count(integrated.begin(), integrated.end(), true);
  EXPECT_GT(number, 50);
  EXPECT_LT(number, 350);
  expectSameBits(once, runScan(setup, beams, 3));
  setup.settings.batchCollisionDetection = false;
  expectSameBits(once, runScan(setup, beams));
  setup.settings.batchCollisionDetection = true;
  // Few rays share packets, of many some are traced before the search; the more they are, the more
  // integrals take less time.
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
  // With 1,000 beams that see a corner, too.
  EXPECT_GT(std::count(before.begin(), before.end(), true), number);
  setup.settings.raysPerBeam = 31;
  EXPECT_EQ(integratedOf(runScan(setup, beams)), std::vector<bool>(beams.size(), false));
}

TEST(PlaneIntegrationScan, LitAgainIsFresh)
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

TEST(PlaneIntegrationScan, LitAgainWhereRaysToldThatASearchWasInVain)
{
  for (const double target : { 0.0, 0.2 })
  {
    SCOPED_TRACE(target);
    ScanSetup setup = boxesAround();
    setup.settings.targetRelativeError = target;
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
