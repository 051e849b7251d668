// SPDX-License-Identifier: BSD-3-Clause
// The switches of the beam and light-energy constraints change nothing but the work on paths over
// two reflections, up to the bound.
#include "SameEchoes.h"
#include "SecondaryTestScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

using namespace echotest;

namespace
{
Scene rubble(unsigned seed)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  // In an order of its own, as compilers draw the arguments of a call in theirs.
  const auto draw = [&]()
  {
    const double z = uniform(random);
    const double y = uniform(random);
    return Vec3(uniform(random), y, z);
  };
  const Material materials[] = { Wall, Glass, Metal, Wood };
  Scene scene;
  for (int i = 0; i < 300; ++i)
  {
    const Vec3 center = Vec3(50.0, 0.0, 0.0) + Vec3(5.0, 1.0, 1.0) * draw();
    Vec3 corner[3];
    for (Vec3& c : corner)
    {
      c = center + 0.4 * draw();
    }
    scene.triangle(corner[0], corner[1], corner[2], materials[i % 4], i);
  }
  return scene;
}

ScanBeams fan()
{
  ScanBeams beams;
  for (int i = 0; i < 40; ++i)
  {
    addBeam(beams, Vec3(1.0, 0.002 * (i % 8 - 4), 0.002 * (i / 8 - 2)));
  }
  return beams;
}
}

TEST(SecondaryConstraints, NoUnitLosesMoreThanTheFraction)
{
  const Scene scene = rubble(2);
  const Sensor sensor;
  EchoSettings settings = secondarySettings(60);
  settings.returnMode = ReturnMode::RangeUnits;
  settings.lightEnergyConstraint = false;
  const ScanResult full = runScan(makeSetup(scene, sensor, settings), fan());
  const auto all = unitsOf(full);
  settings.lightEnergyConstraint = true;
  std::uint64_t before = full.raysTraced;
  for (const double fraction : { 0.0, 1e-6, 1e-3, 0.1, 1.0, 10.0, 600.0 })
  {
    settings.lightEnergyFraction = fraction;
    const ScanResult fast = runScan(makeSetup(scene, sensor, settings), fan());
    const auto kept = unitsOf(fast);
    const double lower = sensor.lowerEnergyLimit;
    const double bound = 1.000001 * fraction * lower;
    double lost = 0.0;
    for (const auto& [unit, energy] : all)
    {
      const auto found = kept.find(unit);
      const double left = found == kept.end() ? lower : found->second;
      EXPECT_LE(energy - left, bound + 1e-20) << fraction;
      EXPECT_TRUE(found == kept.end() || left <= energy * (1.0 + 1e-12)) << fraction;
      lost += found == kept.end() ? energy : energy - left;
    }
    EXPECT_EQ(lost > 0.0, fraction >= 0.1) << fraction << ", lost " << lost;
    EXPECT_LE(fast.raysTraced, before) << fraction;
    before = fast.raysTraced;
    if (fraction == 600.0) // 60 rays of 10 paths each: each path against Qlow
    {
      EXPECT_TRUE(fast.echoes.empty());
    }
  }
}

TEST(SecondaryConstraints, ABeamWhosePathsTogetherStayBelowTheLimitTracesNone)
{
  // Between the sides of a groove nothing stands in the way, and dark ones leave no path to be cut,
  // so that all paths are received.
  const Material dark{ 0.05, 0.0, 1.0 };
  const Material mirror{ 0.0, 0.4, 1e4 };
  Sensor sensor = openSensor();
  for (const auto& [material, samples] :
    { std::make_pair(dark, BeamSampleSource::Rays), std::make_pair(dark, BeamSampleSource::Cells),
      std::make_pair(mirror, BeamSampleSource::Cells) })
  {
    EchoSettings settings = secondarySettings(100, material.kd > 0.0 ? 2 : 0, samples);
    const Scene scene = groove(45.0 * Degree, material);
    const auto scanWith = [&](double limit, int reflections)
    {
      sensor.lowerEnergyLimit = limit;
      settings.numberOfReflections = reflections;
      return runScan(makeSetup(scene, sensor, settings), oneBeam());
    };
    const double all = receivedFrom(scanWith(0.0, 2));
    const ScanResult seen = scanWith(0.99 * all, 2);
    const ScanResult silent = scanWith(1.01 * all, 2);
    EXPECT_EQ(seen.echoes.size(), 1u);
    EXPECT_TRUE(silent.echoes.empty());
    EXPECT_GT(seen.raysTraced, silent.raysTraced);
    // The rays from which paths start, and none of the paths.
    EXPECT_LE(silent.raysTraced, tracedRaysOf(settings));
    EXPECT_EQ(silent.reports[0].skipped & SkippedBeam, SkippedBeam);
    EXPECT_GE(silent.reports[0].lost, all * (1.0 - 1e-9));
  }
}

namespace
{
/// A slit of which a beam sees 40 m, in many range units.
Scene slit(const Material& material)
{
  return groove(0.7 * Degree, material, 0.0, 60.0);
}

/// Number of rays that a scan traces for paths, besides those from which paths start.
std::uint64_t raysOfPaths(const ScanSetup& setup, const ScanBeams& beams)
{
  ScanSetup once = setup;
  once.settings.numberOfReflections = 1;
  finishSetup(once);
  const std::uint64_t starts =
    setup.settings.numberOfConnections > 0 || setup.settings.beamSamples == BeamSampleSource::Rays
    ? tracedRaysOf(setup.settings)
    : 0;
  const std::uint64_t all = runScan(setup, beams).raysTraced;
  return all - std::min(all, runScan(once, beams).raysTraced + starts);
}
}

TEST(SecondaryConstraints, ABeamWithoutAnyUnitAboveTheLimitTracesNoPath)
{
  // Direct echoes reach 12 times the limit together, and a third of the limit in each unit.
  for (const Material& material : { Material{ 0.2, 0.0, 1.0 }, Material{ 0.05, 0.3, 1e4 } })
  {
    EchoSettings settings =
      secondarySettings(100, material.ks > 0.0 ? 0 : 2, BeamSampleSource::Cells);
    settings.returnMode = ReturnMode::RangeUnits;
    Sensor sensor;
    sensor.lowerEnergyLimit = 1e-14;
    const ScanSetup open = makeSetup(slit(material), sensor, settings);
    const ScanResult all = runScan(open, oneBeam());
    double strongest = 0.0;
    double sum = 0.0;
    for (const Echo& echo : all.echoes)
    {
      strongest = std::max(strongest, echo.energyReceived);
      sum += echo.energyReceived;
    }
    ASSERT_GT(raysOfPaths(open, oneBeam()), 0u);
    sensor.lowerEnergyLimit = 3.0 * strongest;
    ASSERT_GT(sum, 4.0 * sensor.lowerEnergyLimit);
    const ScanSetup setup = makeSetup(slit(material), sensor, settings);
    const ScanResult silent = runScan(setup, oneBeam());
    EXPECT_EQ(raysOfPaths(setup, oneBeam()), 0u);
    EXPECT_EQ(silent.reports[0].skipped & SkippedBeam, SkippedBeam);
    EXPECT_GE(silent.reports[0].lost, strongest * (1.0 - 1e-9));
    EXPECT_LT(silent.reports[0].lost, sensor.lowerEnergyLimit);
  }
}

TEST(SecondaryConstraints, BeyondTheGateNoPathIsTraced)
{
  EchoSettings settings = secondarySettings(100, 8, BeamSampleSource::Cells);
  Sensor sensor;
  const Scene scene = groove(45.0 * Degree, { 0.4, 0.25, 1e4 }); // 99 to 100 m away
  ASSERT_GT(raysOfPaths(makeSetup(scene, sensor, settings), oneBeam()), 0u);
  sensor.rangeGate = 90.0;
  const ScanSetup setup = makeSetup(scene, sensor, settings);
  EXPECT_EQ(raysOfPaths(setup, oneBeam()), 0u);
  const BeamReport report = runScan(setup, oneBeam()).reports[0];
  EXPECT_EQ(report.status, BeamStatus::OutsideGate);
  EXPECT_EQ(report.skipped, 0u);
}

TEST(SecondaryConstraints, EchoesKeepTheirBitsWhateverIsLeftOut)
{
  // With the fraction 0 only paths that no echo can contain are left out.
  Scene scenes[] = { rubble(2), rubble(3), slit({ 0.05, 0.3, 1e4 }) };
  scenes[2].plate(Vec3(40.0, 0.1, 0.0), Vec3(0.0, 0.1, 0.0), Vec3(0.0, 0.0, 1.0), Wall, 2);
  std::uint64_t rays[2][2] = {}; // without and with an aperture
  std::size_t echoes = 0;
  for (const Scene& scene : scenes)
  {
    for (const auto& [aperture, connections] :
      { std::make_pair(0.0, 0), std::make_pair(0.0, 8), std::make_pair(0.01, 0) })
    {
      Sensor sensor;
      sensor.receiverAperture = aperture;
      EchoSettings settings = secondarySettings(60, connections, BeamSampleSource::Cells);
      settings.lightEnergyFraction = 0.0;
      sensor.lowerEnergyLimit = 1e-14;
      const double all = received(scene, sensor, settings, fan());
      for (const double limit : { 1e-4, 1e-3, 1e-2 })
      {
        sensor.lowerEnergyLimit = limit * all;
        ScanResult results[2];
        for (const bool leaves : { false, true })
        {
          settings.lightEnergyConstraint = leaves;
          results[leaves] = runScan(makeSetup(scene, sensor, settings), fan());
          rays[aperture > 0.0][leaves] += results[leaves].raysTraced;
        }
        EXPECT_TRUE(sameEchoes(results[0], results[1])) << limit << ", aperture " << aperture;
        echoes += results[0].echoes.size();
      }
    }
  }
  EXPECT_GT(echoes, 100u);
  EXPECT_LT(3 * rays[0][1], 2 * rays[0][0]);
  EXPECT_LT(rays[1][1], rays[1][0]);
}

TEST(SecondaryConstraints, TheLimitItselfComparesEachSecondPath)
{
  const Scene scene = groove(45.0 * Degree, { 0.4, 0.25, 1e4 });
  Sensor sensor = openSensor();
  EchoSettings settings = secondarySettings(1); // one ray, so one path
  settings.lightEnergyConstraint = false;
  const double full = received(scene, sensor, settings);
  settings.numberOfReflections = 1;
  const double direct = received(scene, sensor, settings);
  settings.numberOfReflections = 2;
  settings.lightEnergyConstraint = true;
  settings.lightEnergyThreshold = LightEnergyThreshold::Limit;
  const double path = full - direct;
  ASSERT_GT(path, 0.1 * full);
  ASSERT_GT(direct, 1.01 * path);
  sensor.lowerEnergyLimit = 0.99 * path;
  EXPECT_EQ(received(scene, sensor, settings), full);
  sensor.lowerEnergyLimit = 1.01 * path;
  const ScanResult left = runScan(makeSetup(scene, sensor, settings), oneBeam());
  EXPECT_EQ(receivedFrom(left), direct);
  EXPECT_NEAR(left.reports[0].lost / path, 1.0, 1e-9);
}

TEST(SecondaryConstraints, TheLimitPerRayIsTheLimitDividedByTheRays)
{
  const Scene scene = groove(45.0 * Degree, { 0.4, 0.25, 1e4 });
  Sensor sensor = openSensor();
  EchoSettings settings = secondarySettings(100, 2, BeamSampleSource::Rays);
  sensor.lowerEnergyLimit = 0.0;
  const double full = secondaryOf(runScan(makeSetup(scene, sensor, settings), oneBeam()));
  double least = full;
  for (const double limit : { 1e-5, 3e-6, 1e-6, 3e-7 })
  {
    sensor.lowerEnergyLimit = limit;
    settings.lightEnergyThreshold = LightEnergyThreshold::Limit;
    const double whole = secondaryOf(runScan(makeSetup(scene, sensor, settings), oneBeam()));
    settings.lightEnergyThreshold = LightEnergyThreshold::LimitPerRay;
    sensor.lowerEnergyLimit = 100.0 * limit;
    const double perRay = secondaryOf(runScan(makeSetup(scene, sensor, settings), oneBeam()));
    EXPECT_EQ(perRay, whole) << limit;
    least = std::min(least, whole);
  }
  EXPECT_LT(least, 0.99 * full);
}

TEST(SecondaryConstraints, InThickAirWhatIsJustAboveTheLimitIsSeen)
{
  const Scene scene = groove(45.0 * Degree, { 0.4, 0.25, 1e4 });
  Sensor sensor = openSensor();
  EchoSettings settings = secondarySettings(1);
  settings.numberOfReflections = 1;
  settings.attenuationCoefficient = 0.05;
  const double energy = received(scene, sensor, settings);
  ASSERT_GT(energy, 0.0);
  sensor.lowerEnergyLimit = 0.99 * energy;
  EXPECT_EQ(received(scene, sensor, settings), energy);
  sensor.lowerEnergyLimit = 1.01 * energy;
  EXPECT_EQ(received(scene, sensor, settings), 0.0);
}

TEST(SecondaryConstraints, TheLimitItselfComparesEachConnection)
{
  // Without a lobe only connections carry anything after two reflections. As the limit rises past
  // one of them, what is received falls by that one.
  const Scene scene = groove(45.0 * Degree, { 0.4, 0.0, 1.0 });
  Sensor sensor = openSensor();
  EchoSettings settings = secondarySettings(6, 2);
  settings.lightEnergyThreshold = LightEnergyThreshold::Limit;
  const double start = 1e-12;
  sensor.lowerEnergyLimit = start;
  const auto second = [&]()
  { return secondaryOf(runScan(makeSetup(scene, sensor, settings), oneBeam())); };
  settings.lightEnergyConstraint = false;
  const double full = second();
  ASSERT_GT(full, 0.0);
  settings.lightEnergyConstraint = true;
  double before = second();
  EXPECT_NEAR(before / full, 1.0, 1e-12);
  int connections = 0;
  for (double limit = start; before > 0.0; limit *= 1.01)
  {
    ASSERT_LT(limit, 1e-3);
    sensor.lowerEnergyLimit = limit;
    const double now = second();
    const double ratio = (before - now) / limit;
    const double number = std::round(ratio);
    if (before - now > 1e-12 * full)
    {
      ASSERT_GE(number, 1.0) << limit;
      EXPECT_NEAR(ratio / number, 0.995, 0.006) << number << " connections at " << limit;
      connections += static_cast<int>(number);
    }
    before = now;
  }
  EXPECT_GE(connections, 4);
  EXPECT_LE(connections, 12);
}

TEST(SecondaryConstraints, LightEnergyConstraintHoldsThroughAnAperture)
{
  // Through an aperture a narrow lobe returns far more than ks at P2.
  for (double distance : { 0.5, 2.0, 10.0 })
  {
    const Scene scene = changed(groove(45.0 * Degree, { 5e-4, 0.01, 1e4 }),
      [=](const Vec3& p) { return p + Vec3(distance - 100.0, 0.0, 0.0); });
    Sensor sensor = openSensor();
    sensor.receiverAperture = 0.01;
    EchoSettings settings = secondarySettings(100);
    settings.lightEnergyConstraint = false;
    const double full = received(scene, sensor, settings);
    settings.lightEnergyConstraint = true;
    sensor.lowerEnergyLimit = 0.5 * full;
    const double fast = received(scene, sensor, settings);
    EXPECT_NEAR(full, fast, settings.lightEnergyFraction * sensor.lowerEnergyLimit) << distance;
  }
}
