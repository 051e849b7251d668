// SPDX-License-Identifier: BSD-3-Clause
// Costs and status of beams that are integrated, sampled, or neither.
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"
#include "ScanTestTown.h"
#include "SecondaryTestScene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
/// Small boxes on a circle of 60 m, and the beams of a ring that surely pass all of them.
constexpr double Circle = 60.0;

Scene smallBoxes(int count)
{
  Scene scene;
  for (int box = 0; box < count; ++box)
  {
    const double azimuth = 2.0 * Pi * box / count;
    scene.box(Circle * Vec3(std::cos(azimuth), std::sin(azimuth), 0.0), Vec3(1.0),
      box % 2 ? Wall : Glass, box);
  }
  return scene;
}

bool surelyPassesAll(const Vec3& direction, int count, double halfBeamwidth)
{
  for (int box = 0; box < count; ++box)
  {
    const double azimuth = 2.0 * Pi * box / count;
    const Vec3 center(std::cos(azimuth), std::sin(azimuth), 0.0);
    const double angle = std::acos(glm::dot(unitVector(direction), center));
    if (angle <= 1.01 * (std::asin(std::sqrt(3.0) / Circle) + halfBeamwidth))
    {
      return false;
    }
  }
  return true;
}
}

TEST(PolygonReports, WithATargetErrorBeamsKnownToMeetNothingTraceNoRays)
{
  constexpr int boxes = 24;
  const ScanBeams beams = ring(400);
  for (const TraceMode mode : { TraceMode::Automatic, TraceMode::SingleRays, TraceMode::Beams })
  {
    SCOPED_TRACE(static_cast<int>(mode));
    EchoSettings settings = integrating(400);
    settings.targetRelativeError = 0.05;
    settings.numberOfReflections = 2;
    settings.smallTargets = true;
    settings.traceMode = mode;
    Sensor sensor;
    sensor.halfBeamwidth = 0.01;
    ScanSetup setup = makeSetup(smallBoxes(boxes), sensor, settings);
    TraceCache cache;
    ScanResult result;
    for (const double interval : { 5e-9, 1e-16, 5e-9 })
    {
      SCOPED_TRACE(interval);
      setup.sensor.samplingInterval = interval; // of 1e-16 s no box fits
      setup.sensor.pulseWidth = 0.0;
      setup.settings.lightEnergyConstraint = false;
      finishSetup(setup);
      ASSERT_TRUE(simulateScan(setup, beams, 1, cache, std::size_t(1) << 30, {}, result));
      int passing = 0;
      int sampled = 0;
      for (std::size_t b = 0; b < beams.size(); ++b)
      {
        const BeamReport& report = result.reports[b];
        if (surelyPassesAll(beams.directions[b], boxes, sensor.halfBeamwidth))
        {
          ++passing;
          EXPECT_EQ(report.status, BeamStatus::NoSurface) << b;
          EXPECT_EQ(report.counters.raysTraced, 0u) << b;
          EXPECT_EQ(report.counters.candidates, 0u) << b;
        }
        sampled += report.counters.raysTraced >= static_cast<std::uint64_t>(PilotRays);
      }
      EXPECT_GT(passing, 100);
      EXPECT_LT(passing, 350);
      EXPECT_EQ(sampled > 50, interval < 1e-10);
    }
  }
}

namespace
{
/// Grooves all around that open towards the lidar: light goes from one side to the other.
Scene groovesAround()
{
  Scene scene;
  for (int k = 0; k < 12; ++k)
  {
    const double azimuth = 2.0 * Pi * k / 12;
    const Vec3 along(std::cos(azimuth), std::sin(azimuth), 0.0);
    const Vec3 across(-along.y, along.x, 0.0);
    for (const double side : { -1.0, 1.0 })
    {
      const Vec3 half = 4.0 * (side * across - along);
      scene.plate(60.0 * along + half, half, Vec3(0.0, 0.0, 20.0), k % 2 ? Wall : Metal, k);
    }
  }
  return scene;
}

/// What the beams of a scan cost.
struct Costs
{
  std::ptrdiff_t integrated = 0; ///< beams that traced no rays
  std::uint64_t rays = 0;        ///< of all beams
};
}

TEST(PolygonReports, RaysOfABeamThatIsNowIntegratedNoLongerCount)
{
  for (const double target : { 0.0, 0.2 })
  {
    for (const bool refine : { false, true })
    {
      for (const int reflections : { 1, 2 })
      {
        SCOPED_TRACE(testing::Message() << target << ' ' << refine << ' ' << reflections);
        EchoSettings settings = secondarySettings(100, 2);
        settings.planeIntegration = true;
        settings.targetRelativeError = target;
        settings.refineNearLimit = refine;
        settings.numberOfReflections = reflections;
        settings.lightEnergyConstraint = false; // no polygon is dropped, and no path
        ScanSetup setup = makeSetup(groovesAround(), Sensor{}, settings);
        const ScanBeams beams = ring(120);
        TraceCache cache;
        ScanResult result;
        const auto costsNow = [&](const char* what)
        {
          SCOPED_TRACE(what);
          finishSetup(setup);
          EXPECT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
          const ScanResult fresh = runScan(setup, beams);
          expectSame(result, fresh);
          Costs costs;
          for (std::size_t b = 0; b < beams.size(); ++b)
          {
            const BeamReport& one = result.reports[b];
            const BeamReport& two = fresh.reports[b];
            EXPECT_EQ(one.status, two.status) << b;
            EXPECT_EQ(one.counters.raysTraced, two.counters.raysTraced) << b;
            EXPECT_EQ(one.targetsLeftOut, two.targetsLeftOut) << b;
            costs.rays += one.counters.raysTraced;
          }
          const std::vector<bool> integrated = integratedOf(result);
          costs.integrated = std::count(integrated.begin(), integrated.end(), true);
          for (std::size_t b = 0; b < beams.size(); ++b)
          {
            EXPECT_TRUE(!integrated[b] || result.reports[b].counters.candidates == 0) << b;
          }
          return costs;
        };
        const auto setInterval = [&](double interval)
        {
          setup.sensor.samplingInterval = interval;
          setup.sensor.pulseWidth = 0.0;
        };
        setInterval(1e-16); // no wall fits
        const Costs none = costsNow("none");
        EXPECT_EQ(none.integrated, 0);
        setInterval(5e-9);
        const Costs all = costsNow("all");
        EXPECT_GT(all.integrated, reflections > 1 ? 10 : 50);
        EXPECT_LT(all.rays, none.rays);
        EXPECT_EQ(all.rays > 0, reflections > 1);
        setInterval(1e-16);
        EXPECT_EQ(costsNow("none again").rays, none.rays);
        setInterval(5e-9);
        EXPECT_EQ(costsNow("all again").rays, all.rays);
        // Sharp lobes ask for more nodes than beams may have.
        const SharedVector<Material> materials = setup.materials;
        edit(setup.materials,
          [](std::vector<Material>& copy) {
            std::fill(copy.begin(), copy.end(), Material{ 0.0, 0.5, 1e6 });
          });
        EXPECT_LT(costsNow("lobes").integrated, all.integrated);
        setup.materials = materials;
        EXPECT_EQ(costsNow("no lobes").rays, all.rays);
        setup.settings.raysPerBeam = 30;
        costsNow("fewer rays");
        setup.settings.raysPerBeam = 100;
        EXPECT_EQ(costsNow("more rays").rays, all.rays);
      }
    }
  }
}

//--- status ---------------------------------------------------------------------------------------

namespace
{
/// Specks that no ray meets: corners of a cube, each of three triangles that face each other.
Scene specks(int count, const Vec3& at)
{
  Scene scene;
  Numbers random(33);
  constexpr double size = 1e-5;
  for (int k = 0; k < count; ++k)
  {
    const Vec3 tip = at + Vec3(0.1 * k, random(-0.2, 0.2), random(-0.2, 0.2));
    const Vec3 rim[] = { tip + size * Vec3(-1.0, 1.0, 0.0), tip + size * Vec3(-1.0, -0.5, 0.8),
      tip + size * Vec3(-1.0, -0.5, -0.8) };
    for (int i = 0; i < 3; ++i)
    {
      scene.triangle(tip, rim[i], rim[(i + 1) % 3], Wall, k);
    }
  }
  return scene;
}

void expectSameButForCosts(const ScanResult& one, const ScanResult& two)
{
  expectSame(one, two);
  const BeamReport& a = one.reports[0];
  const BeamReport& b = two.reports[0];
  EXPECT_EQ(a.status, b.status);
  EXPECT_TRUE(sameBits(a.range, b.range));
  EXPECT_EQ(a.skipped, b.skipped);
  EXPECT_EQ(a.lost, b.lost);
  EXPECT_EQ(a.targetsLeftOut, b.targetsLeftOut);
}
}

TEST(PolygonReports, ABeamWhoseRaysMissWhatEntersItMeetsNothing)
{
  for (const double target : { 0.0, 0.2 })
  {
    for (const bool refine : { false, true })
    {
      for (const double limit : { 0.0, 25.0, 12.0 }) // photons, of 5 that are noise; 0: no noise
      {
        SCOPED_TRACE(testing::Message() << target << ' ' << refine << ' ' << limit);
        EchoSettings settings = secondarySettings(40);
        settings.planeIntegration = true;
        settings.targetRelativeError = target;
        settings.refineNearLimit = refine;
        settings.smallTargets = false;
        settings.noise = limit > 0.0;
        Sensor sensor;
        sensor.noisePhotonRate = 1e9;
        sensor.lowerEnergyLimit = limit * sensor.photonEnergy();
        // More triangles than may be integrated; and one speck, whose polygons do not fit.
        for (const int count : { 40, 1 })
        {
          SCOPED_TRACE(count);
          ScanSetup setup = makeSetup(specks(count, Vec3(100.0, 0.0, 0.0)), sensor, settings);
          ScanSetup without = makeSetup(specks(count, Vec3(-100.0, 0.0, 0.0)), sensor, settings);
          const ScanResult nothing = runScan(without, oneBeam());
          ASSERT_EQ(nothing.raysTraced, 0u);
          EXPECT_EQ(
            nothing.reports[0].status, limit == 12.0 ? BeamStatus::Echo : BeamStatus::NoSurface);
          EXPECT_EQ(nothing.echoes.empty(), limit != 12.0);
          EXPECT_EQ(without.noise.active, limit > 0.0);
          if (count > 1)
          {
            const ScanResult missed = runScan(setup, oneBeam());
            EXPECT_GE(missed.raysTraced, 32u);
            expectSameButForCosts(missed, nothing);
            continue;
          }
          // Sampled, integrated, and sampled again from what is kept.
          setup.settings.lightEnergyConstraint = false;
          TraceCache cache;
          for (const bool fits : { false, true, false })
          {
            SCOPED_TRACE(fits);
            setup.sensor.samplingInterval = without.sensor.samplingInterval = fits ? 5e-9 : 1e-16;
            setup.sensor.pulseWidth = without.sensor.pulseWidth = 0.0;
            setup.sensor.rangeGate = without.sensor.rangeGate = fits ? 4000.0 : 110.0;
            finishSetup(setup);
            finishSetup(without);
            ScanResult result;
            ASSERT_TRUE(simulateScan(setup, oneBeam(), 1, cache, std::size_t(1) << 30, {}, result));
            if (fits)
            {
              EXPECT_EQ(result.reports[0].counters.raysTraced, 0u);
              EXPECT_EQ(result.reports[0].status, BeamStatus::Echo);
            }
            else
            {
              EXPECT_GE(result.reports[0].counters.raysTraced, 32u);
              expectSameButForCosts(result, runScan(without, oneBeam()));
            }
          }
        }
      }
    }
  }
}
