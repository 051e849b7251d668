// SPDX-License-Identifier: BSD-3-Clause
// The rays that a beam gets for a target error: no bias, the error asked for, nothing wasted. And
// those near the lower limit: enough to tell whether there is an echo, and only there.
#include "RayBudget.h"
#include "ScanTestTown.h"

#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <cstdint>

using namespace echotest;

namespace
{
constexpr double halfBeamwidth = 5.6e-3;
const Material Matt{ 0.146, 0.0, 1.0 };

/// Offset of an edge, in half-beamwidths, beyond which such a share of the cone lies.
double offsetOf(double share)
{
  double low = -1.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i)
  {
    const double d = 0.5 * (low + high);
    const bool more = (std::acos(d) - d * std::sqrt(1.0 - d * d)) / Pi > share;
    (more ? low : high) = d;
  }
  return low;
}

/// A wall 100 m away, normal to the axis, beyond an edge at so many half-beamwidths.
Scene wallBeyond(double offset)
{
  Scene scene;
  const double edge = 100.0 * std::tan(halfBeamwidth * offset);
  scene.plate(Vec3(100.0, edge + 5.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), Matt);
  return scene;
}

/// Received from it (closed form for an edge seen at eps from the axis).
double energyBeyond(double offset)
{
  const double eps = halfBeamwidth * offset;
  const double phi = std::acos(std::tan(eps) / std::tan(halfBeamwidth));
  const double cone = 4.0 * Pi * std::pow(std::sin(0.5 * halfBeamwidth), 2);
  return 3.6e-4 * Matt.kd / cone *
    (phi * std::pow(std::sin(halfBeamwidth), 2) -
      std::sin(eps) * std::atan(std::sin(eps) * std::tan(phi)));
}

/// Beams of different random numbers that all look the same way.
ScanBeams alike(int count)
{
  ScanBeams beams;
  for (int i = 0; i < count; ++i)
  {
    beams.ids.push_back(static_cast<std::uint64_t>(i));
    beams.origins.emplace_back(0.0);
    beams.directions.emplace_back(1.0, 0.0, 0.0);
  }
  return beams;
}

EchoSettings targeted(double target, Sampling sampling = Sampling::Stratified, int rays = 100)
{
  EchoSettings settings = directSettings(rays);
  settings.targetRelativeError = target;
  settings.sampling = sampling;
  return settings;
}

struct Spent
{
  double bias = 0.0; ///< of the mean energy, relative
  double own = 0.0;  ///< standard error of that
  double rms = 0.0;  ///< of the relative errors
  double rays = 0.0; ///< mean, without the pilot's
};

Spent spend(double share, const EchoSettings& settings, int count)
{
  const double offset = offsetOf(share);
  const ScanBeams beams = alike(count);
  const ScanSetup setup = makeSetup(wallBeyond(offset), openSensor(), settings);
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
  // A beam without echo received nothing.
  Spent spent;
  double squares = 0.0;
  double sum = 0.0;
  for (const Echo& echo : result.echoes)
  {
    const double energy = echo.energyReceived / energyBeyond(offset);
    sum += energy;
    squares += energy * energy;
  }
  for (const BeamTrace& trace : cache.beams)
  {
    spent.rays += trace.rays;
  }
  const double n = count;
  spent.rays /= n;
  spent.bias = sum / n - 1.0;
  spent.own = std::sqrt((squares / n - sum * sum / (n * n)) / n);
  spent.rms = std::sqrt(squares / n - 2.0 * sum / n + 1.0);
  return spent;
}

/// Rays of every beam of a town.
std::vector<std::uint32_t> raysInTown(double target)
{
  EchoSettings settings = usual();
  settings.planeIntegration = false; // of beams that are sampled
  settings.targetRelativeError = target;
  settings.noise = false;
  const ScanSetup setup = makeSetup(town(), Sensor(), settings);
  const ScanBeams beams = horizon(60, 4);
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
  std::vector<std::uint32_t> rays;
  for (std::size_t b = 0; b < beams.size(); ++b)
  {
    rays.push_back(cache.beams[b].rays);
    // The pilot is paid for, too.
    EXPECT_GE(result.reports[b].counters.raysTraced, rays.back() + PilotRays);
  }
  return rays;
}
}

TEST(RayBudget, LeavesNoBias)
{
  // Stopping when the estimated error is good reads 72 % too low at the first of these shares.
  const std::pair<double, int> cases[] = { { 0.02, 30000 }, { 0.1, 6000 }, { 0.5, 3000 },
    { 0.8, 3000 }, { 0.95, 3000 } };
  for (const Sampling sampling : { Sampling::Stratified, Sampling::MonteCarlo })
  {
    for (const auto& [share, count] : cases)
    {
      const Spent spent = spend(share, targeted(0.05, sampling, 400), count);
      EXPECT_LT(spent.own, 0.002) << share;
      EXPECT_LT(std::abs(spent.bias), 0.005) << share << " +- " << spent.own;
    }
  }
}

TEST(RayBudget, ReachesTheErrorAskedFor)
{
  for (const Sampling sampling : { Sampling::Stratified, Sampling::MonteCarlo })
  {
    for (const double target : { 0.1, 0.05, 0.02 })
    {
      for (const double share : { 0.2, 0.5, 0.8 })
      {
        const Spent spent = spend(share, targeted(target, sampling, 1000), 1500);
        EXPECT_GT(spent.rms / target, 0.4) << share << " " << target;
        EXPECT_LT(spent.rms / target, 1.2) << share << " " << target;
      }
    }
  }
}

TEST(RayBudget, FollowsTheLawOfTheSampling)
{
  // Twice as exact: 4 times as many independent rays, 2.52 times as many of strata at an edge.
  const auto ratio = [](Sampling sampling)
  {
    return spend(0.5, targeted(0.02, sampling, 1000), 400).rays /
      spend(0.5, targeted(0.04, sampling, 1000), 400).rays;
  };
  EXPECT_NEAR(ratio(Sampling::MonteCarlo), 4.0, 0.4);
  EXPECT_NEAR(ratio(Sampling::Stratified), std::pow(2.0, 4.0 / 3.0), 0.3);
}

TEST(RayBudget, APlaneGetsTheFewest)
{
  for (const double target : { 0.2, 0.01 })
  {
    const Spent spent = spend(1.0, targeted(target), 50);
    EXPECT_EQ(spent.rays, MinimumTargetRays);
    EXPECT_LT(std::abs(spent.bias), 1e-4);
  }
}

TEST(RayBudget, GrowsAsTheTargetFalls)
{
  std::vector<std::uint32_t> before;
  for (const double target : { 0.3, 0.1, 0.03, 0.01 })
  {
    const std::vector<std::uint32_t> rays = raysInTown(target);
    std::size_t more = 0;
    for (std::size_t b = 0; b < before.size(); ++b)
    {
      EXPECT_GE(rays[b], before[b]);
      more += rays[b] > before[b];
    }
    EXPECT_TRUE(before.empty() || more > before.size() / 10);
    before = rays;
  }
  for (const std::uint32_t rays : before)
  {
    EXPECT_GE(rays, static_cast<std::uint32_t>(MinimumTargetRays));
    EXPECT_LE(rays, static_cast<std::uint32_t>(MaximumRayFactor * usual().raysPerBeam));
  }
}

TEST(RayBudget, WhatIsNotPerceivedCostsLittle)
{
  // A tenth of Qlow: no echo whatever the error, and no false one for want of rays.
  const double offset = offsetOf(2e-7 / (3.6e-4 * Matt.kd));
  EchoSettings settings = targeted(0.01);
  Sensor sensor = openSensor();
  sensor.lowerEnergyLimit = 2e-6;
  TraceCache cache;
  ScanResult result;
  const ScanBeams beams = alike(2000);
  simulateScan(makeSetup(wallBeyond(offset), sensor, settings), beams, 2, cache,
    std::size_t(1) << 30, {}, result);
  double rays = 0.0;
  for (const BeamTrace& trace : cache.beams)
  {
    rays += trace.rays / 2000.0;
  }
  EXPECT_LT(rays, 250.0); // of 1,600
  EXPECT_LT(result.echoes.size(), 20u);
}

TEST(RayBudget, AnErrorBelowAllNumbersAsksForNothing)
{
  // A tenth of the energy, the smallest number above 0, is 0; nothing is too faint.
  Sensor sensor = openSensor();
  sensor.lowerEnergyLimit = 0.0;
  sensor.pulseEnergy = 1.12e-321;
  const ScanSetup setup = makeSetup(wallBeyond(0.0), sensor, targeted(0.1));
  BeamSamples pilot;
  pilot.rays = PilotRays;
  pilot.ray = { 3 };
  pilot.surfaces = { { 0, 1 } };
  pilot.range = { 100.0 };
  pilot.cosine = { 1.0 };
  pilot.weight = { 1.0 / PilotRays };
  pilot.nearest = pilot.farthest = 100.0;
  BeamSamplers samplers(setup.settings.sampling);
  RayBudget budget(setup, samplers);
  TargetRays ofTargets;
  std::feclearexcept(FE_ALL_EXCEPT);
  EXPECT_EQ(budget.raysFor(pilot, ofTargets), static_cast<std::uint32_t>(MinimumTargetRays));
  EXPECT_EQ(std::fetestexcept(FE_INVALID), 0);
}

namespace
{
/// Of beams that a wall beyond an edge covers by a tenth, with a limit of which the energy that is
/// received is so many times, the share that has the wrong answer, and their rays on the average.
struct Decided
{
  double wrong = 0.0;
  double rays = 0.0;
};

Decided decide(double overLimit, bool refine, Sampling sampling = Sampling::Stratified)
{
  const double offset = offsetOf(0.1);
  EchoSettings settings = directSettings(100);
  settings.refineNearLimit = refine;
  settings.sampling = sampling;
  Sensor sensor = openSensor();
  sensor.lowerEnergyLimit = energyBeyond(offset) / overLimit;
  const ScanBeams beams = alike(2000);
  const ScanSetup setup = makeSetup(wallBeyond(offset), sensor, settings);
  TraceCache cache;
  ScanResult result;
  simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
  Decided decided;
  for (const BeamTrace& trace : cache.beams)
  {
    decided.rays += trace.rays;
  }
  decided.rays /= static_cast<double>(beams.size());
  const double seen = static_cast<double>(result.echoes.size()) / static_cast<double>(beams.size());
  decided.wrong = overLimit > 1.0 ? 1.0 - seen : seen;
  return decided;
}
}

TEST(RayBudget, NearTheLimitItIsSoundWhetherThereIsAnEcho)
{
  for (const Sampling sampling : { Sampling::Stratified, Sampling::MonteCarlo })
  {
    for (const double overLimit : { 0.8, 0.87, 1.15, 1.25 })
    {
      const Decided refined = decide(overLimit, true, sampling);
      const Decided plain = decide(overLimit, false, sampling);
      EXPECT_LT(refined.wrong, sampling == Sampling::MonteCarlo ? 0.12 : 0.02) << overLimit;
      EXPECT_LT(refined.wrong, 0.5 * plain.wrong + 1e-3) << overLimit;
    }
  }
  EXPECT_GT(decide(0.9, false).wrong, 0.1);
}

TEST(RayBudget, OnlyBeamsNearTheLimitGetMoreRays)
{
  EXPECT_EQ(decide(0.3, true).rays, 100.0);
  EXPECT_LT(decide(3.0, true).rays, 101.0);
  EXPECT_GT(decide(1.02, true).rays, 800.0);
  EXPECT_LE(decide(1.0001, true).rays, 1600.0);
  EXPECT_EQ(decide(1.02, false).rays, 100.0);
}

TEST(RayBudget, ATargetErrorManyRaysOrFewLeaveNothingToRefine)
{
  EchoSettings settings;
  EXPECT_TRUE(refinesNearLimit(settings));
  settings.refineNearLimit = false;
  EXPECT_FALSE(refinesNearLimit(settings));
  settings.refineNearLimit = true;
  settings.raysPerBeam = MostRaysNearLimit;
  EXPECT_FALSE(refinesNearLimit(settings));
  settings.raysPerBeam = 7;
  EXPECT_FALSE(refinesNearLimit(settings));
  settings.raysPerBeam = 100;
  settings.targetRelativeError = 0.1;
  EXPECT_FALSE(refinesNearLimit(settings));
}
