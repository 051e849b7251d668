// SPDX-License-Identifier: BSD-3-Clause
// Media that do not fill the scene: crossings against midpoints, boxes that hold everything against
// air that fills it, walls behind and before parts of them.
#include "BeamAir.h"
#include "CollisionTreeBuilder.h"
#include "EchoTestScene.h"
#include "PhotonReceiver.h"
#include "Receiver.h"
#include "Sanitized.h"
#include "ScanTestTown.h"
#include "SecondaryTestScene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace echotest;

namespace
{
Sensor search905()
{
  Sensor sensor;
  sensor.receiverModel = ReceiverModel::Photons;
  sensor.pulseEnergy = 3.6e-4;
  sensor.frequency = SpeedOfLight / 905e-9;
  sensor.halfBeamwidth = 5.6e-3;
  sensor.receiverAperture = 0.0078539816;
  sensor.receiverEfficiency = 0.4;
  sensor.backgroundRadiance = 0.05;
  sensor.filterBandwidth = 10.0;
  sensor.rangeGate = 4000.0;
  EXPECT_EQ(setPhotonLimits(sensor, 1.0, 40.0, 15360.0), "");
  return sensor;
}

MediumVolume boxOf(const Vec3& centre, const Vec3& half)
{
  MediumVolume box;
  box.shape = MediumShape::Box;
  box.centre = centre;
  box.halfAxes = { Vec3(half.x, 0.0, 0.0), Vec3(0.0, half.y, 0.0), Vec3(0.0, 0.0, half.z) };
  return box;
}

/// The same by a mesh.
MediumVolume meshOf(const MediumVolume& box)
{
  // Corners by bits, sides that face outwards.
  auto of = std::make_shared<TriangleMesh>();
  for (int corner = 0; corner < 8; ++corner)
  {
    Vec3 point = box.centre;
    for (int axis = 0; axis < 3; ++axis)
    {
      point += (corner >> axis & 1 ? 1.0 : -1.0) * box.halfAxes[static_cast<std::size_t>(axis)];
    }
    of->points.push_back(point);
  }
  of->triangles = { { 0, 2, 1 }, { 1, 2, 3 }, { 4, 5, 6 }, { 5, 7, 6 }, { 0, 1, 4 }, { 1, 5, 4 },
    { 2, 6, 3 }, { 3, 6, 7 }, { 0, 4, 2 }, { 2, 4, 6 }, { 1, 3, 5 }, { 3, 7, 5 } };
  MediumVolume mesh = box;
  mesh.shape = MediumShape::Surface;
  mesh.surface = buildCollisionTree(of, TreeOptions{}, {}, 1);
  return mesh;
}

double densityAt(const MediumVolume& volume, const Vec3& point)
{
  const Vec3 p = point - volume.centre;
  Vec3 scaled(0.0);
  for (int i = 0; i < 3; ++i)
  {
    const Vec3& axis = volume.halfAxes[static_cast<std::size_t>(i)];
    scaled[i] = glm::dot(p, axis) / glm::dot(axis, axis);
  }
  switch (volume.shape)
  {
    case MediumShape::Layer:
    {
      const double height = glm::dot(p, volume.up);
      return height < volume.bottom ? 0.0
        : height <= volume.top      ? 1.0
        : volume.softness > 0.0     ? std::exp(-(height - volume.top) / volume.softness)
                                    : 0.0;
    }
    case MediumShape::Ellipsoid:
      return glm::dot(scaled, scaled) < 1.0 ? 1.0 : 0.0;
    default:
      return std::max({ std::fabs(scaled.x), std::fabs(scaled.y), std::fabs(scaled.z) }) < 1.0
        ? 1.0
        : 0.0;
  }
}

ScanSetup inMedium(const Scene& scene, Sensor sensor, const Medium& medium,
  const MediumVolume& volume, bool cells = true)
{
  EchoSettings settings = directSettings(400);
  settings.beamSamples = cells ? BeamSampleSource::Cells : BeamSampleSource::Rays;
  ScanSetup setup = makeSetup(scene, sensor, settings);
  setup.placedMedia = { { medium, volume } };
  planModel(setup);
  return setup;
}

Scene wallAt(double x, double from = -50.0, double to = 50.0)
{
  Scene scene;
  scene.plate(Vec3(x, 0.5 * (from + to), 0.0), Vec3(0.0, 0.5 * (to - from), 0.0),
    Vec3(0.0, 0.0, 50.0), Wall, 7);
  return scene;
}
}

TEST(MediumVolume, CrossingsAreIntegralsOfTheDensity)
{
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<MediumVolume> volumes;
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.up = unitVector(Vec3(0.1, -0.05, 1.0));
  layer.top = 4.0;
  for (const double softness : { 0.0, 5.0, 5.0 })
  {
    layer.bottom = volumes.size() < 2 ? -8.0 : -Infinity;
    layer.softness = softness;
    volumes.push_back(layer);
  }
  MediumVolume turned = boxOf(Vec3(3.0, 1.0, -2.0), Vec3(1.0));
  turned.halfAxes = { 9.0 * unitVector(Vec3(1.0, 1.0, 0.0)), 4.0 * unitVector(Vec3(-1.0, 1.0, 0.0)),
    Vec3(0.0, 0.0, 6.0) };
  volumes.push_back(turned);
  turned.shape = MediumShape::Ellipsoid;
  volumes.push_back(turned);
  volumes.push_back(meshOf(boxOf(Vec3(3.0, 1.0, -2.0), Vec3(9.0, 4.0, 6.0))));
  MediumCrosser crosser;
  for (const MediumVolume& volume : volumes)
  {
    EXPECT_EQ(checkVolume(volume), "");
    int met = 0;
    for (int ray = 0; ray < 60; ++ray)
    {
      // Braces: in this order with every compiler.
      const Vec3 origin = 15.0 * Vec3{ uniform(random), uniform(random), uniform(random) };
      const Vec3 direction = unitVector(Vec3{ uniform(random), uniform(random), uniform(random) });
      constexpr double far = 40.0;
      constexpr int steps = 40000;
      std::vector<MediumCrossing> parts;
      crosser.find(volume, origin, direction, far, 0.0, parts);
      for (const double to : { 7.0, far })
      {
        double sum = 0.0;
        for (int i = 0; i < steps; ++i)
        {
          sum += densityAt(volume, origin + (i + 0.5) / steps * to * direction) * to / steps;
        }
        double ours = 0.0;
        for (const MediumCrossing& part : parts)
        {
          ours += part.upTo(to);
        }
        EXPECT_NEAR(ours, sum, 4.0 * to / steps);
        met += sum > 0.0;
      }
    }
    EXPECT_GT(met, 6);
  }
}

TEST(MediumVolume, NestedShellsAndEitherWayOfFacing)
{
  MediumVolume mesh = meshOf(boxOf(Vec3(10.0, 0.0, 0.0), Vec3(2.0)));
  auto inside = std::make_shared<TriangleMesh>(*mesh.surface->mesh);
  for (auto& triangle : inside->triangles)
  {
    std::swap(triangle[1], triangle[2]);
  }
  mesh.surface = buildCollisionTree(inside, TreeOptions{}, {}, 1);
  MediumCrosser crosser;
  // Along a diagonal of its sides, through an edge, from inside.
  for (const auto& [from, to, length] : { std::tuple(Vec3(0.0), Vec3(1.0, 0.0, 0.0), 4.0),
         std::tuple(Vec3(0.0, 0.0, 1e-3), Vec3(1.0, 0.0, 0.0), 4.0),
         std::tuple(Vec3(10.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0), 2.0),
         std::tuple(Vec3(0.0, 5.0, 0.0), Vec3(1.0, 0.0, 0.0), 0.0) })
  {
    std::vector<MediumCrossing> parts;
    crosser.find(mesh, from, to, 100.0, 0.0, parts);
    double sum = 0.0;
    for (const MediumCrossing& part : parts)
    {
      sum += part.upTo(100.0);
    }
    EXPECT_NEAR(sum, length, 1e-9);
  }
}

TEST(MediumVolume, WhatMovesIsWhereItIsThen)
{
  MediumVolume box = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(5.0));
  box.velocity = Vec3(0.0, 2.0, 0.0);
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), 1e-3);
  MediumCrosser crosser;
  for (const auto& [seconds, isThere] : { std::pair(0.0, true), std::pair(10.0, false) })
  {
    EXPECT_EQ(mayMeet(box, frame, 1e3, seconds), isThere);
    std::vector<MediumCrossing> parts;
    crosser.find(box, Vec3(0.0), Vec3(1.0, 0.0, 0.0), 1e3, seconds, parts);
    EXPECT_EQ(parts.size(), isThere ? 1u : 0u);
  }
}

TEST(MediumVolume, BadOnesAreNamed)
{
  MediumVolume box = boxOf(Vec3(0.0), Vec3(0.0, 1.0, 1.0));
  EXPECT_EQ(checkVolume(box), "half an axis is 0, expected 1e-6 to 1e7 m");
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.bottom = 5.0;
  EXPECT_EQ(checkVolume(layer), "top is 0, expected above the bottom, at most 1e7 m");
  layer.bottom = -1.0;
  layer.softness = -1.0;
  EXPECT_EQ(checkVolume(layer), "softness is -1, expected 0 to 1e6 m");
  box = boxOf(Vec3(std::nan("")), Vec3(1.0));
  EXPECT_NE(checkVolume(box), "");
}

TEST(BeamAir, ABoxThatHoldsEverythingIsAirThatFillsTheScene)
{
  const Sensor sensor = search905();
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.2, 0.1), sensor.halfBeamwidth);
  for (Medium medium : { Medium{ 4e-3, 18.8, 0.0 }, rainOf(10.0, 20.0, {}) })
  {
    const double clear = 1e-4;
    const AirEcho echo(sensor, { medium }, medium.extinction + clear);
    const std::vector<PlacedMedium> placed = { { medium, boxOf(Vec3(0.0), Vec3(1e4)) } };
    const std::vector<Medium> none;
    BeamAir air(sensor, clear, none, placed);
    air.begin(frame, 0.0);
    ASSERT_TRUE(air.isLocal());
    for (const std::int64_t unit : { 0, 1, 3, 20, 300, 1000 })
    {
      const double mean = air.followed(echo, unit);
      EXPECT_NEAR(mean / echo.mean(unit), 1.0, unit == 0 ? 1e-3 : 2e-6) << unit;
      if (medium.drops > 0.0)
      {
        const BeamAir::Share& share = air.sharesOf(unit)[0];
        EXPECT_NEAR(
          share.mean * share.mean * SquareOfDrops / share.drops / echo.variance(unit), 1.0, 1e-5);
      }
    }
    EXPECT_NEAR(air.transmission(500.0), std::exp(-1000.0 * medium.extinction), 1e-12);
    EXPECT_EQ(air.returnsLight(), medium.drops > 0.0);
  }
}

TEST(BeamAir, UnitsAreLookedAtWhereMediaMayBePerceived)
{
  const Sensor sensor = search905();
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth);
  Medium leaves{ 0.15, 11.8, 30.0, SquareOfLeaves };
  leaves.isFollowed = false;
  leaves.sharesGaps = true;
  const double length = sensor.rangeUnitLength();
  const auto unitAt = [=](double range) { return static_cast<std::int64_t>(range / length); };
  // A tree, a gap, and a wood that is deeper than light goes.
  const std::vector<PlacedMedium> placed = { { leaves, boxOf(Vec3(105.0, 0.0, 0.0), Vec3(5.0)) },
    { leaves, boxOf(Vec3(650.0, 0.0, 0.0), Vec3(350.0, 50.0, 50.0)) } };
  const std::vector<Medium> none;
  const std::vector<Medium> rain = { rainOf(10.0, 20.0, {}) };
  const std::int64_t most = std::numeric_limits<std::int64_t>::max();
  BeamAir air(sensor, 1e-4, none, placed);
  air.begin(frame, 0.0);
  EXPECT_EQ(air.nextLooked(0), unitAt(100.0));
  EXPECT_EQ(air.nextLooked(unitAt(200.0)), unitAt(300.0));
  for (std::int64_t unit = 0; unit < unitAt(1100.0); ++unit)
  {
    double mean = 0.0;
    for (const BeamAir::Share& share : air.sharesOf(unit))
    {
      mean += share.mean;
    }
    EXPECT_TRUE(air.nextLooked(unit) == unit || mean < 2e-6 * sensor.lowerEnergyLimit) << unit;
  }
  EXPECT_EQ(air.nextLooked(unitAt(600.0)), most);
  // Air that fills the scene is looked at as far as the receiver says.
  BeamAir inRain(sensor, 1e-3, rain, placed, 20);
  inRain.begin(frame, 0.0);
  EXPECT_EQ(inRain.nextLooked(0), 0);
  EXPECT_EQ(inRain.nextLooked(20), unitAt(100.0));
}

TEST(BeamAir, WhatSurfacesMeetTheAirDoesNotReturn)
{
  const Sensor sensor = search905();
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth);
  const Medium fog{ 4e-3, 18.8, 0.0 };
  const AirEcho echo(sensor, { fog }, fog.extinction);
  const std::vector<Medium> media = { fog };
  const std::vector<PlacedMedium> none;
  const std::vector<PlacedMedium> placed = { { { 0.0, 1.0, 0.0 }, boxOf(Vec3(0.0), Vec3(9.0)) } };
  const double ranges[] = { 100.0, 60.0, 100.2 };
  const double weights[] = { 0.25, 0.25, 0.5 };
  for (const bool isLocal : { false, true })
  {
    BeamAir air(sensor, fog.extinction, media, isLocal ? placed : none);
    air.begin(frame, 0.0);
    EXPECT_EQ(air.isLocal(), isLocal);
    air.take({ ranges, weights, nullptr, 3 });
    for (const auto& [range, open] : { std::pair(30.0, 1.0), std::pair(80.0, 0.75),
           std::pair(120.0, 0.0), std::pair(3000.0, 0.0), std::pair(30.0, 1.0) })
    {
      const auto unit = static_cast<std::int64_t>(range / sensor.rangeUnitLength());
      EXPECT_NEAR(air.followed(echo, unit), open * echo.mean(unit), 1e-5 * echo.mean(unit));
    }
  }
}

TEST(BeamAir, NoRainIsSeenThroughAWall)
{
  Sensor sensor = search905();
  const Medium rain = rainOf(10.0, 20.0, {});
  EchoSettings settings = directSettings(100);
  settings.noise = true;
  settings.attenuationCoefficient = rain.extinction;
  int everywhere = 0;
  for (const bool isLocal : { false, true })
  {
    ScanSetup setup = makeSetup(wallAt(60.0), sensor, settings);
    if (isLocal)
    {
      setup.settings.attenuationCoefficient = 0.0;
      setup.placedMedia = { { rain, boxOf(Vec3(0.0), Vec3(1e4)) } };
    }
    else
    {
      setup.media = { rain };
    }
    planModel(setup);
    const ScanResult result = runScan(setup, alike(200));
    int before = 0;
    int behind = 0;
    for (const Echo& echo : result.echoes)
    {
      before += echo.range < 58.0 && echo.objectId == ObjectOfAir;
      behind += echo.range > 62.0 && echo.objectId == ObjectOfAir;
    }
    EXPECT_GT(before, 500);
    // The same drops either way.
    everywhere = isLocal ? everywhere : before;
    EXPECT_NEAR(before, everywhere, 0.01 * everywhere);
    EXPECT_EQ(behind, 0);
    // Kept beams give the same.
    TraceCache cache;
    ScanResult one, two;
    simulateScan(setup, alike(200), 1, cache, std::size_t(1) << 30, {}, one);
    setup.settings.noise = true;
    simulateScan(setup, alike(200), 3, cache, std::size_t(1) << 30, {}, two);
    expectSame(one, two);
    expectSame(result, one);
  }
}

TEST(BeamAir, SurfacesBehindAreWeakenedWhereTheMediumIs)
{
  Sensor sensor = openSensor(5.6e-3);
  const double clear = onlyEcho(wallAt(200.0), sensor, directSettings(400)).energyReceived;
  const Medium fog{ 0.05, 18.8, 0.0 };
  const double weak = std::exp(-2.0 * 0.05 * 20.0);
  for (const bool cells : { false, true })
  {
    // All of the beam, half of it (the box ends at y = 0), and a wall that only the other half has.
    const auto received = [&](const Scene& scene, const MediumVolume& volume)
    { return receivedFrom(runScan(inMedium(scene, sensor, fog, volume, cells), oneBeam())); };
    const MediumVolume whole = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(10.0, 50.0, 50.0));
    const MediumVolume half = boxOf(Vec3(100.0, -50.0, 0.0), Vec3(10.0, 50.0, 50.0));
    EXPECT_NEAR(received(wallAt(200.0), whole) / clear, weak, 2e-3);
    EXPECT_NEAR(received(wallAt(200.0), meshOf(half)) / clear, 0.5 * (1.0 + weak), 2e-2);
    EXPECT_NEAR(received(wallAt(200.0), half) / clear, 0.5 * (1.0 + weak), 2e-2);
    EXPECT_NEAR(received(wallAt(200.0, 0.0, 50.0), half) / clear, 0.5, 2e-2);
    EXPECT_NEAR(received(wallAt(200.0, -50.0, 0.0), half) / clear, 0.5 * weak, 2e-2);
    EXPECT_NEAR(received(wallAt(80.0), half) / clear, 1.0, 2e-3);
  }
}

TEST(BeamAir, PathsOverTwoReflectionsPassTheMediumToo)
{
  const Scene scene = groove(0.9, Metal);
  Sensor sensor = openSensor(2e-3);
  const Medium fog{ 0.01, 18.8, 0.0 };
  MediumVolume all = boxOf(Vec3(0.0), Vec3(1e4));
  for (const int connections : { 0, 4 })
  {
    EchoSettings settings = directSettings(100);
    settings.beamSamples = BeamSampleSource::Cells;
    settings.numberOfReflections = 2;
    settings.numberOfConnections = connections;
    ScanSetup clear = makeSetup(scene, sensor, settings);
    ScanSetup uniform = clear;
    uniform.settings.attenuationCoefficient = fog.extinction;
    planModel(uniform);
    ScanSetup placed = clear;
    placed.placedMedia = { { fog, all } };
    planModel(placed);
    const ScanBeams beam = oneBeam(Vec3(1.0, 0.0, 0.02));
    const ScanResult a = runScan(uniform, beam);
    const ScanResult b = runScan(placed, beam);
    ASSERT_EQ(a.echoes.size(), b.echoes.size());
    ASSERT_FALSE(a.echoes.empty());
    double ofPaths = 0.0;
    for (std::size_t k = 0; k < a.echoes.size(); ++k)
    {
      EXPECT_NEAR(b.echoes[k].energyReceived / a.echoes[k].energyReceived, 1.0, 2e-3);
      ofPaths += a.echoes[k].secondaryShare;
    }
    EXPECT_GT(ofPaths, 0.01);
  }
}

TEST(BeamAir, ATreeReturnsLightAndLetsPass)
{
  // Beer and Lambert: of the beam exp(-mu L) reaches the wall, and the crown returns the rest by
  // the lidar equation.
  Sensor sensor = openSensor(5.6e-3);
  sensor.receiverAperture = 0.0078539816;
  sensor.samplingInterval = 5e-9;
  Medium leaves{ 0.3, 30.0, 0.0 };
  leaves.isFollowed = false;
  leaves.objectId = 9;
  leaves.sharesGaps = true;
  const MediumVolume crown = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(4.0, 50.0, 50.0));
  const ScanResult result = runScan(inMedium(wallAt(200.0), sensor, leaves, crown), oneBeam());
  ASSERT_EQ(result.echoes.size(), 2u);
  EXPECT_EQ(result.echoes[0].objectId, 9);
  EXPECT_NEAR(result.echoes[0].labelShare, 1.0, 1e-9);
  double crowns = 0.0; // by midpoints
  constexpr int steps = 100000;
  for (int i = 0; i < steps; ++i)
  {
    const double r = 96.0 + 8.0 * (i + 0.5) / steps;
    crowns += sensor.pulseEnergy * 0.3 / 30.0 * sensor.receiverAperture / (r * r) *
      std::exp(-0.3 * (r - 96.0)) * 8.0 / steps;
  }
  EXPECT_NEAR(result.echoes[0].returnEnergy / crowns, 1.0, 1e-4);
  EXPECT_GT(result.echoes[0].range, 96.0);
  EXPECT_LT(result.echoes[0].range, 104.0);
  EXPECT_EQ(result.echoes[1].objectId, 7);
  const double wall =
    receivedFrom(runScan(inMedium(wallAt(200.0), sensor, { 0.0, 1.0, 0.0 }, crown), oneBeam()));
  EXPECT_NEAR(result.echoes[1].returnEnergy / wall, std::exp(-0.3 * 8.0), 2e-3);
}

TEST(BeamAir, FarAndDenseMediaReturnLight)
{
  // Brightest where they begin: mu/S A/r^2 over a unit, by midpoints.
  const Sensor sensor = search905();
  for (const double from : { 240.0, 710.0, 1500.0 })
  {
    for (const double extinction : { 0.5, 1.5, 20.0 })
    {
      Medium leaves{ extinction, 10.5, 0.0, 6.0, 1.0, false, 9, true };
      const std::vector<PlacedMedium> placed = { { leaves,
        boxOf(Vec3(from + 50.0, 0.0, 0.0), Vec3(50.0, 400.0, 400.0)) } };
      const std::vector<Medium> none;
      BeamAir air(sensor, 0.0, none, placed);
      air.begin(makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth), 0.0);
      const auto unit = static_cast<std::int64_t>((from + 1.0) / sensor.rangeUnitLength());
      const double begin = sensor.rangeUnitLength() * static_cast<double>(unit);
      double truth = 0.0;
      constexpr int steps = 20000;
      for (int i = 0; i < steps; ++i)
      {
        const double r = begin + (i + 0.5) / steps * sensor.rangeUnitLength();
        truth += r < from ? 0.0
                          : sensor.pulseEnergy * extinction / 10.5 * sensor.receiverAperture /
            (r * r) * std::exp(-extinction * (r - from)) * sensor.rangeUnitLength() / steps;
      }
      ASSERT_EQ(air.sharesOf(unit).size(), 1u);
      EXPECT_NEAR(air.sharesOf(unit)[0].mean / truth, 1.0, extinction > 10.0 ? 0.3 : 5e-3);
    }
  }
}

TEST(BeamAir, LayersSeenFromHighAbove)
{
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.top = -2.0;
  MediumCrosser crosser;
  for (const double softness : { 0.01, 0.04, 0.5, 5.0 })
  {
    layer.softness = softness;
    for (const double height : { 0.0, 40.0, 500.0 })
    {
      for (const Vec3& direction : { Vec3(0.0, 0.0, -1.0), unitVector(Vec3(1.0, 0.0, -0.02)) })
      {
        std::vector<MediumCrossing> parts;
        crosser.find(layer, Vec3(0.0, 0.0, height), direction, 1e5, 0.0, parts);
        double depth = 0.0;
        const double to = (height + 2.0 + 10.0) / -direction.z; // 10 m below the top
        for (const MediumCrossing& part : parts)
        {
          depth += part.upTo(to);
        }
        const double truth =
          (10.0 + softness * (1.0 - std::exp(-(height + 2.0) / softness))) / -direction.z;
        EXPECT_NEAR(depth / truth, 1.0, 1e-9) << softness << " " << height;
      }
    }
  }
}

TEST(BeamAir, BordersAnywhereInABeam)
{
  // What an opaque half leaves of a beam, against the segment of a disc. The half is a box at any
  // angle, or a layer before a beam of any azimuth, of which the vertical has any angle in the
  // beam.
  const Sensor sensor = openSensor(5.6e-3);
  constexpr double range = 100.0;
  const double radius = range * std::tan(5.6e-3);
  constexpr int angles = 360;
  constexpr int offsets = 399;
  const std::vector<Medium> none;
  for (const bool isLayer : { false, true })
  {
    std::vector<PlacedMedium> placed = { { { 1e9, 18.8, 0.0 }, {} } };
    BeamAir air(sensor, 0.0, none, placed);
    double worst = 0.0;
    double squares = 0.0;
    for (int k = 0; k < angles * offsets; ++k)
    {
      const double angle = 2.0 * Pi * (k % angles) / angles;
      const double offset = 2.0 * (k / angles + 1) / (offsets + 1) - 1.0;
      const Vec3 axis = isLayer ? Vec3(std::cos(angle), std::sin(angle), 0.0) : Vec3(1.0, 0.0, 0.0);
      const Vec3 normal(0.0, std::cos(angle), std::sin(angle));
      MediumVolume half = boxOf(range * axis + (offset * radius + 40.0) * normal, Vec3(40.0));
      half.halfAxes = { Vec3(1e-3, 0.0, 0.0), 40.0 * normal,
        40.0 * Vec3(0.0, -std::sin(angle), std::cos(angle)) };
      if (isLayer)
      {
        half = {};
        half.shape = MediumShape::Layer;
        (offset < 0.0 ? half.top : half.bottom) = offset * radius;
        (offset < 0.0 ? half.bottom : half.top) = offset < 0.0 ? -Infinity : 1e3;
      }
      const double left = isLayer && offset < 0.0 ? -offset : offset; // the layer is below the beam
      const double truth = 1.0 - (std::acos(left) - left * std::sqrt(1.0 - left * left)) / Pi;
      placed[0].volume = half;
      air.begin(makeBeamFrame(Vec3(0.0), axis, 5.6e-3), 0.0);
      const double error = air.transmission(range + 0.1) - truth;
      worst = std::max(worst, std::fabs(error));
      squares += error * error / (angles * offsets);
    }
    // As BeamAir.h states.
    EXPECT_NEAR(worst, isLayer ? 0.093 : 0.095, 1e-3);
    EXPECT_NEAR(std::sqrt(squares), isLayer ? 0.037 : 0.017, 1e-3);
  }
}

TEST(BeamAir, LayersAndMovingBanksWeakenWhatIsInThem)
{
  // The border lies on the axis; a wall below it and one above.
  Sensor sensor = openSensor(5.6e-3);
  const Medium fog{ 0.02, 18.8, 0.0 };
  const double weak = std::exp(-2.0 * 0.02 * 200.0);
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  MediumVolume moving = boxOf(Vec3(0.0, 0.0, -500.0), Vec3(1000.0, 1000.0, 500.0));
  moving.velocity = Vec3(1e-9, 0.0, 0.0);
  for (const bool isAbove : { false, true })
  {
    Scene scene;
    scene.plate(Vec3(200.0, 0.0, isAbove ? 25.0 : -25.0), Vec3(0.0, 50.0, 0.0),
      Vec3(0.0, 0.0, 25.0), Wall, 7);
    const double clear = onlyEcho(scene, sensor, directSettings(400)).energyReceived;
    for (const MediumVolume& volume : { layer, moving })
    {
      const double seen = receivedFrom(runScan(inMedium(scene, sensor, fog, volume), oneBeam()));
      EXPECT_NEAR(seen / clear, isAbove ? 1.0 : weak, isAbove ? 0.02 : 0.1 * weak);
    }
  }
}

TEST(BeamAir, WhatIsKeptOfBeamsDoesNotDependOnTheAirBefore)
{
  Sensor sensor = search905();
  ScanSetup setup = makeSetup(town(), sensor, usual());
  setup.settings.attenuationCoefficient = 4e-3;
  planModel(setup);
  const ScanBeams beams = horizon(90, 4);
  TraceCache cache;
  ScanResult again;
  simulateScan(setup, beams, 1, cache, std::size_t(1) << 30, {}, again);
  setup.media = { { 4e-3, 18.8, 0.0 } };
  simulateScan(setup, beams, 1, cache, std::size_t(1) << 30, {}, again);
  expectSame(runScan(setup, beams), again);
}

TEST(BeamAir, LeavesThatStayReturnTheSameInEveryScan)
{
  Sensor sensor = search905();
  Medium leaves{ 0.5, 30.0, 20.0, SquareOfLeaves, 0.0, false, 9, true };
  const MediumVolume crown = boxOf(Vec3(100.0, 0.0, 0.0), Vec3(4.0, 50.0, 50.0));
  const auto energies = [&](double renewed, int revolution)
  {
    leaves.renewed = renewed;
    ScanSetup setup = inMedium(Scene{}, sensor, leaves, crown);
    setup.noise.active = true; // of leaves alone: the receiver's is far below
    setup.settings.noise = true;
    planModel(setup);
    setup.revolution = revolution;
    std::vector<double> found(300, 0.0);
    const ScanResult result = runScan(setup, alike(300));
    for (std::size_t k = 0; k < result.echoes.size(); ++k)
    {
      found[result.beamOfEcho[k]] += result.echoes[k].energyReceived;
    }
    return found;
  };
  const auto correlation = [](const std::vector<double>& a, const std::vector<double>& b)
  {
    double sa = 0.0, sb = 0.0, saa = 0.0, sbb = 0.0, sab = 0.0;
    const auto n = static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i)
    {
      sa += a[i];
      sb += b[i];
      saa += a[i] * a[i];
      sbb += b[i] * b[i];
      sab += a[i] * b[i];
    }
    return (n * sab - sa * sb) / std::sqrt((n * saa - sa * sa) * (n * sbb - sb * sb));
  };
  EXPECT_GT(correlation(energies(0.0, 1), energies(0.0, 2)), 0.9);
  EXPECT_LT(std::fabs(correlation(energies(1.0, 1), energies(1.0, 2))), 0.2);
  EXPECT_NEAR(correlation(energies(0.5, 1), energies(0.5, 2)), 0.5, 0.2);
}

/// A crown of leaves of 40 cm2 that face all ways, before a wall, and a lidar. Expected values are
/// those of an independent program, which places leaves one by one as discs in space and follows
/// rays to points of the beam and back to points of the aperture: means and standard errors of
/// 4,000 to 16,000 crowns with fixed seeds, of 24 rays each or, where shares of beams are given, of
/// 120.
struct CrownCase
{
  double halfBeamwidth, aperture; ///< rad, m in radius
  double density;                 ///< m2/m3
  double begin, end, wall;        ///< m
  std::array<double, 2> behind;   ///< light of the wall, over that in clear air
  std::array<double, 2> leaves;   ///< 1/m2: share of the pulse that leaves return, 3/2 cos/r2 of it
  /// Shares of beams with less than 2 % and with more than 98 % of the wall's light; below 0: not
  /// known.
  double dark, bright;
};
constexpr CrownCase CrownCases[] = {
  { 5.6e-3, 0.05, 1.0, 8.5, 11.5, 50.0, { 0.0956, 0.0009 }, { 8.244e-3, 2.2e-5 }, -1.0, -1.0 },
  { 3e-3, 0.075, 1.0, 33.5, 36.5, 50.0, { 0.1300, 0.0011 }, { 6.391e-4, 1.5e-6 }, -1.0, -1.0 },
  { 3e-3, 0.075, 0.6, 6.0, 10.0, 14.0, { 0.1687, 0.0017 }, { 1.2149e-2, 6.4e-5 }, -1.0, -1.0 },
  { 9.5e-4, 0.0125, 1.0, 4.0, 6.0, 40.0, { 0.3048, 0.0032 }, { 2.786e-2, 1.9e-4 }, -1.0, -1.0 },
  { 9.5e-4, 0.0125, 1.0, 10.0, 13.0, 15.0, { 0.2054, 0.0035 }, { 6.332e-3, 4.1e-5 }, 0.544, 0.046 },
  { 5.6e-3, 0.05, 1.0, 10.0, 13.0, 15.0, { 0.1639, 0.0018 }, { 6.149e-3, 2.6e-5 }, 0.059, 0.0 },
  { 9.5e-4, 0.0125, 0.5, 20.0, 25.0, 40.0, { 0.2518, 0.0031 }, { 1.4892e-3, 9.3e-6 }, 0.289,
    0.015 },
  { 3e-3, 0.075, 1.0, 10.0, 13.0, 40.0, { 0.0795, 0.0017 }, { 6.062e-3, 4.0e-5 }, 0.400, 0.0 },
};

Medium leavesOf(double density)
{
  return { 0.5 * density, 10.5, 250.0 * density, SquareOfLeaves, 1.0, false, 9, true };
}

MediumVolume crownOf(const CrownCase& of)
{
  return boxOf(
    Vec3(0.5 * (of.begin + of.end), 0.0, 0.0), Vec3(0.5 * (of.end - of.begin), 50.0, 50.0));
}

Sensor lidarOf(const CrownCase& of)
{
  Sensor sensor = search905();
  sensor.halfBeamwidth = of.halfBeamwidth;
  sensor.receiverAperture = Pi * of.aperture * of.aperture;
  sensor.pulseEnergy *= 0.0025 / (of.aperture * of.aperture); // so that it receives as much
  sensor.rangeGate = 60.0;
  EXPECT_EQ(setPhotonLimits(sensor, 1e-4, 40.0, 15360.0), "");
  return sensor;
}

TEST(BeamAir, TheWayBackMeetsOtherLeaves)
{
  for (const CrownCase& of : CrownCases)
  {
    const Sensor sensor = lidarOf(of);
    const std::vector<PlacedMedium> placed = { { leavesOf(of.density), crownOf(of) } };
    const std::vector<Medium> none;
    BeamAir air(sensor, 0.0, none, placed);
    air.begin(makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), sensor.halfBeamwidth), 0.0);
    EXPECT_NEAR(air.transmission(of.wall), of.behind[0], 3.0 * of.behind[1]) << of.wall;
    double leaves = 0.0;
    for (std::int64_t unit = 0; unit < 100; ++unit)
    {
      for (const BeamAir::Share& share : air.sharesOf(unit))
      {
        leaves += share.mean * 10.5 / (sensor.pulseEnergy * sensor.receiverAperture);
      }
    }
    EXPECT_NEAR(leaves, of.leaves[0], 3.0 * of.leaves[1]) << of.wall;
    // Along one direction, as coverage sees it.
    air.beginRay(Vec3(0.0), Vec3(1.0, 0.0, 0.0), 0.0);
    EXPECT_NEAR(air.transmission(of.wall), of.behind[0], 3.0 * of.behind[1]) << of.wall;
  }
}

constexpr std::size_t Scans = 1500;

ScanResult throughLeaves(const CrownCase& of, bool noise)
{
  ScanSetup setup = inMedium(wallAt(of.wall), lidarOf(of), leavesOf(of.density), crownOf(of));
  setup.noise.active = noise; // of leaves alone: the receiver's is far below
  setup.settings.noise = noise;
  setup.settings.returnMode = ReturnMode::RangeUnits;
  planModel(setup);
  return runScan(setup, alike(noise ? Scans : 1));
}

TEST(BeamAir, ABeamMeetsLeavesWithAPartOfIt)
{
  int looked = 0;
  for (const CrownCase& of : CrownCases)
  {
    if (of.dark < 0.0 || (IsSanitized && ++looked > 1))
    {
      continue;
    }
    CrownCase without = of;
    without.density = 1e-9;
    const double clear = receivedFrom(throughLeaves(without, false));
    const ScanResult result = throughLeaves(of, true);
    std::vector<double> walls(Scans, 0.0);
    for (std::size_t k = 0; k < result.echoes.size(); ++k)
    {
      const Echo& echo = result.echoes[k];
      walls[result.beamOfEcho[k]] += echo.range > of.end + 1.0 ? echo.energyReceived : 0.0;
    }
    const auto count = [&](double from, double to)
    {
      return static_cast<double>(std::count_if(walls.begin(), walls.end(),
               [=](double energy) { return energy >= from * clear && energy < to * clear; })) /
        static_cast<double>(Scans);
    };
    EXPECT_NEAR(count(-1.0, 0.02), of.dark, 0.045) << of.wall;
    EXPECT_NEAR(count(0.98, 2.0), of.bright, 0.02) << of.wall;
  }
}

/// A crown of 4 m before a wall; where nothing is wider than leaves.
constexpr CrownCase ThinRay{ 1e-8, 1e-6, 1.0, 18.0, 22.0, 40.0, {}, {}, 0.0, 0.0 };

TEST(BeamAir, AThinRayEndsAtItsFirstLeafOrPasses)
{
  const double left = std::exp(-2.0);
  const ScanResult result = throughLeaves(ThinRay, true);
  std::vector<double> depths(Scans, 0.0);
  std::vector<double> walls(Scans, 0.0);
  for (std::size_t k = 0; k < result.echoes.size(); ++k)
  {
    const Echo& echo = result.echoes[k];
    const std::size_t beam = result.beamOfEcho[k];
    if (echo.objectId == 9)
    {
      EXPECT_EQ(depths[beam], 0.0) << "leaves at two depths";
      depths[beam] = echo.range - 18.0;
    }
    walls[beam] += echo.objectId == 7 ? echo.energyReceived : 0.0;
  }
  const double unit = Sensor{ search905() }.rangeUnitLength();
  const double end = unit * std::ceil(18.0 / unit); // of the first unit in the crown
  double passed = 0.0, first = 0.0;
  for (std::size_t beam = 0; beam < depths.size(); ++beam)
  {
    passed += walls[beam] > 0.0 ? 1.0 : 0.0;
    first += depths[beam] > 0.0 && depths[beam] < end - 18.0 ? 1.0 : 0.0;
    EXPECT_NE(walls[beam] > 0.0, depths[beam] > 0.0);
  }
  const auto within = [](double count, double share)
  {
    EXPECT_NEAR(count, static_cast<double>(Scans) * share,
      3.0 * std::sqrt(static_cast<double>(Scans) * share * (1.0 - share)));
  };
  within(passed, left);
  within(first, 1.0 - std::exp(-0.5 * (end - 18.0)));
}

TEST(BeamAir, NoiseOfLeavesLeavesTheMean)
{
  for (const double halfBeamwidth : { 1e-4, 1e-3, 4e-3, 2e-2 })
  {
    if (IsSanitized && halfBeamwidth != 4e-3)
    {
      continue;
    }
    const auto sums = [&](bool noise)
    {
      std::array<double, 4> sum{}; // leaves, wall, and squares over all beams
      CrownCase of = ThinRay;
      of.halfBeamwidth = halfBeamwidth;
      of.aperture = 0.05;
      const ScanResult result = throughLeaves(of, noise);
      std::vector<std::array<double, 2>> beams(noise ? Scans : 1);
      for (std::size_t k = 0; k < result.echoes.size(); ++k)
      {
        beams[result.beamOfEcho[k]][result.echoes[k].range > 30.0] +=
          result.echoes[k].energyReceived;
      }
      for (const auto& beam : beams)
      {
        for (std::size_t i = 0; i < 2; ++i)
        {
          sum[i] += beam[i] / static_cast<double>(beams.size());
          sum[i + 2] += beam[i] * beam[i] / static_cast<double>(beams.size());
        }
      }
      return sum;
    };
    const auto noisy = sums(true);
    const auto mean = sums(false);
    for (std::size_t i = 0; i < 2; ++i)
    {
      const double error =
        std::sqrt((noisy[i + 2] - noisy[i] * noisy[i]) / static_cast<double>(Scans));
      EXPECT_NEAR(noisy[i], mean[i], 3.5 * error + 2e-3 * mean[i])
        << halfBeamwidth << (i == 0 ? " leaves" : " wall");
    }
  }
}

TEST(BeamAir, AnyThreadsAndPartsGiveTheSameBits)
{
  Sensor sensor = search905();
  EchoSettings settings = usual();
  ScanSetup setup = makeSetup(town(), sensor, settings);
  Medium leaves{ 0.5, 30.0, 100.0, SquareOfLeaves, 0.3, false, 9, true };
  MediumVolume layer;
  layer.shape = MediumShape::Layer;
  layer.top = 3.0;
  layer.softness = 4.0;
  MediumVolume crown = boxOf(Vec3(40.0, 30.0, 4.0), Vec3(6.0, 5.0, 4.0));
  crown.shape = MediumShape::Ellipsoid;
  setup.placedMedia = { { { 0.01, 18.8, 0.0 }, layer }, { leaves, crown },
    { rainOf(20.0, 20.0, {}), boxOf(Vec3(-100.0, 0.0, 0.0), Vec3(60.0, 80.0, 100.0)) } };
  planModel(setup);
  const ScanBeams beams = horizon(180, 4);
  const ScanResult one = runScan(setup, beams, 1);
  ASSERT_GT(one.echoes.size(), 100u);
  expectSame(one, runScan(setup, beams, 3));
  int leavesSeen = 0, rain = 0;
  for (const Echo& echo : one.echoes)
  {
    leavesSeen += echo.objectId == 9;
    rain += echo.objectId == ObjectOfAir;
  }
  EXPECT_GT(leavesSeen, 0);
  EXPECT_GT(rain, 100);
  // Lit again in other weather, and back: nothing is traced.
  TraceCache cache;
  ScanResult again;
  simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, again);
  expectSame(one, again);
  ScanSetup other = setup;
  other.placedMedia[0].medium.extinction = 0.05;
  simulateScan(other, beams, 2, cache, std::size_t(1) << 30, {}, again);
  EXPECT_EQ(again.beamsTraced, 0u);
  expectSame(runScan(other, beams, 1), again);
  simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, again);
  expectSame(one, again);
}
