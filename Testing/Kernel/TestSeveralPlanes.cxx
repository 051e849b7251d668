// SPDX-License-Identifier: BSD-3-Clause
// Beams that several planes fill: corners and edges of convex bodies, ridges of roofs. The solid
// angle of each plane, against line integrals around it; energies against many rays.
#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"
#include "SolidAngleOracle.h"

#include <gtest/gtest.h>

using namespace echotest;
using namespace solidangle;
using geometrytest::Numbers;

namespace
{
/// Number of objects that are not seen.
constexpr int Hidden = 100;

/// A body like an umbrella: its tip, and `sides` sides that fall away from it at random slopes. The
/// normals of convex ones lie within a cone about -x.
struct Umbrella
{
  Vec3 tip;
  std::vector<Vec3> rim;
};

Umbrella umbrella(Numbers& random, int sides, const Vec3& tip, double size, double depth)
{
  Umbrella u;
  u.tip = tip;
  const double turn = random(0.0, 2.0 * Pi);
  for (int i = 0; i < sides; ++i)
  {
    const double angle = turn + 2.0 * Pi * (i + random(-0.2, 0.2)) / sides;
    u.rim.push_back(tip + Vec3(depth, size * std::cos(angle), size * std::sin(angle)));
  }
  return u;
}

Scene sceneOf(const Umbrella& u, const Material& even = Wall, const Material& odd = Wall)
{
  Scene scene;
  const std::size_t n = u.rim.size();
  for (std::size_t i = 0; i < n; ++i)
  {
    scene.triangle(u.tip, u.rim[i], u.rim[(i + 1) % n], i % 2 ? odd : even, static_cast<int>(i));
  }
  return scene;
}

bool hasPatch(const Scene& scene)
{
  const ScanSetup setup = makeSetup(scene, openSensor(), directSettings(10000));
  PatchFinder finder(*setup.tree);
  finder.begin(makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), setup.sensor.halfBeamwidth));
  finder.add(setup.tree->order.data(), static_cast<std::uint32_t>(setup.tree->order.size()));
  return finder.find() != nullptr;
}

ScanResult scanOf(
  const Scene& scene, const Sensor& sensor, bool integrate, int rays, int reflections = 1)
{
  EchoSettings settings = directSettings(rays);
  settings.numberOfReflections = reflections;
  settings.planeIntegration = integrate;
  return runScan(makeSetup(scene, sensor, settings), oneBeam());
}
}

TEST(SeveralPlanes, CornersHaveTheSolidAnglesOfTheirSides)
{
  Numbers random(5);
  int integrated = 0;
  std::size_t most = 0;
  constexpr int cases = 300;
  for (int k = 0; k < cases; ++k)
  {
    const double t = k % 3 == 0 ? random.logUniform(1e-8, 1e-3) : random.logUniform(1e-3, 0.5);
    const double distance = random.logUniform(2.0, 2000.0);
    const double spot = distance * std::tan(t);
    const double size = 5.0 * spot;
    const Vec3 tip(distance, spot * random(-1.2, 1.2), spot * random(-1.2, 1.2));
    // Towards the lidar, or away from it like the corner of a room.
    const double depth = std::min(size * random(0.05, 2.0), 10.0 * distance);
    const int sides = 3 + static_cast<int>(random.index(2));
    const BeamProfile profile = k % 4 == 0 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    const Shares outcome =
      compareShares(sceneOf(umbrella(random, sides, tip, size, depth)), t, profile);
    if (outcome.planes == 0)
    {
      continue;
    }
    ++integrated;
    most = std::max(most, outcome.planes);
    const double tolerance = 1e-8 + 1e-14 / t * (1.0 + depth / size);
    EXPECT_LT(outcome.worst, tolerance) << k << " t " << t;
    EXPECT_LT(outcome.excess, tolerance) << k << " t " << t;
  }
  EXPECT_GT(integrated, cases / 2);
  EXPECT_EQ(most, MostPatchPlanes);
}

TEST(SeveralPlanes, BoxesBeforeOthersAgreeWithTheirVisibleFaces)
{
  Numbers random(17);
  int several = 0;
  for (int k = 0; k < 60; ++k)
  {
    // A box whose front faces turn a corner to the lidar; its back, ground and a wall behind it.
    const double t = random.logUniform(1e-4, 5e-2);
    const double distance = random.logUniform(5.0, 500.0);
    const double spot = distance * std::tan(t);
    const double turn = random(0.2, 1.3);
    const Vec3 left(std::cos(turn), std::sin(turn), 0.0);
    const Vec3 right(std::sin(turn), -std::cos(turn), 0.0);
    const double size = 4.0 * spot;
    const Vec3 corner(distance, spot * random(-0.8, 0.8), 0.0);
    const Vec3 up(0.0, 0.0, size);
    Scene scene;
    const auto face = [&](const Vec3& from, const Vec3& along, const Vec3& across, int object)
    {
      scene.triangle(from, from + along, from + along + across, Wall, object);
      scene.triangle(from, from + along + across, from + across, Wall, object);
    };
    face(corner - up, size * left, 2.0 * up, 0);
    face(corner - up, size * right, 2.0 * up, 1);
    face(corner - up + size * left, size * right, 2.0 * up, Hidden);
    face(corner - up + size * right, size * left, 2.0 * up, Hidden);
    face(corner - up, size * left, size * right, Hidden);
    scene.plate(Vec3(3.0 * distance, 0.0, 0.0), Vec3(0.0, distance, 0.0), Vec3(0.0, 0.0, distance),
      Glass, Hidden);
    const Shares outcome = compareShares(scene, t, BeamProfile::Uniform, Hidden - 1);
    several += outcome.planes == 2;
    if (outcome.planes > 0)
    {
      EXPECT_LT(outcome.worst, 1e-8 + 1e-13 / t) << k;
      EXPECT_LT(outcome.excess, 1e-8) << k;
    }
  }
  EXPECT_GT(several, 40);
}

TEST(SeveralPlanes, EnergiesInRangeUnitsAreThoseOfManyRays)
{
  Numbers random(23);
  int integrated = 0;
  for (int k = 0; k < 12; ++k)
  {
    Sensor sensor = openSensor(k % 2 ? 0.05 : 5.6e-3);
    sensor.samplingInterval = 2e-10;
    sensor.pulseWidth = k % 3 ? 4e-10 : 0.0;
    sensor.beamProfile = k % 4 == 0 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    const double spot = 20.0 * std::tan(sensor.halfBeamwidth);
    const Vec3 tip(20.0, spot * random(-0.5, 0.5), spot * random(-0.5, 0.5));
    const Scene scene =
      sceneOf(umbrella(random, 3, tip, 5.0 * spot, 5.0 * spot * random(0.1, 1.0)), Wall, Glass);
    EchoSettings settings = directSettings(10000);
    settings.returnMode = ReturnMode::RangeUnits;
    settings.planeIntegration = true;
    const ScanResult one = runScan(makeSetup(scene, sensor, settings), oneBeam());
    if (!isIntegrated(one))
    {
      continue;
    }
    ++integrated;
    settings.planeIntegration = false;
    settings.raysPerBeam = 400000;
    const ScanResult many = runScan(makeSetup(scene, sensor, settings), oneBeam());
    std::map<double, const Echo*> sampled;
    double strongest = 0.0;
    for (const Echo& echo : many.echoes)
    {
      sampled[std::floor(echo.range / sensor.rangeUnitLength())] = &echo;
      strongest = std::max(strongest, echo.energyReceived);
    }
    for (const Echo& echo : one.echoes)
    {
      if (echo.energyReceived < 0.01 * strongest)
      {
        continue;
      }
      const auto at = sampled.find(std::floor(echo.range / sensor.rangeUnitLength()));
      ASSERT_NE(at, sampled.end()) << k;
      EXPECT_NEAR(echo.energyReceived, at->second->energyReceived,
        5.0 * at->second->energyStdError + echo.energyStdError)
        << k;
      EXPECT_LT(echo.energyStdError, 1e-4 * echo.energyReceived) << k;
    }
  }
  EXPECT_GT(integrated, 8);
}

TEST(SeveralPlanes, WhereLightMayGoFromOneToTheOtherTwoReflectionsAreSampled)
{
  // A valley, as of two walls of a room: paths over both of them.
  Scene valley;
  const Vec3 up(0.0, 0.0, 5.0);
  const Vec3 fold(20.0, 0.0, 0.0);
  const Vec3 left(15.0, 5.0, 0.0);
  const Vec3 right(15.0, -5.0, 0.0);
  for (const auto& [from, to] : { std::pair<Vec3, Vec3>{ left, fold }, { fold, right } })
  {
    valley.triangle(from - up, to - up, to + up, Wall, 0);
    valley.triangle(from - up, to + up, from + up, Wall, 0);
  }
  const Sensor sensor = openSensor();
  EXPECT_TRUE(isIntegrated(scanOf(valley, sensor, true, 10000, 1)));
  EXPECT_FALSE(isIntegrated(scanOf(valley, sensor, true, 10000, 2)));
  // Seen from its other side it is a ridge.
  Scene ridge;
  for (const auto& [from, to] :
    { std::pair<Vec3, Vec3>{ Vec3(25.0, 5.0, 0.0), fold }, { fold, Vec3(25.0, -5.0, 0.0) } })
  {
    ridge.triangle(from - up, to - up, to + up, Wall, 0);
    ridge.triangle(from - up, to + up, from + up, Wall, 0);
  }
  EXPECT_TRUE(isIntegrated(scanOf(ridge, sensor, true, 10000, 2)));
  // With few rays it is they that take less time.
  EXPECT_FALSE(isIntegrated(scanOf(ridge, sensor, true, 100, 2)));
}

TEST(SeveralPlanes, WhatFoldsOverItselfIsSampled)
{
  // Two turns about a point, joined side by side, the second in another plane: every direction is
  // covered twice.
  Scene scene;
  const Vec3 tip(20.0, 0.0, 0.0);
  const auto at = [&](int i)
  {
    const double angle = 0.5 * Pi * (i % 8);
    const double size = i % 8 == 4 ? 6.0 : 5.0;
    const double slope = i % 8 < 4 ? 0.3 : -0.2;
    const Vec3 across(0.0, size * std::cos(angle), size * std::sin(angle));
    return tip + across + Vec3(i % 4 == 0 ? 0.0 : slope * across.z, 0.0, 0.0);
  };
  for (int i = 0; i < 8; ++i)
  {
    scene.triangle(tip, at(i), at(i + 1), Wall, i);
  }
  EXPECT_FALSE(isIntegrated(scanOf(scene, openSensor(), true, 10000)));
  EXPECT_FALSE(hasPatch(scene));
}

TEST(SeveralPlanes, WhatStandsBeforeACornerIsSeen)
{
  Numbers random(3);
  const Umbrella corner = umbrella(random, 3, Vec3(20.0, 0.01, 0.02), 2.0, 1.0);
  EXPECT_TRUE(isIntegrated(scanOf(sceneOf(corner), openSensor(), true, 10000)));
  for (const double x : { 10.0, 19.99, 20.001, 25.0 })
  {
    // Where a side of the corner has the range x, or far before or behind it.
    Scene scene = sceneOf(corner);
    scene.plate(Vec3(x, 0.06, 0.0), Vec3(0.0, 0.01, 0.0), Vec3(0.0, 0.0, 0.01), Metal, 7);
    const ScanResult one = scanOf(scene, openSensor(), true, 10000);
    EXPECT_EQ(isIntegrated(one), x > 21.0) << x;
    EXPECT_EQ(hasPatch(scene), x > 21.0) << x;
  }
}
