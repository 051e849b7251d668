// SPDX-License-Identifier: BSD-3-Clause
// Mirror paths by regions bring what mirror paths of rays bring.
#include "RoomTestScene.h"
#include "ScanTestTown.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

using namespace echotest;
using statistics::sumOf;

namespace
{
/// J that came after two reflections, by beam.
std::vector<double> secondaryOfBeams(
  const Scene& scene, const ScanBeams& beams, const EchoSettings& settings, double width)
{
  return sumsOfBeams(runScan(makeSetup(scene, openSensor(width), settings), beams), beams.size(),
    [](const Echo& echo) { return echo.returnEnergy * echo.secondaryShare; });
}

EchoSettings mirrorSettings(BeamSampleSource source, int rays)
{
  EchoSettings settings = secondarySettings(rays, 0, source);
  settings.lightEnergyConstraint = false;
  settings.returnMode = ReturnMode::RangeUnits;
  return settings;
}

/// What the beam along x receives over mirrors, by regions and by rays.
void expectSameByRays(const Scene& scene, double width, double tolerance)
{
  const double rays = sumOf(
    secondaryOfBeams(scene, oneBeam(), mirrorSettings(BeamSampleSource::Rays, 100000), width));
  const double regions =
    sumOf(secondaryOfBeams(scene, oneBeam(), mirrorSettings(BeamSampleSource::Cells, 1000), width));
  EXPECT_GT(rays, 0.0);
  EXPECT_NEAR(regions, rays, tolerance * rays);
}
}

TEST(MirrorRegions, SamplesHaveNumbersOfTheirOwn)
{
  // Start and sample of each path: more samples than 2^22, and the last of 1024 surfaces.
  const std::uint32_t many = 1u << 22;
  const std::uint32_t paths[][2] = { { 0, 0 }, { 0, 1 }, { 0, 3 }, { 0, many }, { 0, many + 1 },
    { 1, 0 }, { 1, 1 }, { 1022, many - 1 }, { 1023, many - 1 }, { 1023, 16 * many } };
  const std::uint32_t expected[] = { 0, 1, 3, 4, 5, 6, 7, 9, 11, 12 };
  std::vector<MirrorPath> all(std::size(paths));
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    all[i].start = paths[i][0];
    all[i].one = paths[i][1];
    number = numberAfter(i > 0 ? &all[i - 1] : nullptr, number, all[i]);
    EXPECT_EQ(number, expected[i]) << i;
  }
}

TEST(MirrorRegions, BringWhatRaysBring)
{
  double all = 0.0;
  double ofRays = 0.0;
  int beamsWith = 0;
  for (unsigned seed = 0; seed < 20; ++seed)
  {
    SCOPED_TRACE(seed);
    const Scene scene = room(seed);
    const ScanBeams beams = around(seed, 40);
    const double width = seed % 2 == 0 ? 0.05 : 5.6e-3;
    const std::vector<double> rays =
      secondaryOfBeams(scene, beams, mirrorSettings(BeamSampleSource::Rays, 10000), width);
    const std::vector<double> regions =
      secondaryOfBeams(scene, beams, mirrorSettings(BeamSampleSource::Cells, 2000), width);
    const double most = *std::max_element(rays.begin(), rays.end());
    for (std::size_t i = 0; i < beams.size(); ++i)
    {
      EXPECT_NEAR(regions[i], rays[i], 0.2 * rays[i] + 1e-2 * most) << i;
      beamsWith += rays[i] > 0.0 ? 1 : 0;
    }
    all += sumOf(regions);
    ofRays += sumOf(rays);
  }
  EXPECT_GT(beamsWith, 50);
  EXPECT_NEAR(all, ofRays, 0.01 * ofRays);
}

TEST(MirrorRegions, WhatIsSeenNearlyEdgeOnIsFound)
{
  // A wall at 45 degrees sends the light aside to a strip along the beam, which next to no ray
  // meets. The second strip lies within 5 mm of the wall's plane.
  for (const double start : { 99.5, 100.293 })
  {
    Scene scene;
    scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(5.0, -5.0, 0.0), Vec3(0.0, 0.0, 5.0), Metal);
    const double half = 0.5 * (100.3 - start);
    scene.plate(Vec3(start + half, -0.3, 0.0), Vec3(half, 0.0, 0.0), Vec3(0.0, 0.0, 0.4), Metal, 1);
    expectSameByRays(scene, 5.6e-3, 0.03);
  }
}

namespace
{
/// Two mirrors at a right angle, of `tiles` plates each, which send light back.
void addRetroreflector(Scene& scene, const Vec3& at, double half, int tiles)
{
  const Material mirror{ 0.0, 1.0, 1000.0 };
  for (int k = 0; k < tiles; ++k)
  {
    const Vec3 place = at + Vec3(0.0, 0.0, half * (2.0 * k + 1.0 - tiles) / tiles);
    for (const double side : { -1.0, 1.0 })
    {
      const Vec3 along = 0.5 * half * Root2 * Vec3(-1.0, side, 0.0);
      scene.plate(place + 0.5 * along, 0.5 * along, Vec3(0.0, 0.0, half / tiles), mirror, 7);
    }
  }
}

/// A matt wall that fills the beam, of tiles x tiles plates.
void addTiles(Scene& scene, int tiles)
{
  const double half = 0.8 / tiles;
  for (int k = 0; k < tiles * tiles; ++k)
  {
    const Vec3 place(
      110.0, half * (2 * (k % tiles) + 1 - tiles), half * (2 * (k / tiles) + 1 - tiles));
    scene.plate(place, Vec3(0.0, half, 0.0), Vec3(0.0, 0.0, half), Material{ 0.1, 0.0, 1.0 });
  }
}
}

TEST(MirrorRegions, BeamsOfManySurfacesFollowRays)
{
  Scene scene;
  addRetroreflector(scene, Vec3(100.0, 0.0, 0.0), 0.3, 8);
  addTiles(scene, 56);
  EchoSettings settings = mirrorSettings(BeamSampleSource::Rays, 50000);
  const double truth = sumOf(secondaryOfBeams(scene, oneBeam(), settings, 5.6e-3));
  settings = mirrorSettings(BeamSampleSource::Cells, 200);
  double mean = 0.0;
  for (int seed = 0; seed < 50; ++seed)
  {
    settings.seed = seed;
    mean += sumOf(secondaryOfBeams(scene, oneBeam(), settings, 5.6e-3)) / 50.0;
  }
  EXPECT_NEAR(mean, truth, 0.06 * truth);
  // Paths are kept that a scan without connections must not ask for.
  ScanSeries series(openSensor(), settings, scene, oneBeam());
  for (const int connections : { 2, 0, 2 })
  {
    series.setup.settings.numberOfConnections = connections;
    series.check(std::to_string(connections));
    ASSERT_GT(series.cache.beams[0].view.cells()->surfaces->polygons.size(), 1024u);
  }
}

TEST(MirrorRegions, ASmallRetroreflectorIsFoundWithoutARayOnIt)
{
  // In cells, alone in the sky, and before a matt wall of many plates.
  for (const bool wall : { false, true })
  {
    Scene scene;
    addRetroreflector(scene, Vec3(100.0, 0.1, 0.05), 0.05, 64);
    if (wall)
    {
      addTiles(scene, 16);
    }
    expectSameByRays(scene, 5.6e-3, 0.05);
    // Twenty times as bright as the limit: no beam is dropped.
    Sensor sensor = openSensor();
    sensor.lowerEnergyLimit = 1e-7;
    EchoSettings settings = mirrorSettings(BeamSampleSource::Cells, 100);
    settings.lightEnergyConstraint = true;
    for (int seed = 0; seed < 20; ++seed)
    {
      settings.seed = seed;
      EXPECT_GT(secondaryOf(runScan(makeSetup(scene, sensor, settings), oneBeam())), 2.2e-6)
        << seed;
    }
  }
}

TEST(MirrorRegions, ManySmallRegionsLoseNoMoreThanTheTolerance)
{
  // Upright strips on one side of a corner, lying ones on the other: up to 64 x 64 regions.
  for (const int strips : { 10, 40, 64 })
  {
    Scene scene;
    const Vec3 left = 0.5 * Vec3(-Root2, Root2, 0.0);
    const Vec3 right = 0.5 * Vec3(-Root2, -Root2, 0.0);
    for (int k = 0; k < strips; ++k)
    {
      const double width = 0.8 / strips;
      scene.plate(Vec3(100.0, 0.0, 0.0) + (k + 0.5) * width * left, 0.5 * width * left,
        Vec3(0.0, 0.0, 0.56), { 0.1, 0.0, 1.0 }, 0);
      scene.plate(Vec3(100.0, 0.0, -0.56 + 1.12 * (k + 0.5) / strips) + 0.4 * right, 0.4 * right,
        Vec3(0.0, 0.0, 0.56 / strips), { 0.1, 0.003, 100.0 }, 1);
    }
    EchoSettings settings = secondarySettings(100, 2, BeamSampleSource::Cells);
    settings.returnMode = ReturnMode::RangeUnits;
    settings.lightEnergyConstraint = false;
    const ScanResult all = runScan(makeSetup(scene, openSensor(), settings), oneBeam());
    const double brightest = all.echoes[0].energyReceived;
    settings.lightEnergyConstraint = true;
    for (const double limit : { 1e-3, 1e-2, 0.1, 0.5 })
    {
      Sensor sensor = openSensor();
      sensor.lowerEnergyLimit = limit * brightest;
      const ScanResult some = runScan(makeSetup(scene, sensor, settings), oneBeam());
      const double tolerance = settings.lightEnergyFraction * sensor.lowerEnergyLimit;
      EXPECT_LE(some.reports[0].lost, tolerance) << strips << ' ' << limit;
      ASSERT_FALSE(some.echoes.empty());
      EXPECT_NEAR(some.echoes[0].energyReceived, brightest, tolerance) << strips << ' ' << limit;
    }
  }
}
