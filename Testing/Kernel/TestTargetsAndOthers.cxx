// SPDX-License-Identifier: BSD-3-Clause
// Small objects with rays of their own disturb nothing else: what hides them, what they stand
// before, other ids, planes that are integrated; and they follow a target error.
#include "SmallTargetScene.h"

#include "SmallTargets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

using namespace avianlidar;
using namespace echotest;

namespace
{
/// A wall across the x axis that fills the beam.
void wallAt(Scene& scene, double range, int object)
{
  scene.plate(Vec3(range, 0.0, 0.0), Vec3(0.0, 50.0, 0.0), Vec3(0.0, 0.0, 50.0), Wall, object);
}

/// An object out of the beam, whose sphere reaches into it.
void beside(Scene& scene)
{
  scene.plate(Vec3(900.0, 5.3, 0.0), Vec3(0.0, 0.2, 0.0), Vec3(0.0, 0.0, 0.3), Matt, 2);
}

/// A sensor that tells what lies 30 m apart.
Sensor rangingSensor()
{
  Sensor sensor = openSensor();
  sensor.samplingInterval = 1e-7;
  sensor.rangeGate = 5000.0;
  return sensor;
}

ScanSetup withoutTargets(ScanSetup setup)
{
  setup.settings.smallTargets = false;
  finishSetup(setup);
  return setup;
}

const Sampling Samplings[] = { Sampling::MonteCarlo, Sampling::Stratified };
}

TEST(TargetsAndOthers, HiddenOnesAndThoseBesideTheBeamChangeNothing)
{
  for (const Sampling sampling : Samplings)
  {
    for (const bool hidden : { true, false })
    {
      Scene scene;
      wallAt(scene, Range, 1);
      hidden ? disc(scene, Vec3(Range + 100.0, 1.0, 0.0), Area, Matt, 2) : beside(scene);
      ScanSetup setup = makeSetup(scene, openSensor(), settingsOf(sampling));
      for (int seed = 0; seed < 50; ++seed)
      {
        setup.settings.seed = seed;
        const ScanResult own = runScan(setup, oneBeam());
        EXPECT_EQ(own.reports[0].counters.raysTraced, 100.0 + RaysOfTarget);
        expectSame(own, runScan(withoutTargets(setup), oneBeam()));
      }
    }
  }
}

TEST(TargetsAndOthers, WhatStandsBehindKeepsItsEchoes)
{
  // Partly before, partly beside its edge, and a smaller wall before it all.
  Scene scene;
  wallAt(scene, Range, 1);
  scene.plate(Vec3(Range - 200.0, 3.0, 0.0), Vec3(0.0, 2.0, 0.0), Vec3(0.0, 0.0, 50.0), Wall, 2);
  disc(scene, Vec3(Range - 100.0, 0.8, 0.0), 1.0, Matt, 3);
  for (const Sampling sampling : Samplings)
  {
    ScanSetup setup = makeSetup(scene, rangingSensor(), settingsOf(sampling));
    int seen = 0;
    for (int seed = 0; seed < 200; ++seed)
    {
      setup.settings.seed = seed;
      const ScanResult own = runScan(setup, oneBeam());
      const ScanResult without = runScan(withoutTargets(setup), oneBeam());
      for (const int object : { 1, 2 })
      {
        const auto echoOf = [object](const ScanResult& result)
        {
          return *std::find_if(result.echoes.begin(), result.echoes.end(),
            [object](const Echo& echo) { return echo.objectId == object; });
        };
        ASSERT_TRUE(sameBits(echoOf(own).energyReceived, echoOf(without).energyReceived));
        ASSERT_TRUE(sameBits(echoOf(own).energyStdError, echoOf(without).energyStdError));
      }
      seen += own.echoes.size() == 3;
    }
    EXPECT_EQ(seen, 200);
  }
}

TEST(TargetsAndOthers, WhichTrianglesAreOneObjectIsKnownWhateverItsId)
{
  // Two discs of one box each, before each other and together: the spheres do not tell.
  const auto sceneOf = [](int first, int second, int wall)
  {
    Scene scene;
    wallAt(scene, Range + 100.0, wall);
    disc(scene, Vec3(Range, 0.0, 0.0), Area, Matt, first);
    disc(scene, Vec3(Range - 1.0, 0.0, 0.0), Area, Matt, first);
    // Every other triangle of both.
    for (std::size_t t = 2; t < scene.objects.size(); t += 2)
    {
      scene.objects[t] = second;
    }
    return scene;
  };
  ScanSetup setup = makeSetup(sceneOf(1, 1, 3), rangingSensor(), settingsOf(Sampling::Stratified));
  TraceCache cache;
  ScanResult result;
  const auto go = [&](const std::vector<int>& ids)
  {
    setup.objectIds = ids;
    finishSetup(setup);
    simulateScan(setup, oneBeam(), 1, cache, std::size_t(1) << 30, {}, result);
    expectSame(runScan(setup, oneBeam()), result);
    return result.raysTraced;
  };
  EXPECT_EQ(go(sceneOf(1, 2, 3).objects), 116u);
  EXPECT_EQ(go(sceneOf(2, 1, 7).objects), 0u);
  EXPECT_EQ(go(sceneOf(9, -5, 4).objects), 0u);
  std::vector<int> swapped = sceneOf(1, 2, 3).objects;
  std::swap(swapped[10], swapped[11]); // the spheres stay
  EXPECT_EQ(go(swapped), 116u);
  EXPECT_EQ(go(sceneOf(1, 1, 3).objects), 108u);
}

TEST(TargetsAndOthers, HowManyAreLeftOutIsReported)
{
  for (const int count : { 10, 30 })
  {
    Scene scene;
    wallAt(scene, Range + 100.0, 0);
    for (int i = 0; i < count; ++i)
    {
      disc(scene, Vec3(Range, 0.3 * (i % 6) - 0.8, 0.3 * (i / 6) - 0.8), 0.02, Matt, 1 + i);
    }
    ScanSetup setup = makeSetup(scene, openSensor(), settingsOf(Sampling::Stratified));
    const std::uint32_t leftOut = count > 16 ? 14u : 0u;
    EXPECT_EQ(runScan(setup, oneBeam()).reports[0].targetsLeftOut, leftOut);
    EXPECT_EQ(runScan(withoutTargets(setup), oneBeam()).reports[0].targetsLeftOut, 0u);
    // Lit again after all of them were too faint to matter.
    TraceCache cache;
    ScanResult result;
    for (const double limit : { 0.0, 1e-1, 0.0 })
    {
      setup.sensor.lowerEnergyLimit = limit;
      finishSetup(setup);
      simulateScan(setup, oneBeam(), 1, cache, std::size_t(1) << 30, {}, result);
      EXPECT_EQ(result.reports[0].targetsLeftOut, limit > 0.0 ? 0u : leftOut);
    }
  }
}

namespace
{
/// What beams down the x axis, each with random numbers of its own, receive of object 1.
struct OfTarget
{
  double mean = 0.0;
  double rms = 0.0;  ///< over the truth
  double rays = 0.0; ///< of the target, without the pilot's
};

OfTarget ofTarget(const ScanSetup& setup, double truth)
{
  constexpr int count = 2000;
  ScanBeams beams;
  for (int i = 0; i < count; ++i)
  {
    beams.ids.push_back(static_cast<std::uint64_t>(i));
    beams.origins.emplace_back(0.0);
    beams.directions.emplace_back(1.0, 0.0, 0.0);
  }
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
  OfTarget found;
  double squares = 0.0;
  for (const Echo& echo : result.echoes)
  {
    const double energy = echo.objectId == 1 ? echo.energyReceived : 0.0;
    found.mean += energy / count;
    squares += energy * (energy - 2.0 * truth) / count;
  }
  found.rms = std::sqrt(squares + truth * truth) / truth;
  for (const BeamTrace& trace : cache.beams)
  {
    found.rays += trace.targets ? trace.targets->at(0) / static_cast<double>(count) : 0.0;
  }
  return found;
}
}

TEST(TargetsAndOthers, TargetErrorIsReached)
{
  // A tilted square: alone, before a wall, half hidden by an edge.
  const double half = 0.5;
  for (const int kind : { 0, 1, 2 })
  {
    Scene scene;
    const Vec3 up(0.0, half * std::sin(0.4), half * std::cos(0.4));
    scene.plate(Vec3(Range, 1.0, 0.3), Vec3(0.0, up.z, -up.y), up, Matt, 1);
    if (kind == 1)
    {
      wallAt(scene, Range + 100.0, 2);
    }
    if (kind == 2)
    {
      scene.plate(
        Vec3(Range - 200.0, -49.2, 0.0), Vec3(0.0, 50.0, 0.0), Vec3(0.0, 0.0, 50.0), Wall, 2);
    }
    ScanSetup setup = makeSetup(scene, rangingSensor(), directSettings(100));
    const OfTarget many = [&]
    {
      ScanSetup brute = withoutTargets(setup);
      brute.settings.raysPerBeam = 4000;
      finishSetup(brute);
      return ofTarget(brute, 1.0);
    }();
    for (const Sampling sampling : Samplings)
    {
      setup.settings.sampling = sampling;
      setup.settings.targetRelativeError = 0.0;
      setup.sensor.lowerEnergyLimit = 0.4 * many.mean;
      finishSetup(setup);
      EXPECT_GT(ofTarget(setup, many.mean).rms, 0.25);
      double last = 8.0;
      for (const double target : { 0.2, 0.1, 0.05 })
      {
        setup.settings.targetRelativeError = target;
        finishSetup(setup);
        const OfTarget found = ofTarget(setup, many.mean);
        EXPECT_LT(found.rms, target) << kind;
        EXPECT_NEAR(found.mean / many.mean, 1.0, 4.0 * target / std::sqrt(2000.0) + 0.002);
        EXPECT_GT(found.rays, 1.2 * last);
        EXPECT_LT(found.rays, 4.0 / (target * target));
        last = found.rays;
      }
    }
    // What cannot be perceived gets no more rays than ever.
    setup.sensor.lowerEnergyLimit = 20.0 * many.mean;
    finishSetup(setup);
    EXPECT_NEAR(ofTarget(setup, many.mean).rays, RaysOfTarget, 1e-9);
  }
}

TEST(TargetsAndOthers, LitAgainWithATargetErrorLikeAFreshScan)
{
  Scene scene = town();
  for (int i = 0; i < 300; ++i)
  {
    const double angle = 2.4 * i;
    const double range = 40.0 + 0.6 * i;
    scene.box(Vec3(range * std::cos(angle), range * std::sin(angle), 0.01 * i),
      Vec3(0.05, 0.05, 0.2), i % 2 ? Metal : Wall, 100 + i);
  }
  const ScanBeams beams = horizon(240, 2);
  for (const bool integrates : { false, true })
  {
    EchoSettings settings = usual();
    settings.targetRelativeError = 0.1;
    settings.planeIntegration = integrates;
    ScanSetup setup = makeSetup(scene, Sensor(), settings);
    TraceCache cache;
    ScanResult result;
    std::size_t more = 0;
    for (const double limit : { 2e-6, 1e-7, 3e-8, 1e-4, 2e-6, 1e-7 })
    {
      setup.sensor.lowerEnergyLimit = limit;
      finishSetup(setup);
      simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
      expectSame(runScan(setup, beams), result);
      for (const BeamTrace& trace : cache.beams)
      {
        more += trace.targets && sumOf(*trace.targets) > RaysOfTarget * trace.targets->size();
      }
    }
    EXPECT_EQ(more > 20u, !integrates); // polygons need no rays of targets
  }
}

TEST(TargetsAndOthers, LitAgainWhereOnlyThePilotsPacketMetAnything)
{
  // Thin posts, whose spheres reach into many beams that see none of them. Pilots go two beams to a
  // packet, the rays that they ask for alone: some beams have pilots of targets, but no rays to
  // draw.
  Scene scene;
  for (int i = 0; i < 600; ++i)
  {
    const double angle = 2.4 * i;
    const double range = 60.0 + 1.5 * i;
    scene.box(Vec3(range * std::cos(angle), range * std::sin(angle), 0.004 * range * ((i % 7) - 3)),
      Vec3(0.02, 0.02, 0.6), i % 2 ? Metal : Wall, 100 + i);
  }
  ScanBeams beams;
  for (int i = 0; i < 480 * 9; ++i)
  {
    const double azimuth = 2.0 * Pi * (i / 9) / 480;
    const double elevation = 0.006 * (i % 9 - 4);
    beams.ids.push_back(static_cast<std::uint64_t>(i));
    beams.origins.emplace_back(0.0);
    beams.directions.emplace_back(std::cos(azimuth) * std::cos(elevation),
      std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
  }
  EchoSettings settings;
  settings.raysPerBeam = 1000;
  settings.targetRelativeError = 0.1;
  settings.noise = false;
  ScanSetup setup = makeSetup(scene, Sensor(), settings);
  TraceCache cache;
  ScanResult result;
  for (const double limit : { 2e-6, 2.4e-6, 3.2e-6 })
  {
    setup.sensor.lowerEnergyLimit = limit;
    finishSetup(setup);
    simulateScan(setup, beams, 1, cache, std::size_t(1) << 30, {}, result);
    expectSame(runScan(setup, beams), result);
  }
}

TEST(TargetsAndOthers, OneBeforeAWallIsIntegratedWithIt)
{
  EchoSettings settings = directSettings(100);
  settings.planeIntegration = true;
  const auto wall = []
  {
    Scene scene;
    wallAt(scene, Range, 1);
    return scene;
  };
  const auto scan = [&settings](const Scene& scene)
  { return runScan(makeSetup(scene, rangingSensor(), settings), oneBeam()); };
  const auto withTarget = [&](const Vec3& place)
  {
    Scene scene = wall();
    scene.plate(place, Vec3(0.0, 0.2, 0.0), Vec3(0.0, 0.0, 0.2), Matt, 2);
    return scan(scene);
  };
  const ScanResult alone = scan(wall());
  ASSERT_EQ(alone.echoes.size(), 1u);
  EXPECT_LT(alone.reports[0].counters.raysTraced, 100u);
  int seen = 0;
  for (int seed = 0; seed < 100; ++seed)
  {
    settings.seed = seed;
    for (const Vec3& place : { Vec3(Range - 100.0, 2.0, 1.0), Vec3(Range - 100.0, 4.9, 0.0) })
    {
      const ScanResult before = withTarget(place);
      EXPECT_EQ(before.reports[0].counters.raysTraced, 0u);
      seen += before.echoes.size() == 2;
    }
  }
  EXPECT_EQ(seen, 200);
  settings.seed = 0;
  Scene scene = wall();
  beside(scene);
  for (const ScanResult& same : { withTarget(Vec3(Range + 100.0, 2.0, 1.0)), scan(scene) })
  {
    expectSame(alone, same);
    EXPECT_EQ(same.reports[0].counters.raysTraced, alone.reports[0].counters.raysTraced);
  }
}
