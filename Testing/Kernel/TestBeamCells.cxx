// SPDX-License-Identifier: BSD-3-Clause
// Beams that many triangles enter. Oracles: one plate in place of its parts, very many rays, closed
// forms of shares. Birds before walls are TestBird's.
#include "CellTestScene.h"
#include "ScanTestTown.h"

#include "DiscPolygon.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace celltest;

TEST(BeamCells, AWallOfManyPartsReturnsWhatOnePlateReturns)
{
  struct Wall
  {
    Vec3 u;
    double height;
    int parts;
    Material material;
    double error;
  };
  std::vector<Wall> walls = { { Vec3(0.0, 2.0, 0.0), 2.0, 12, Matt, 2e-4 },
    { Vec3(3.0, 2.0, 0.0), 2.0, 12, Matt, 2e-4 }, { Vec3(20.0, 2.0, 0.0), 2.0, 12, Matt, 2e-3 } };
  for (const double exponent : { 10.0, 1e3, 1e4, 1e5, 1e6 })
  {
    // From lobes as wide as the beam to those of a tenth of it.
    walls.push_back({ Vec3(0.1, 4.0, 0.0), 4.0, 20, { 0.05, 0.8, exponent }, 0.01 });
  }
  for (const Wall& wall : walls)
  {
    const Vec3 middle(100.0, 0.0, 0.0);
    const Vec3 up(0.0, 0.0, wall.height);
    Scene plate;
    plate.plate(middle, wall.u, up, wall.material, 1);
    Scene parts;
    fine(parts, middle, wall.u, up, wall.parts, wall.material, 1);
    for (const BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
    {
      Sensor sensor = openSensor();
      sensor.beamProfile = profile;
      const double one = received(plate, sensor, inCells());
      for (const int rays : { 5, 20, 100, 400 })
      {
        if (wall.material.ks > 0.0 && rays < 100)
        {
          continue; // a glint needs them
        }
        SCOPED_TRACE(testing::Message() << wall.u.x << ' ' << wall.material.kp << ' ' << rays);
        // What hangs on the jitter alone: the plate fills the beam.
        const double error =
          profile == BeamProfile::Gaussian ? std::max(wall.error, 5e-3) : wall.error;
        EXPECT_NEAR(
          received(parts, sensor, inCells(rays)) / one, 1.0, error * std::max(1.0, 40.0 / rays));
      }
    }
  }
}

TEST(BeamCells, RangeUnitsOfAWallAreThoseOfOnePlate)
{
  Sensor sensor = openSensor();
  sensor.samplingInterval = 1e-9;
  sensor.pulseWidth = 3.3e-9;
  const Vec3 tilt(8.0, 2.0, 0.0);
  Scene plate;
  plate.plate(Vec3(100.0, 0.0, 0.0), tilt, Vec3(0.0, 0.0, 2.0), Matt, 1);
  EchoSettings settings = inCells(400);
  settings.returnMode = ReturnMode::All;
  const ScanResult one = runScan(makeSetup(plate, sensor, settings), oneBeam());
  const ScanResult many = runScan(makeSetup(fineWall(12, tilt), sensor, settings), oneBeam());
  ASSERT_EQ(one.echoes.size(), many.echoes.size());
  ASSERT_GT(one.echoes.size(), 0u);
  for (std::size_t i = 0; i < one.echoes.size(); ++i)
  {
    EXPECT_NEAR(many.echoes[i].range, one.echoes[i].range, 0.02);
    EXPECT_NEAR(many.echoes[i].energyReceived / one.echoes[i].energyReceived, 1.0, 0.03);
  }
}

TEST(BeamCells, ClutterReturnsWhatManyRaysFind)
{
  double squares = 0.0;
  int within = 0;
  constexpr int scenes = 24;
  for (int seed = 0; seed < scenes; ++seed)
  {
    const Scene scene = clutter(seed);
    const Sensor sensor = openSensor();
    const double truth = received(scene, sensor, directSettings(200000));
    const ScanResult result = runScan(makeSetup(scene, sensor, inCells()), oneBeam());
    EXPECT_EQ(result.reports[0].direct, DirectEcho::Cells);
    EXPECT_FALSE(result.reports[0].isCrowded);
    EXPECT_EQ(result.raysTraced, 0u) << "those of the grid are not traced";
    ASSERT_EQ(result.echoes.size(), 1u);
    const double off = receivedFrom(result) / truth - 1.0;
    squares += off * off;
    const double error = result.echoes[0].energyStdError / truth;
    within += std::fabs(off) <= 2.0 * error + 5e-4 ? 1 : 0;
    EXPECT_LT(error, 0.01);
  }
  EXPECT_LT(std::sqrt(squares / scenes), 0.006);
  EXPECT_GE(within, scenes - 2);
}

TEST(BeamCells, CrowdedBeamsDependOnNoTree)
{
  Numbers random(3);
  Scene scene;
  for (int k = 0; k < 600; ++k)
  {
    const Vec3 at(random(60.0, 120.0), random(-0.6, 0.6), random(-0.6, 0.6));
    const double edge = random(0.005, 0.2);
    scene.box(at, edge * Vec3(random(0.0, 1.0), random(0.0, 1.0), random(0.0, 1.0)), Matt, k);
  }
  scene.plate(Vec3(140.0, 0.0, 0.0), Vec3(20.0, 20.0, 0.0), Vec3(0.0, 0.0, 20.0), Wall, 7777);
  const ScanBeams beams = alike(6);
  TreeOptions options;
  options.maximumLeafSize = 1;
  const ScanResult once = runScan(makeSetup(scene, openSensor(), inCells(), options), beams);
  EXPECT_GT(once.raysTraced, 6 * 3000u);
  for (const int leaf : { 16, 64 })
  {
    options.maximumLeafSize = leaf;
    expectSame(once, runScan(makeSetup(scene, openSensor(), inCells(), options), beams));
  }
}

namespace
{
/// A black wall of many parts, and cubes before it that each fill about a share of the beam. Cubes
/// do not hide each other. @param kds diffuse coefficient of each cube
Scene cubesBeforeAWall(double share, const std::vector<double>& kds, Numbers& random)
{
  const double radius = 1000.0 * std::tan(openSensor().halfBeamwidth);
  const double half = 0.5 * radius * std::sqrt(Pi * share);
  Scene scene;
  fine(scene, Vec3(1100.0, 0.0, 0.0), Vec3(0.0, 8.0, 0.0), Vec3(0.0, 0.0, 8.0), 56,
    { 0.0, 0.0, 1.0 }, 1);
  for (std::size_t k = 0; k < kds.size(); ++k)
  {
    const int column = static_cast<int>(k % 6) - 3;
    const int row = static_cast<int>(k / 6) - 3;
    const double spacing = 0.2 * radius;
    const Vec3 at(1000.0 + half, spacing * (column + 0.5) + random(-0.2, 0.2) * spacing,
      spacing * (row + 0.5) + random(-0.2, 0.2) * spacing);
    scene.box(at, Vec3(half), { kds[k], 0.0, 1.0 }, 10 + static_cast<int>(k));
  }
  return scene;
}
}

TEST(BeamCells, ObjectsThatAreHeardOnlyTogetherHaveEnoughRays)
{
  // One of 36 cubes returns twice the lower limit, or four return half of the limit, or all return
  // a tenth or a hundredth. Cubes that no echo can show cost few rays.
  constexpr double share = 1e-3;
  Sensor sensor = openSensor();
  double most = 0.0; // rays for cubes that return a tenth of the limit
  for (const double part : { 2.0, 0.5, 0.1, 0.01 })
  {
    const int heard = part > 1.0 ? 1 : part > 0.2 ? 4 : 36;
    double squares = 0.0;
    double rays = 0.0;
    constexpr int scenes = 20;
    for (int seed = 0; seed < scenes; ++seed)
    {
      Numbers random(seed);
      std::vector<double> kds(36, 1e-6);
      std::fill(kds.begin(), kds.begin() + heard, 0.8);
      const Scene scene = cubesBeforeAWall(share, kds, random);
      sensor.lowerEnergyLimit = 0.8 * share * sensor.pulseEnergy / part;
      const ScanResult result = runScan(makeSetup(scene, sensor, inCells(100, seed)), oneBeam());
      EXPECT_TRUE(result.reports[0].isCrowded);
      rays += static_cast<double>(result.raysTraced) / scenes;
      if (part * heard > 1.0)
      {
        ASSERT_EQ(result.echoes.size(), 1u) << part;
        const double expected = 0.8 * heard * share * sensor.pulseEnergy;
        squares += std::pow(receivedFrom(result) / expected - 1.0, 2);
      }
    }
    EXPECT_LT(std::sqrt(squares / scenes), 0.03) << part;
    EXPECT_LT(rays, part == 0.01 ? 0.8 * most : Infinity);
    most = rays;
  }
}

TEST(BeamCells, TinyObjectsAmongManyKeepTheirRays)
{
  // The limit of rays must not be spent on a finer grid, on cells at the rim, or on more rays than
  // an object needs.
  constexpr double share = 5e-5;
  constexpr int count = 16;
  constexpr int scenes = 20;
  Sensor sensor = openSensor();
  sensor.lowerEnergyLimit = 0.01 * share * sensor.pulseEnergy;
  const double radius = 900.0 * std::tan(sensor.halfBeamwidth);
  const double half = 0.5 * radius * std::sqrt(Pi * share);
  double squares = 0.0;
  for (int seed = 0; seed < scenes; ++seed)
  {
    Numbers random(seed);
    Scene scene = cubesBeforeAWall(2.5e-3, std::vector<double>(36, 1e-6), random);
    for (int k = 0; k < count; ++k)
    {
      const double away = 0.97 * radius * std::sqrt(random(0.0, 1.0));
      const double angle = 2.0 * Pi * k / count;
      scene.box(Vec3(900.0 + half, away * std::cos(angle), away * std::sin(angle)), Vec3(half),
        { k == 0 ? 0.8 : 0.01, 0.0, 1.0 }, 100 + k);
    }
    const ScanResult result = runScan(makeSetup(scene, sensor, inCells(100, seed)), oneBeam());
    EXPECT_TRUE(result.reports[0].isCrowded);
    const double expected = (0.8 + (count - 1) * 0.01) * share * sensor.pulseEnergy;
    squares += std::pow(receivedFrom(result) / expected - 1.0, 2);
  }
  EXPECT_LT(std::sqrt(squares / scenes), 0.03);
}

TEST(BeamCells, HalfOfAQuadrilateralMayBeASmallObject)
{
  // The last triangle of a wall and a small one beyond its edge form a quadrilateral.
  Scene scene = fineWall(40);
  const Vec3 a = Vec3(90.0, -0.2, -0.2);
  const Vec3 b = Vec3(90.0, 0.2, -0.2);
  scene.triangle(a, b, Vec3(90.0, 0.0, 0.2), Matt, 1);
  scene.triangle(b, a, Vec3(90.0, 0.0, -0.2 - 0.0008), Material{ 0.9, 0.0, 1.0 }, 2);
  const double share = 0.5 * 0.4 * 0.0008 / (Pi * std::pow(90.0 * std::tan(5.6e-3), 2));
  int found = 0;
  double sum = 0.0;
  constexpr int beams = 40;
  for (int seed = 0; seed < beams; ++seed)
  {
    const double own = shareInCells(scene, openSensor(), seed, 2);
    found += own > 0.0;
    sum += own;
  }
  EXPECT_EQ(found, beams);
  EXPECT_NEAR(sum / beams / share, 1.0, 0.05);
}

TEST(BeamCells, WhatReachesIntoTheBeamIsFound)
{
  // Corners of a large box of its own id that reach over the rim by a few centimetres, before many
  // other triangles; from a share of 1e-5 on it is found, and its area right.
  const Sensor sensor = openSensor();
  const double radius = 1000.0 * std::tan(sensor.halfBeamwidth);
  Numbers random(9);
  int all = 0;
  int found = 0;
  int off = 0;
  for (int k = 0; k < 150; ++k)
  {
    const double angle = random(0.0, 2.0 * Pi);
    const double turn = random(0.0, 2.0 * Pi);
    const double reach = random(0.005, 0.25);
    // A square corner that points to the axis more or less, its tip within the rim.
    const Vec3 inwards(0.0, -std::cos(angle), -std::sin(angle));
    const Vec3 across(0.0, std::sin(angle), -std::cos(angle));
    const Vec3 tip = Vec3(1000.0, 0.0, 0.0) - (radius - reach) * inwards;
    const double skew = 0.3 * std::sin(turn);
    const Vec3 one = -inwards + (0.8 + skew) * across;
    const Vec3 two = -inwards - (0.8 - skew) * across;
    Scene alone;
    alone.triangle(tip, tip + 3.0 * one, tip + 3.0 * two, Matt, 7);
    Scene scene;
    fine(scene, Vec3(1100.0, 0.0, 0.0), Vec3(0.0, 20.0, 0.0), Vec3(0.0, 0.0, 20.0), 30, Wall, 1);
    scene.triangle(tip, tip + 3.0 * one, tip + 3.0 * two, Matt, 7);
    scene.materials.back() = { 0.9, 0.0, 1.0 };
    alone.materials.back() = { 1.0, 0.0, 1.0 };
    const double share = received(alone, sensor, inCells(100, k)) / sensor.pulseEnergy;
    if (share < 1e-5)
    {
      continue;
    }
    const double own = shareInCells(scene, sensor, k, 7);
    ++all;
    found += own > 0.0;
    off += std::fabs(own / share - 1.0) > 0.05;
  }
  EXPECT_GT(all, 100);
  EXPECT_EQ(found, all);
  EXPECT_LE(off, all / 20) << "of " << all;
}

TEST(BeamCells, WhatBeginsBehindTheLidarIsFound)
{
  // A wedge beside the axis from behind the apex to its tip at 500 m, before a wall of many parts.
  const Sensor sensor = openSensor();
  for (const double half : { 1e-3, 1e-2, 0.1 })
  {
    const Vec3 corners[] = { Vec3(-500.0, 0.3, -half), Vec3(500.0, 0.3, 0.0),
      Vec3(-500.0, 0.3, half) };
    Scene alone;
    alone.triangle(corners[0], corners[1], corners[2], Matt, 7);
    Scene scene;
    fine(scene, Vec3(600.0, 0.0, 0.0), Vec3(0.0, 12.0, 0.0), Vec3(0.0, 0.0, 12.0), 30, Wall, 1);
    scene.triangle(corners[0], corners[1], corners[2], Matt, 7);
    const ScanSetup one = makeSetup(alone, sensor, inCells());
    FoundPolygons seen(*one.tree);
    ASSERT_EQ(seen.find(makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth)),
      SeenByBeam::Polygons);
    double share = 0.0;
    seen.polygons->forEach(
      [&](const PlaneSurface&, const PlaneRing& ring) { share += areaInDisc(ring) / Pi; });
    EXPECT_GT(share, 1e-5) << half;
    double mean = 0.0;
    constexpr int seeds = 20;
    for (int seed = 0; seed < seeds; ++seed)
    {
      const double own = shareInCells(scene, sensor, seed, 7);
      EXPECT_NEAR(own / share, 1.0, 0.5) << half;
      mean += own / share / seeds;
    }
    EXPECT_NEAR(mean, 1.0, 0.06) << half;
  }
}

TEST(BeamCells, WiresAreFound)
{
  // Thinner than rays are apart, across the beam before a wall of many parts.
  const Sensor sensor = openSensor();
  const double radius = 100.0 * std::tan(sensor.halfBeamwidth);
  double squares = 0.0;
  int all = 0;
  for (const double width : { 1e-4, 1e-3, 5e-3 })
  {
    for (int k = 0; k < 50; ++k)
    {
      const double angle = 0.1 + 0.06 * k;
      const Vec3 along(0.0, std::cos(angle), std::sin(angle));
      const Vec3 across(0.0, -std::sin(angle), std::cos(angle));
      Scene scene = fineWall(40, Vec3(0.0, 4.0, 0.0));
      scene.plate(
        Vec3(100.0 - 1.0, 0.0, 0.0) + 0.05 * across, 3.0 * along, 0.5 * width * across, Matt, 7);
      const double share = width * 2.0 * std::sqrt(std::pow(0.99 * radius, 2) - 0.05 * 0.05) /
        (Pi * std::pow(0.99 * radius, 2));
      const double own = shareInCells(scene, sensor, k, 7);
      EXPECT_GT(own, 0.0) << width;
      squares += std::pow(own / share - 1.0, 2);
      ++all;
    }
  }
  EXPECT_LT(std::sqrt(squares / all), 0.3);
}
