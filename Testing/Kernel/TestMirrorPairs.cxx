// SPDX-License-Identifier: BSD-3-Clause
// From a surface without pairs no mirror path is traced, and none would have arrived.
#include "RoomTestScene.h"
#include "SameEchoes.h"

#include <gtest/gtest.h>

using namespace echotest;

namespace
{
/// Rays traced of one beam that meets a scene of metal.
std::uint64_t tracedOf(const Scene& scene, bool beamConstraint, double& received,
  BeamSampleSource source = BeamSampleSource::Rays)
{
  EchoSettings settings = secondarySettings(100, 0, source);
  settings.beamConstraint = beamConstraint;
  const ScanResult result = runScan(makeSetup(scene, openSensor(), settings), oneBeam());
  received = secondaryOf(result);
  return result.raysTraced;
}
}

TEST(MirrorPairs, NothingArrivesFromSurfacesWithoutPairs)
{
  std::uint64_t constrained = 0;
  std::uint64_t all = 0;
  double secondary = 0.0;
  for (unsigned seed = 0; seed < 60; ++seed)
  {
    const Scene scene = room(seed);
    const ScanBeams beams = around(seed, 40);
    Sensor sensor = openSensor(Numbers(seed)() < 0.5 ? 5.6e-3 : 0.1);
    EchoSettings settings = secondarySettings(30, 8, BeamSampleSource::Rays);
    settings.lightEnergyConstraint = false;
    const ScanResult pairs = runScan(makeSetup(scene, sensor, settings), beams);
    settings.beamConstraint = false; // every path is traced
    const ScanResult full = runScan(makeSetup(scene, sensor, settings), beams);
    EXPECT_TRUE(sameEchoes(pairs, full)) << seed;
    secondary += secondaryOf(full);
    constrained += pairs.raysTraced;
    all += full.raysTraced;
  }
  EXPECT_GT(secondary, 0.0);
  EXPECT_LT(constrained, 0.8 * all);
}

TEST(MirrorPairs, AWallAloneIsNotSearched)
{
  Scene scene;
  scene.plate(Vec3(10.0, 0.0, 0.0), Vec3(0.0, 5.0, 0.0), Vec3(0.5, 0.0, 5.0), Metal);
  double received = 0.0;
  EXPECT_EQ(tracedOf(scene, true, received), 100u);
  EXPECT_EQ(tracedOf(scene, false, received), 200u);
  // Floor and a wall aside, which the beam does not meet before the plane of the first.
  scene.plate(Vec3(10.0, 0.0, -3.0), Vec3(20.0, 0.0, 0.0), Vec3(0.0, 20.0, 0.0), Metal);
  scene.plate(Vec3(10.0, 4.0, 0.0), Vec3(20.0, 0.0, 0.0), Vec3(0.0, 0.0, 20.0), Metal);
  EXPECT_EQ(tracedOf(scene, true, received), 100u);
  // By regions nothing is traced but what may arrive.
  EXPECT_EQ(tracedOf(scene, true, received, BeamSampleSource::Cells), 0u);
}

TEST(MirrorPairs, ACornerIsOneOnlyOnItsInside)
{
  // A right angle, seen from within and from without. The ends are looked at from the apex, too.
  for (const BeamSampleSource source : BothSources)
  {
    const std::uint64_t starts = source == BeamSampleSource::Rays ? 100 : 0;
    double received = 0.0;
    EXPECT_GT(tracedOf(groove(45.0 * Degree, Metal), true, received, source), 2 * starts);
    EXPECT_GT(received, 0.0);
    EXPECT_EQ(tracedOf(groove(135.0 * Degree, Metal), true, received, source), starts);
    EXPECT_EQ(received, 0.0);
  }
}
