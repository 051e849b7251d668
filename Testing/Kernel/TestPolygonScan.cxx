// SPDX-License-Identifier: BSD-3-Clause
// Scans of which some beams are integrated: the same bits however they are made.
#include "GeometryTestScene.h"
#include "IntegrationTestScene.h"
#include "ScanTestTown.h"
#include "VolumeTree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
/// Boxes all around, some hundred beams.
ScanSetup boxesAround()
{
  Scene scene;
  Numbers random(7);
  for (int box = 0; box < 12; ++box)
  {
    const double azimuth = 2.0 * Pi * box / 12;
    scene.box(random(40.0, 90.0) * Vec3(std::cos(azimuth), std::sin(azimuth), 0.0),
      Vec3(6.0, 6.0, 15.0), box % 2 ? Wall : Glass, box);
  }
  EchoSettings settings;
  settings.beamSamples = BeamSampleSource::Cells;
  settings.noise = false;
  Sensor sensor;
  sensor.lowerEnergyLimit = 2e-7;
  return makeSetup(scene, sensor, settings);
}
}

TEST(PolygonScan, TheSameBitsHoweverItIsDone)
{
  ScanSetup setup = boxesAround();
  const ScanBeams beams = ring(400);
  const ScanResult once = runScan(setup, beams);
  const std::vector<bool> integrated = integratedOf(once);
  const auto number = std::count(integrated.begin(), integrated.end(), true);
  EXPECT_GT(number, 50);
  EXPECT_LT(number, 350);
  expectSame(once, runScan(setup, beams, 3));
  setup.settings.traceMode = TraceMode::SingleRays;
  expectSame(once, runScan(setup, beams));
  setup.settings.traceMode = TraceMode::Automatic;
  // A triangle beside the disc may reach the search or not.
  const std::shared_ptr<const CollisionTree> tree = setup.tree;
  for (const int leaf : { 1, 2, 16 })
  {
    for (const BoundingVolumeType volume : { BoundingVolumeType::AABB, BoundingVolumeType::Sphere })
    {
      TreeOptions options;
      options.maximumLeafSize = leaf;
      options.boundingVolume = volume;
      setup.tree = buildVolumeTree(tree->mesh, options);
      finishSetup(setup);
      expectSame(once, runScan(setup, beams));
    }
  }
  setup.tree = tree;
  finishSetup(setup);
  std::vector<bool> before(beams.size(), false);
  for (const int rays : { 1, 32, 100, 10000 })
  {
    setup.settings.raysPerBeam = rays;
    const std::vector<bool> now = integratedOf(runScan(setup, beams));
    for (std::size_t b = 0; b < beams.size(); ++b)
    {
      EXPECT_LE(before[b], now[b]) << b;
      // Those before it decide when a beam is looked at, not how it ends.
      ScanBeams one;
      one.ids.push_back(beams.ids[b]);
      one.origins.push_back(beams.origins[b]);
      one.directions.push_back(beams.directions[b]);
      EXPECT_EQ(isIntegrated(runScan(setup, one)), now[b]) << b;
    }
    before = now;
  }
  // N decides from 5,000 rays on.
  setup.settings.raysPerBeam = 1;
  EXPECT_EQ(integratedOf(runScan(setup, beams)), integrated);
}

TEST(PolygonScan, LitAgainIsFresh)
{
  ScanSetup setup = boxesAround();
  const ScanBeams beams = ring(400);
  TraceCache cache;
  ScanResult result;
  const auto check = [&](const char* what)
  {
    SCOPED_TRACE(what);
    finishSetup(setup);
    ASSERT_TRUE(simulateScan(setup, beams, 2, cache, std::size_t(1) << 30, {}, result));
    expectSame(result, runScan(setup, beams));
  };
  check("first");
  setup.settings.attenuationCoefficient = 1e-3;
  check("air");
  setup.sensor.lowerEnergyLimit = 1e-6;
  check("limit");
  setup.sensor.samplingInterval = 2e-9;
  check("range units");
  std::vector<Material> materials(setup.tree->mesh->size(), Wall);
  setup.materials = materials;
  check("all walls");
  materials[0] = Glass; // its plane is no longer of one material
  setup.materials = materials;
  check("one triangle");
  materials[0] = Wall;
  setup.materials = materials;
  check("walls again");
  setup.settings.beamSamples = BeamSampleSource::Rays;
  check("off");
}
