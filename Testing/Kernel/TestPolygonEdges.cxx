// SPDX-License-Identifier: BSD-3-Clause
// Beams that a plane fills, integrated: nothing wrong at an edge.
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

using namespace echotest;
using geometrytest::Numbers;

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
  settings.beamSamples = integrate ? BeamSampleSource::Cells : BeamSampleSource::Rays;
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
    // A thing that no ray meets has 1e-5 of the beam at most.
    EXPECT_NEAR(one.returnEnergy, two.returnEnergy,
      5.0 * two.energyStdError + one.energyStdError + 2e-5 * two.returnEnergy);
    EXPECT_EQ(one.objectId, two.objectId);
    EXPECT_EQ(one.materialId, two.materialId);
    EXPECT_NEAR(one.range, two.range, 0.05);
  }
  return true;
}
}

TEST(PolygonEdges, AWallWhoseEdgeJustEntersTheBeam)
{
  // The edge lies at 1 - depth half-beamwidths from the axis.
  for (const double depth :
    { -1e-1, -1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4, 1e-2, 1e-1 })
  {
    Scene scene;
    const double edge = 100.0 * std::tan(5.6e-3) * (1.0 - depth);
    const Material matt{ 0.146, 0.0, 0.0 };
    scene.plate(Vec3(100.0, edge - 20.0, 0.0), Vec3(0.0, 20.0, 0.0), Vec3(0.0, 0.0, 20.0), matt);
    EXPECT_TRUE(agrees(scene)) << depth;
    // The segment beyond the edge.
    const double angle = std::acos(std::min(1.0, 1.0 - depth));
    const double outside = (angle - std::sin(angle) * std::cos(angle)) / Pi;
    Scene whole;
    addWall(whole, matt);
    const Echo echo = scanOf(scene, true).echoes.at(0);
    const Echo all = scanOf(whole, true).echoes.at(0);
    EXPECT_NEAR(echo.energyReceived / all.energyReceived, 1.0 - outside, 1e-5) << depth;
  }
}

TEST(PolygonEdges, WallsOfManyTriangles)
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
  EXPECT_EQ(integrated, walls);
}

TEST(PolygonEdges, WhatStandsInFrontOfAWallIsSeen)
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
    EXPECT_TRUE(agrees(scene)) << k;
  }
}

TEST(PolygonEdges, WhatStandsBehindAWallIsNotSeen)
{
  Scene scene;
  addWall(scene);
  scene.box(Vec3(120.0, 0.0, 0.0), Vec3(5.0, 1.0, 30.0), Glass, 1);
  scene.plate(Vec3(0.0, 0.0, -0.4), Vec3(3000.0, 0.0, 0.0), Vec3(0.0, 3000.0, 0.0), Metal, 2);
  // A floor and a partition that begin at the wall.
  scene.plate(Vec3(105.0, 0.0, 0.1), Vec3(5.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Wood, 3);
  EXPECT_TRUE(agrees(scene)); // the ground enters the beam before the wall
  Scene without;
  addWall(without);
  without.box(Vec3(120.0, 0.0, 0.0), Vec3(5.0, 1.0, 30.0), Glass, 1);
  without.plate(Vec3(105.0, 0.0, 0.1), Vec3(5.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Wood, 3);
  without.plate(Vec3(0.0, 0.0, -2.0), Vec3(3000.0, 0.0, 0.0), Vec3(0.0, 3000.0, 0.0), Metal, 2);
  EXPECT_TRUE(agrees(without));
}

TEST(PolygonEdges, UncertainWallsAreSeenAsRaysSeeThem)
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
  scenes["T-junction"] = wallWithout(1, inside);
  scenes["T-junction"].triangle(corners[1], corners[2], Vec3(100.0, 10.1, 0.1), Wall, 0);
  scenes["T-junction"].triangle(corners[1], Vec3(100.0, 10.1, 0.1), inside, Wall, 0);
  const Vec3 onSide = 0.998 * inside + 0.002 * corners[2];
  scenes["T-junction"].triangle(Vec3(100.0, 10.1, 0.1), corners[2], onSide, Wall, 0);
  scenes["T-junction"].triangle(Vec3(100.0, 10.1, 0.1), onSide, inside, Wall, 0);
  scenes["crack"] = wallWithout(1, inside);
  scenes["crack"].triangle(corners[1], corners[2], inside + Vec3(0.0, 1e-9, 0.0), Wall, 0);
  scenes["small"].plate(Vec3(100.0, 0.0, 0.0), Vec3(0.0, 0.3, 0.0), Vec3(0.0, 0.0, 0.3), Wall);
  for (const auto& [name, scene] : scenes)
  {
    EXPECT_TRUE(agrees(scene)) << name;
  }
  Scene edgeOn; // the lidar lies in its plane
  edgeOn.plate(Vec3(100.0, 0.0, 0.0), Vec3(50.0, 0.0, 0.0), Vec3(0.0, 0.0, 20.0), Wall);
  EXPECT_TRUE(scanOf(edgeOn, true).echoes.empty());
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

TEST(PolygonEdges, ScenesOfBoxes)
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
    settings.reflectanceModel = static_cast<ReflectanceModel>(random.index(4));
    ScanSetup setup = makeSetup(scene, sensor, settings);
    const ScanBeams beam = oneBeam(Vec3(1.0, random(-0.25, 0.25), random(-0.25, 0.25)));
    const ScanResult one = runScan(setup, beam);
    if (!isIntegrated(one))
    {
      continue;
    }
    ++integrated;
    setup.settings.beamSamples = BeamSampleSource::Rays;
    setup.settings.raysPerBeam = 20000;
    const ScanResult two = runScan(setup, beam);
    std::map<double, const Echo*> sampled;
    double energy = 0.0;
    double errors = 0.0;
    for (const Echo& echo : two.echoes)
    {
      sampled[echo.range] = &echo;
      energy += echo.energyReceived;
      errors += echo.energyStdError;
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
    EXPECT_NEAR(sum, energy, 5e-3 * energy + 5.0 * errors) << k;
  }
  EXPECT_GE(integrated, 50);
}
