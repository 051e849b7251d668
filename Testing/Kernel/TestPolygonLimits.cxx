// SPDX-License-Identifier: BSD-3-Clause
// Beams that would need too many samples are divided into cells instead.
#include "FoundPolygons.h"
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"
#include "PolygonQuadrature.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
struct Nodes
{
  bool fits;
  std::size_t count; ///< number of nodes, for a beam that fits
};

/// The nodes of a beam along x.
Nodes nodesOf(const ScanSetup& setup)
{
  const BeamFrame frame =
    makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), BeamWidth(setup.sensor.halfBeamwidth));
  FoundPolygons found(*setup.tree, mostTrianglesIntegrated(setup.settings));
  if (found.find(frame) != SeenByBeam::Polygons || !PolygonRule(setup, 1.0).fits(*found.polygons))
  {
    return { false, 0 };
  }
  PolygonQuadrature quadrature(setup, 1.0);
  PolygonBounds bounds;
  PolygonNodes nodes;
  quadrature.bound(*found.polygons, bounds);
  quadrature.place(frame, *found.polygons, bounds, nodes);
  return { true, nodes.samples.size() };
}
}

TEST(PolygonLimits, GroundOverMoreRangeUnitsThanNodesAllowIsDividedIntoCells)
{
  // The beam is about the horizon: the ground fills range units from where it enters the beam on.
  Sensor sensor;
  sensor.halfBeamwidth = 1e-3;
  sensor.samplingInterval = 2e-10;
  sensor.pulseWidth = 0.0;
  const double first = 3.0 / std::tan(sensor.halfBeamwidth);
  for (const double limit : { 0.0, 1.0 }) // nothing is faint, or all that is dropped
  {
    sensor.lowerEnergyLimit = limit;
    sensor.upperEnergyLimit = 2.0;
    for (const bool full : { false, true })
    {
      for (const int rays : { 20, 1000 })
      {
        for (const double share : { 0.1, 0.5, 0.8, 1.2, 2.0 })
        {
          SCOPED_TRACE(testing::Message() << limit << ' ' << full << ' ' << rays << ' ' << share);
          // Two nodes a unit.
          const double units = 0.5 * share * MostNodes;
          const double last = first + units * sensor.rangeUnitLength();
          EchoSettings settings = inCells(rays);
          settings.fullModel = full;
          Scene ground;
          ground.plate(
            Vec3(0.0, 0.0, -3.0), Vec3(last, 0.0, 0.0), Vec3(0.0, 100.0, 0.0), { 0.3, 0.0, 0.0 });
          const ScanSetup setup = makeSetup(ground, sensor, settings);
          EXPECT_EQ(runScan(setup, oneBeam()).reports[0].direct,
            share < 1.0 ? DirectEcho::Polygons : DirectEcho::Cells);
          const Nodes nodes = nodesOf(setup);
          EXPECT_EQ(nodes.fits, share < 1.0);
          EXPECT_LE(nodes.count, MostNodes);
          const bool any = share < 1.0 && (full || limit == 0.0);
          EXPECT_GE(nodes.count, any ? 0.9 * share * MostNodes : 0.0);
          EXPECT_EQ(nodes.count > 0, any);
        }
      }
    }
  }
}

TEST(PolygonLimits, NoProfileAndNoLobeTakesVeryManyNodes)
{
  Numbers random(32);
  int fitting = 0;
  int byRules = 0;
  int refused = 0;
  std::size_t most = 0;
  for (int k = 0; k < 5000; ++k)
  {
    SCOPED_TRACE(k);
    Sensor sensor = openSensor(random.logUniform(1e-3, 0.1));
    sensor.samplingInterval = random.logUniform(2e-10, 1e-7);
    sensor.pulseWidth = sensor.samplingInterval * random(0.0, 3.0);
    sensor.beamProfile = k % 2 ? BeamProfile::Gaussian : BeamProfile::Uniform;
    Scene scene;
    const std::size_t count = 1 + random.index(30);
    for (std::size_t i = 0; i < count; ++i)
    {
      const double x = random(20.0, 100.0);
      const double spot = x * std::tan(sensor.halfBeamwidth);
      const auto corner = [&]()
      {
        return Vec3(x, 0.0, 0.0) +
          spot * Vec3(random(-9.0, 9.0), random(-2.0, 2.0), random(-2.0, 2.0));
      };
      const Material material{ random(0.0, 0.5), random(0.0, 0.5), random.logUniform(1.0, 1e6) };
      const Vec3 a = corner();
      const Vec3 b = corner();
      scene.triangle(a, b, corner(), material, static_cast<int>(i));
    }
    EchoSettings settings = integrating();
    settings.reflectanceModel = static_cast<ReflectanceModel>(k % 4);
    const Nodes nodes = nodesOf(makeSetup(scene, sensor, settings));
    most = std::max(most, nodes.count);
    for (Material& material : scene.materials)
    {
      material.ks = 0.0;
    }
    const Nodes plain = nodesOf(makeSetup(scene, sensor, settings));
    EXPECT_EQ(plain.fits, nodes.fits);
    // Rules are counted by an estimate that misses some strips.
    EXPECT_LE(plain.count, 2.0 * MostNodes);
    fitting += nodes.fits;
    byRules += nodes.fits && k % 2;
    refused += !nodes.fits;
  }
  EXPECT_GT(fitting, 300);
  EXPECT_GT(byRules, 30);
  EXPECT_GT(refused, 300);
  EXPECT_LT(most, 300000u);
}
