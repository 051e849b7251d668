// SPDX-License-Identifier: BSD-3-Clause
// The beam test rejects volumes that the cone does not meet, and is exact for spheres. That it
// never rejects what a ray of the cone meets is TestGeometryProperties' and TestBeamTracer's.
#include "BeamVolumeTest.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
Vec3 someExtents(Numbers& random, double size)
{
  Vec3 half(size * random(), size * random(), size * random());
  if (random() < 0.2)
  {
    half[static_cast<int>(random.index(3))] = 0.0; // walls and floors have flat boxes
  }
  return half;
}
}

TEST(BeamVolumes, VolumesBehindAndBesideAreRejected)
{
  Numbers random(43);
  for (int i = 0; i < 20000; ++i)
  {
    const Vec3 axis = i % 4 == 0 ? Vec3(0.0, i % 8 - 2.0, 0.0) : random.direction();
    const BeamFrame frame = makeBeamFrame(random.inCube(10.0), axis, random.logUniform(1e-6, 1.0));
    const auto [x, y] = random.inDisc();
    const double phi = std::atan2(y, x);
    // A point at least a fiftieth of a radian beside the cone, up to opposite.
    const double off = random(frame.halfBeamwidth * 1.05 + 0.02, Pi);
    const Vec3 point = random.logUniform(0.1, 1e3) *
      (std::cos(off) * frame.axis +
        std::sin(off) * (std::cos(phi) * frame.e1 + std::sin(phi) * frame.e2));
    const BeamFrame turn = makeBeamFrame(Vec3(0.0), random.direction(), 0.1);
    OBB box;
    box.center = frame.origin + point;
    box.axes = { turn.e1, turn.e2, turn.axis };
    box.half = someExtents(random, 1e-6 * safeLength(point));
    const BoundingSphere sphere{ box.center, 1e-6 * safeLength(point) };
    double nearest;
    EXPECT_FALSE(BeamVolumeTest(frame).meets(box, nearest));
    EXPECT_FALSE(BeamVolumeTest(frame).meets(sphere, nearest));
  }
}

TEST(BeamProjections, AreWiderThanTheCone)
{
  // sin(phi) = sin(t) / sin(psi): a point at 1.04 rad from the projected axis belongs to the
  // projection of a cone of t = 0.3 whose axis is 20 degrees from the normal of the plane; the
  // wedge of half-angle t would miss it. At t = 5.6e-3 and 30 degrees phi is twice t.
  const double degree = Pi / 180.0;
  struct
  {
    double t, psi, phi;
  } const cases[] = { { 0.3, 20.0 * degree, 1.043246812 },
    { 5.6e-3, 30.0 * degree, 0.01120017563 } };
  for (const auto& [t, psi, phi] : cases)
  {
    EXPECT_NEAR(std::asin(std::sin(t) / std::sin(psi)), phi, 1e-9 * phi);
    const BeamFrame frame = makeBeamFrame(Vec3(0.0), { std::sin(psi), 0.0, std::cos(psi) }, t);
    const BeamVolumeTest beam(frame);
    for (const double share : { 0.999, 1.02 })
    {
      // A box of any height, so that the projection on xy alone decides.
      const Vec3 center(std::cos(share * phi), std::sin(share * phi), 0.0);
      const double half = 1e-4 * phi;
      EXPECT_EQ(beam.projectionsMeet(frame.axis, center, { half, half, 1e6 }), share < 1.0) << phi;
    }
  }
  // Within t of the normal the projection is the whole plane.
  const BeamFrame steep = makeBeamFrame(Vec3(0.0), { 0.2, 0.0, 1.0 }, 0.3);
  EXPECT_TRUE(
    BeamVolumeTest(steep).projectionsMeet(steep.axis, { -1.0, 0.0, 0.0 }, { 1e-4, 1e-4, 1e6 }));
}

TEST(BeamProjections, FalsePositivesAreFewAndFewerWithTheTangentPlane)
{
  // Boxes about as large as the footprint, near the cone: which of those that no ray meets are let
  // through? Rays: 2,000 over the cone and its rim, so a box that is only just grazed may count as
  // missed.
  Numbers random(44);
  int misses = 0;
  int byProjections = 0;
  int byAll = 0;
  for (int i = 0; i < 3000; ++i)
  {
    const BeamFrame frame =
      makeBeamFrame(Vec3(0.0), random.direction(), random.logUniform(1e-3, 0.3));
    const double r = random(0.5, 4.0);
    const double phi = random(0.0, 2.0 * Pi);
    const Vec3 center = 100.0 * frame.direction(r * std::cos(phi), r * std::sin(phi));
    const Vec3 half = someExtents(random, 100.0 * frame.tanHalf);
    OBB box;
    box.center = center;
    box.half = half;
    bool met = false;
    for (int ray = 0; ray < 2000 && !met; ++ray)
    {
      const double rho = ray < 500 ? 1.0 : std::sqrt((ray - 500) / 1500.0);
      const Vec3 d =
        unitDirection(frame.direction(rho * std::cos(2.4 * ray), rho * std::sin(2.4 * ray)));
      double entry;
      met = RayVolumeTest(Vec3(0.0), Vec3(0.0), d, 0.0, sizeFrom(Vec3(0.0), box)).meets(box, entry);
    }
    double nearest;
    const bool all = BeamVolumeTest(frame).meets(box, nearest);
    const bool projections = BeamVolumeTest(frame).projectionsMeet(frame.axis, center, half);
    EXPECT_TRUE(all || !met);
    EXPECT_TRUE(projections || !met);
    misses += met ? 0 : 1;
    byProjections += !met && projections ? 1 : 0;
    byAll += !met && all ? 1 : 0;
  }
  RecordProperty("boxes_missed", misses);
  RecordProperty("false_positives_projections", byProjections);
  RecordProperty("false_positives", byAll);
  EXPECT_GT(misses, 1000);
  EXPECT_LT(byAll, byProjections);
  EXPECT_LT(byAll, misses / 20);
}

TEST(BeamSphere, IsExact)
{
  Numbers random(45);
  for (int i = 0; i < 100000; ++i)
  {
    const double t = random.logUniform(1e-3, 1.0);
    const BeamFrame frame = makeBeamFrame(random.inCube(10.0), random.direction(), t);
    // Centre at an angle beta from the axis: distance from the cone's surface D sin(beta - t), from
    // the apex D.
    const double beta = random(t, Pi);
    const double distance = random.logUniform(0.1, 1e3);
    const double phi = random(0.0, 2.0 * Pi);
    const Vec3 d = std::cos(beta) * frame.axis +
      std::sin(beta) * (std::cos(phi) * frame.e1 + std::sin(phi) * frame.e2);
    const double gap = beta - t < 0.5 * Pi ? distance * std::sin(beta - t) : distance;
    BoundingSphere sphere{ frame.origin + distance * d, gap * (1.0 + 1e-9) + 1e-12 };
    double nearest;
    EXPECT_TRUE(BeamVolumeTest(frame).meets(sphere, nearest));
    EXPECT_LE(nearest, distance - sphere.radius < 0.0 ? 0.0 : distance - sphere.radius);
    sphere.radius = gap - 0.01 * distance * std::sin(t);
    if (sphere.radius > 0.0)
    {
      EXPECT_FALSE(BeamVolumeTest(frame).meets(sphere, nearest)) << beta << " " << t;
    }
  }
}
