// SPDX-License-Identifier: BSD-3-Clause
// Beams that would need too many samples are sampled with rays instead.
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"
#include "PolygonQuadrature.h"
#include "VisiblePolygons.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
struct Nodes
{
  bool fits;
  std::size_t count; ///< of a beam that fits
};

/// The nodes of a beam along x.
Nodes nodesOf(const ScanSetup& setup)
{
  const BeamFrame frame =
    makeBeamFrame(Vec3(0.0), Vec3(1.0, 0.0, 0.0), BeamWidth(setup.sensor.halfBeamwidth));
  PolygonFinder finder(*setup.tree, mostTrianglesIntegrated(setup.settings));
  finder.begin(frame);
  std::vector<std::uint32_t> triangles(setup.tree->mesh->size());
  std::iota(triangles.begin(), triangles.end(), 0u);
  std::unique_ptr<VisiblePolygons> found;
  PolygonQuadrature quadrature(setup);
  if (!finder.add(triangles.data(), triangles.size()) || finder.find(found) != SeenByBeam::Polygons)
  {
    return { false, 0 };
  }
  quadrature.begin(frame, *found);
  return quadrature.fits() ? Nodes{ true, quadrature.place().samples.size() } : Nodes{ false, 0 };
}

double mostNodes(int rays)
{
  return std::max(3000.0, 5.0 * rays);
}

/// Ground below the lidar, up to a distance.
Scene groundUpTo(double distance)
{
  Scene scene;
  scene.plate(
    Vec3(0.0, 0.0, -3.0), Vec3(distance, 0.0, 0.0), Vec3(0.0, 100.0, 0.0), { 0.3, 0.0, 0.0 });
  return scene;
}
}

TEST(PolygonLimits, GroundOverMoreRangeUnitsThanNodesAllowIsSampled)
{
  // The beam is about the horizon: the ground fills range units from where it enters the beam on.
  Sensor sensor;
  sensor.lowerEnergyLimit = 0.0; // nothing is faint
  const double first = 3.0 / std::tan(sensor.halfBeamwidth);
  int sampled = 0;
  int integrated = 0;
  for (const int rays : { 20, 600, 1000, 1500 })
  {
    for (const double share : { 0.1, 0.5, 0.8, 1.2, 2.0 })
    {
      SCOPED_TRACE(testing::Message() << rays << " rays, " << share);
      // Two nodes a unit.
      const double units = 0.5 * share * mostNodes(rays);
      const double last = first + units * sensor.rangeUnitLength();
      if (last > sensor.rangeGate)
      {
        continue;
      }
      const ScanSetup setup = makeSetup(groundUpTo(last), sensor, integrating(rays));
      const ScanResult result = runScan(setup, oneBeam());
      EXPECT_EQ(isIntegrated(result), share < 1.0);
      EXPECT_EQ(result.raysTraced, share < 1.0 ? 0u : rays);
      const Nodes nodes = nodesOf(setup);
      EXPECT_EQ(nodes.fits, share < 1.0);
      EXPECT_LE(nodes.count, mostNodes(rays));
      EXPECT_GE(nodes.count, share < 1.0 ? 0.9 * share * mostNodes(rays) : 0.0);
      sampled += share > 1.0;
      integrated += share < 1.0;
    }
  }
  EXPECT_GE(sampled, 3);
  EXPECT_GE(integrated, 9);
}

TEST(PolygonLimits, NoProfileAndNoLobeAsksForMoreNodesThanAllowed)
{
  Numbers random(32);
  int fitting = 0;
  int byRules = 0;
  int refused = 0;
  for (int k = 0; k < 3000; ++k)
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
    const int rays = k % 3 ? 100 : 1000;
    const Nodes nodes = nodesOf(makeSetup(scene, sensor, integrating(rays)));
    // Rules are counted by an estimate that misses some strips.
    EXPECT_LE(nodes.count, 2.0 * mostNodes(rays));
    fitting += nodes.fits;
    byRules += nodes.fits && sensor.beamProfile == BeamProfile::Gaussian;
    refused += !nodes.fits;
  }
  EXPECT_GT(fitting, 300);
  EXPECT_GT(byRules, 30);
  EXPECT_GT(refused, 300);
}

TEST(PolygonLimits, WhereNothingMayBeDroppedFaintGroundIsBoundedToo)
{
  // Faint ground of 50,000 nodes, or of 150,000; none where it is dropped.
  Sensor sensor = openSensor(1e-3);
  sensor.samplingInterval = 0.02 / (0.5 * SpeedOfLight);
  sensor.rangeGate = 5000.0;
  sensor.lowerEnergyLimit = 0.01;
  sensor.upperEnergyLimit = 1.0;
  for (const double distance : { 3500.0, 4500.0 })
  {
    SCOPED_TRACE(distance);
    ScanSetup setup = makeSetup(groundUpTo(distance), sensor, integrating(100));
    const Nodes dropped = nodesOf(setup);
    EXPECT_TRUE(dropped.fits);
    EXPECT_EQ(dropped.count, 0u);
    setup.settings.fullModel = true;
    finishSetup(setup);
    const Nodes full = nodesOf(setup);
    EXPECT_EQ(full.fits, distance < 4000.0);
    EXPECT_EQ(isIntegrated(runScan(setup, oneBeam())), distance < 4000.0);
    EXPECT_LE(full.count, 1e5);
  }
}
