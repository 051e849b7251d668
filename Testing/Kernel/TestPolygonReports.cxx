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

TEST(PolygonReports, BeamsThatMeetNothingTraceNoRays)
{
  constexpr int boxes = 24;
  const ScanBeams beams = ring(400);
  for (const TraceMode mode : { TraceMode::Automatic, TraceMode::SingleRays, TraceMode::Beams })
  {
    SCOPED_TRACE(static_cast<int>(mode));
    EchoSettings settings = integrating(400);
    settings.numberOfReflections = 2;
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
        sampled += report.counters.raysTraced > 0;
      }
      EXPECT_GT(passing, 100);
      EXPECT_LT(passing, 350);
      EXPECT_EQ(sampled > 50, interval < 1e-10);
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
}
}

TEST(PolygonReports, ABeamWhoseRaysMissWhatEntersItMeetsNothing)
{
  for (const BeamSampleSource source : { BeamSampleSource::Cells, BeamSampleSource::Rays })
  {
    for (const double limit : { 0.0, 25.0, 12.0 }) // photons, of 5 that are noise; 0: no noise
    {
      SCOPED_TRACE(testing::Message() << static_cast<int>(source) << ' ' << limit);
      EchoSettings settings = secondarySettings(40);
      settings.beamSamples = source;
      settings.noise = limit > 0.0;
      Sensor sensor;
      sensor.noisePhotonRate = 1e9;
      sensor.lowerEnergyLimit = limit * sensor.photonEnergy();
      // More triangles than may be integrated.
      const ScanSetup setup = makeSetup(specks(40, Vec3(100.0, 0.0, 0.0)), sensor, settings);
      const ScanSetup without = makeSetup(specks(40, Vec3(-100.0, 0.0, 0.0)), sensor, settings);
      const ScanResult nothing = runScan(without, oneBeam());
      EXPECT_EQ(
        nothing.reports[0].status, limit == 12.0 ? BeamStatus::Echo : BeamStatus::NoSurface);
      EXPECT_EQ(nothing.echoes.empty(), limit != 12.0);
      EXPECT_EQ(without.noise.active, limit > 0.0);
      const ScanResult missed = runScan(setup, oneBeam());
      EXPECT_EQ(missed.raysTraced, tracedRaysOf(settings));
      expectSameButForCosts(missed, nothing);
    }
  }
}

TEST(PolygonReports, ASpeckThatNoRayMeetsIsIntegrated)
{
  EchoSettings settings = directSettings(40);
  settings.beamSamples = BeamSampleSource::Cells;
  Sensor sensor;
  sensor.lowerEnergyLimit = 0.0;
  const ScanResult speck =
    runScan(makeSetup(specks(1, Vec3(100.0, 0.0, 0.0)), sensor, settings), oneBeam());
  EXPECT_EQ(speck.reports[0].counters.raysTraced, 0u);
  EXPECT_EQ(speck.reports[0].status, BeamStatus::Echo);
}
