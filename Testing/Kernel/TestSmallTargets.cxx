// SPDX-License-Identifier: BSD-3-Clause
// Rays of their own for small objects: the mean over seeds is the closed form, or brute force.
#include "SmallTargetScene.h"

#include "SmallTargets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using namespace avianlidar;
using namespace echotest;

namespace
{
void expectUnbiased(const ScanSetup& setup, int seeds)
{
  const Estimate own = estimate(setup, seeds / FewerSeeds);
  const Estimate truth = bruteForce(setup);
  EXPECT_NEAR(own.mean, truth.mean, 4.0 * std::hypot(own.error, truth.error));
  EXPECT_LT(truth.error, 0.02 * FewerSeeds * truth.mean);
  EXPECT_LT(own.error, 0.02 * Wider * truth.mean);
  EXPECT_GT(own.rays, setup.settings.raysPerBeam);
}

/// Share of a uniform beam's energy on a small surface across its axis.
double shareOf(double area)
{
  const double tangent = std::sqrt(area / Pi) / Range;
  const double cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
  return (1.0 - cosine) / (1.0 - std::cos(5.6e-3));
}
}

TEST(SmallTargets, MeanIsTheClosedForm)
{
  constexpr int seeds = 4000 / FewerSeeds;
  for (Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
  {
    for (BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
    {
      Scene scene;
      disc(scene, Vec3(Range, 0.0, 0.0), Area, Matt, 1);
      const Sensor sensor = sensorOf(profile);
      const double u = shareOf(Area);
      const double share =
        profile == BeamProfile::Uniform ? u : std::expm1(-2.0 * u) / std::expm1(-2.0);
      const double truth = sensor.pulseEnergy * Matt.kd * share;
      const ScanSetup setup = makeSetup(scene, sensor, settingsOf(sampling));
      const Estimate own = estimate(setup, seeds, truth);
      // The disc is a polygon that misses 0.6 % of its circle.
      EXPECT_NEAR(own.mean, truth, 4.0 * own.error + 1e-3 * truth);
      EXPECT_LT(own.deviation, 0.1 * truth);
      EXPECT_GE(own.covered, 0.95);
      EXPECT_EQ(own.rays, 100.0 + RaysOfTarget);
    }
  }
}

TEST(SmallTargets, SpreadOfASquareIsATenthOfThatWithoutRaysOfItsOwn)
{
  Scene scene;
  const double half = 0.5 * std::sqrt(Area);
  scene.plate(Vec3(Range, 0.0, 0.0), Vec3(0.0, half, 0.0), Vec3(0.0, 0.0, half), Matt, 1);
  EchoSettings settings = settingsOf(Sampling::MonteCarlo);
  const Sensor sensor = openSensor();
  const double truth = sensor.pulseEnergy * Matt.kd * shareOf(Area);
  const Estimate own = estimate(makeSetup(scene, sensor, settings), 4000 / FewerSeeds, truth);
  settings.smallTargets = false;
  const Estimate without = estimate(makeSetup(scene, sensor, settings), 4000 / FewerSeeds);
  EXPECT_NEAR(own.mean, truth, 4.0 * own.error);
  EXPECT_NEAR(without.mean, truth, 4.0 * without.error);
  EXPECT_LT(own.deviation, 0.35 * truth);
  EXPECT_NEAR(without.deviation / truth, 2.58, 0.15 * Wider);
  EXPECT_GE(own.covered, 0.95);
}

// As Documentation/results/accuracy.md says: a sample that is sure of its decision is kept, another
// is replaced, and what no ray of the first sample met is not looked for.
TEST(SmallTargets, RefinementBiasesEnergiesNearTheLimit)
{
  const auto expectBias = [](const Scene& scene, bool refine, double expected, double within)
  {
    Sensor sensor = openSensor();
    EchoSettings settings = settingsOf(Sampling::Stratified);
    const double truth = bruteForce(makeSetup(scene, sensor, settings)).mean;
    settings.refineNearLimit = refine;
    for (const double limit : { 0.1, 0.5 })
    {
      sensor.lowerEnergyLimit = limit * truth;
      const double mean = estimate(makeSetup(scene, sensor, settings), 1000 / FewerSeeds).mean;
      EXPECT_NEAR(mean / truth - 1.0, expected, Wider * within) << limit;
    }
  };
  Scene square;
  const double half = 0.5 * std::sqrt(Area);
  square.plate(Vec3(Range, 0.0, 0.0), Vec3(0.0, half, 0.0), Vec3(0.0, 0.0, half), Matt, 1);
  // A wall that fills the upper part of the beam: 14 % of it, and 0.5 %.
  Scene edge;
  Scene sliver;
  const double reach = 5.6e-3 * Range;
  const Vec3 wide(0.0, 3.0 * reach, 0.0);
  const Vec3 high(0.0, 0.0, reach);
  edge.plate(Vec3(Range, 0.0, 1.6 * reach), wide, high, Matt, 1);
  sliver.plate(Vec3(Range, 0.0, 1.96 * reach), wide, high, Matt, 1);
  expectBias(square, true, 0.075, 0.035);
  expectBias(edge, true, 0.0, 0.02);
  expectBias(edge, false, 0.0, 0.02);
  expectBias(sliver, true, -0.57, 0.1);
  expectBias(sliver, false, 0.0, 0.1);
}

TEST(SmallTargets, UnbiasedWherePartOfTheObjectLiesOutsideTheBeam)
{
  Scene scene;
  disc(scene, Vec3(Range, 5.6, 0.1), Area, Matt, 1);
  for (BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
  {
    expectUnbiased(makeSetup(scene, sensorOf(profile), settingsOf(Sampling::Stratified)), 3000);
  }
}

TEST(SmallTargets, UnbiasedWhereSamplingConesOverlap)
{
  Scene scene;
  const double half = 0.5 * std::sqrt(Area);
  const Vec3 u(0.0, half, 0.0);
  const Vec3 v(0.0, 0.0, half);
  scene.plate(Vec3(Range, 1.0, 0.5), u, v, Matt, 1);
  scene.plate(Vec3(Range - 50.0, 1.0 + half, 0.5), u, v, Wall, 2);
  scene.plate(
    Vec3(Range - 70.0, 1.0, 0.5), 0.2 * u, 0.2 * v, Matt, 3); // inside both sampling cones
  for (Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
  {
    expectUnbiased(makeSetup(scene, openSensor(), settingsOf(sampling)), 3000);
  }
}

TEST(SmallTargets, UnbiasedBeforeAWallAndBehindOne)
{
  for (double wall : { Range + 100.0, Range - 100.0 })
  {
    Scene scene;
    disc(scene, Vec3(Range, 0.7, -1.5), Area, Matt, 1);
    scene.plate(Vec3(wall, 0.0, 0.0), Vec3(0.0, 50.0, 0.0), Vec3(0.0, 0.0, 50.0), Wall, 2);
    for (BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
    {
      expectUnbiased(makeSetup(scene, sensorOf(profile), settingsOf(Sampling::Stratified)), 1000);
    }
  }
}

TEST(SmallTargets, UnbiasedOverTwoReflections)
{
  // A corner that the beam looks into, before it a small mirror that throws light on a wall, and a
  // small matt object: mirror paths start from their rays, connections only from the others.
  Scene scene;
  const Vec3 edge(100.0, 0.0, 0.0);
  const Vec3 up(0.0, 0.0, 30.0);
  scene.plate(edge + Vec3(-20.0, 20.0, 0.0), Vec3(20.0, -20.0, 0.0), up, Metal, 1);
  scene.plate(edge + Vec3(-20.0, -20.0, 0.0), Vec3(20.0, 20.0, 0.0), up, Matt, 2);
  const Vec3 along = Vec3(0.1, 0.09, 0.0);
  scene.plate(Vec3(97.0, 0.6, 0.2), along, Vec3(0.0, 0.0, 0.1), Metal, 3);
  scene.plate(Vec3(98.0, -0.6, 0.2), Vec3(0.0, 0.1, 0.0), Vec3(0.0, 0.0, 0.1), Matt, 4);
  EchoSettings settings;
  settings.attenuationCoefficient = 0.0;
  settings.noise = false;
  settings.raysPerBeam = 40;
  const Sensor sensor = openSensor(0.02);
  // Rays; with those of small targets; polygons, on which paths start.
  double means[3];
  double errors[3];
  double shares[3] = { 0.0, 0.0, 0.0 };
  for (int own = 0; own < 3; ++own)
  {
    settings.smallTargets = own == 1;
    settings.planeIntegration = own == 2;
    ScanSetup setup = makeSetup(scene, sensor, settings);
    constexpr int seeds = 4000 / FewerSeeds;
    const Estimate all = estimate(setup, seeds);
    EXPECT_GT(all.rays, settings.raysPerBeam); // of polygons those of paths alone
    means[own] = all.mean;
    errors[own] = all.error;
    // Of what came over two reflections alone.
    double squares = 0.0;
    for (int seed = 0; seed < seeds; ++seed)
    {
      setup.settings.seed = seed;
      const ScanResult result = runScan(setup, oneBeam());
      const double secondary = result.echoes[0].secondaryShare * result.echoes[0].returnEnergy;
      shares[own] += secondary / seeds;
      squares += secondary * secondary / seeds;
    }
    errors[own] = std::hypot(
      errors[own], std::sqrt((squares - shares[own] * shares[own]) / static_cast<double>(seeds)));
  }
  for (const int own : { 1, 2 })
  {
    const double error = std::hypot(errors[0], errors[own]);
    EXPECT_NEAR(means[0], means[own], 4.0 * error);
    EXPECT_NEAR(shares[0], shares[own], 4.0 * error);
    EXPECT_GT(shares[0], 20.0 / Wider * error);
  }
}

namespace
{
/// The town with posts, some of which stand before each other.
Scene townWithPosts()
{
  Scene scene = town();
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 400; ++i)
  {
    const double angle = 2.0 * Pi * uniform(random);
    const double range = 40.0 + 200.0 * uniform(random);
    scene.box(Vec3(range * std::cos(angle), range * std::sin(angle), 2.0 * uniform(random)),
      Vec3(0.03, 0.03, 0.05), i % 2 ? Metal : Wall, 100 + i);
  }
  return scene;
}

Sensor sensitive()
{
  Sensor sensor;
  sensor.lowerEnergyLimit = 1e-8;
  return sensor;
}
}

TEST(SmallTargets, SameBitsForThreadsPiecesAndTraversals)
{
  ScanSetup setup = makeSetup(townWithPosts(), sensitive(), usual());
  setup.settings.planeIntegration = false;
  const ScanBeams beams = horizon(360, 3);
  const ScanResult one = runScan(setup, beams);
  std::uint64_t more = 0;
  for (const BeamReport& report : one.reports)
  {
    more += report.counters.raysTraced % 40 == 0 ? 0 : 1;
  }
  EXPECT_GT(more, 100u);
  expectSame(one, runScan(setup, beams, 4));
  ScanResult pieces;
  for (std::size_t first = 0; first < beams.size(); first += 135)
  {
    ScanBeams piece;
    for (std::size_t b = first; b < std::min(beams.size(), first + 135); ++b)
    {
      piece.ids.push_back(beams.ids[b]);
      piece.origins.push_back(beams.origins[b]);
      piece.directions.push_back(beams.directions[b]);
    }
    const ScanResult part = runScan(setup, piece);
    for (std::size_t i = 0; i < part.echoes.size(); ++i)
    {
      pieces.echoes.push_back(part.echoes[i]);
      pieces.beamOfEcho.push_back(part.beamOfEcho[i] + first);
    }
  }
  expectSame(one, pieces);
  setup.settings.traceMode = TraceMode::SingleRays;
  expectSame(one, runScan(setup, beams));
}

TEST(SmallTargets, LitAgainLikeAFreshScan)
{
  const ScanBeams beams = horizon(360, 2);
  ScanSetup setup = makeSetup(townWithPosts(), sensitive(), usual());
  setup.settings.planeIntegration = false; // integrated beams have no rays of targets
  TraceCache cache;
  ScanResult result;
  // Limits far apart: other objects deserve rays of their own.
  std::vector<double> limits = { 1e-8, 1.1e-8, 1e-6, 1e-4, 2e-7, 1e-8 };
  for (std::size_t k = 0; k < limits.size(); ++k)
  {
    setup.sensor.lowerEnergyLimit = limits[k];
    setup.settings.attenuationCoefficient = k == 1 ? 1e-3 : 3.5e-5;
    finishSetup(setup);
    simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
    expectSame(runScan(setup, beams), result);
    if (k == 1)
    {
      EXPECT_EQ(result.raysTraced, 0u);
    }
  }
  // Nothing but objects: half of the posts in pairs, then everything one object, then each as
  // before.
  const std::vector<int> apart = townWithPosts().objects;
  std::vector<int> pairs = apart;
  for (int& id : pairs)
  {
    id = id >= 100 && id % 4 < 2 ? id - id % 2 : id;
  }
  std::vector<std::uint64_t> rays;
  for (const std::vector<int>& ids : { pairs, std::vector<int>(apart.size(), 3), apart })
  {
    setup.objectIds = ids;
    finishSetup(setup);
    simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result);
    expectSame(runScan(setup, beams), result);
    rays.push_back(result.raysTraced);
  }
  EXPECT_GT(rays[0], rays[1]);
  EXPECT_GT(rays[2], rays[0]);
}

TEST(SmallTargets, NoneWhereTheyCannotMatter)
{
  Scene scene;
  disc(scene, Vec3(Range, 0.0, 0.0), Area, Matt, 1);
  Sensor sensor = openSensor();
  const double energy = sensor.pulseEnergy * Matt.kd * shareOf(Area);
  // From the tolerance on, but for the rounding to a power of 4.
  sensor.lowerEnergyLimit = 0.99 * energy / SmallTargetFraction;
  EXPECT_EQ(estimate(makeSetup(scene, sensor, directSettings(100)), 1).rays, 108.0);
  sensor.lowerEnergyLimit = 4.1 * energy / SmallTargetFraction;
  EXPECT_EQ(estimate(makeSetup(scene, sensor, directSettings(100)), 1).rays, 100.0);
  // Nor where the beam's own rays are closer than the object is wide.
  sensor.lowerEnergyLimit = 0.0;
  EXPECT_EQ(estimate(makeSetup(scene, sensor, directSettings(6000)), 1).rays, 6000.0);
}

TEST(SmallTargets, FewOfThousands)
{
  Scene scene;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 3000; ++i)
  {
    scene.box(Vec3(Range + 100.0 * uniform(random), 5.0 * uniform(random), 5.0 * uniform(random)),
      Vec3(0.02 + 0.01 * std::fabs(uniform(random))), Matt, i);
  }
  const ScanSetup setup = makeSetup(scene, openSensor(), settingsOf(Sampling::Stratified));
  EXPECT_EQ(estimate(setup, 1).rays, 100.0 + RaysOfTarget * MaximumTargets);
  expectUnbiased(setup, 1500);
}

TEST(SmallTargets, FoundAsByALookAtEveryObject)
{
  Scene scene;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr int count = 500;
  std::vector<Vec3> lower(count, Vec3(1e9));
  std::vector<Vec3> upper(count, Vec3(-1e9));
  for (int i = 0; i < 800; ++i)
  {
    const double size = std::pow(10.0, 2.0 * uniform(random));
    const Vec3 center = 300.0 * Vec3(uniform(random), uniform(random), uniform(random));
    const Vec3 half(0.1 * size, 0.02 * size, 0.05 * size);
    scene.box(center, half, Matt, 7 * (i % count));
    lower[i % count] = glm::min(lower[i % count], center - half);
    upper[i % count] = glm::max(upper[i % count], center + half);
  }
  const SharedVector<int> ids(scene.objects);
  const ObjectSpheres objects(*scene.mesh, 1, ids);
  EXPECT_EQ(objects.size(), 500u);
  std::size_t found = 0;
  for (int b = 0; b < 400; ++b)
  {
    const Vec3 origin = 200.0 * Vec3(uniform(random), uniform(random), uniform(random));
    const double half = std::min(std::pow(10.0, -1.5 + 1.5 * uniform(random)), 1.0);
    const BeamFrame beam =
      makeBeamFrame(origin, Vec3(uniform(random), uniform(random), uniform(random)), half);
    std::vector<ObjectSpheres::Seen> seen;
    objects.find(beam, ShareWindow(half, 1e-4, 1e-1), seen);
    found += seen.size();
    // Spheres about the middles of boxes, through their corners, one by one.
    std::size_t expected = 0;
    for (int i = 0; i < count; ++i)
    {
      const Vec3 to = 0.5 * (lower[i] + upper[i]) - origin;
      const double range = glm::length(to);
      const double sine = 0.5 * glm::length(upper[i] - lower[i]) / range;
      const double share = (1.0 - std::sqrt(1.0 - sine * sine)) / (1.0 - std::cos(half));
      const double angle = std::acos(glm::dot(to, beam.axis) / range);
      if (sine < 1.0 && share >= 1e-4 && share < 1e-1 && angle <= half + std::asin(sine))
      {
        ++expected;
        EXPECT_EQ(std::count_if(seen.begin(), seen.end(),
                    [&](const ObjectSpheres::Seen& s)
                    { return glm::length(s.sphere->center - origin - to) < 1e-9; }),
          1);
      }
    }
    EXPECT_EQ(seen.size(), expected);
  }
  EXPECT_GT(found, 100u);
}
