// SPDX-License-Identifier: BSD-3-Clause
// The beam test never rejects a volume that a ray of the cone meets.
#include "BeamVolumeTest.h"
#include "GeometryTestScene.h"
#include "Sanitized.h"
#include "TriangleTest.h"

#include <gtest/gtest.h>

#include <type_traits>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
constexpr int Cases = IsSanitized ? 50000 : 1000000;

struct Case
{
  BeamFrame frame;
  Vec3 ray;    ///< unit direction within the cone
  Vec3 point;  ///< on the ray, relative to the apex
  double size; ///< size of the volume around the point
};

Vec3 someAxis(Numbers& random)
{
  Vec3 axis(0.0);
  const std::size_t k = random.index(3);
  switch (random.index(4))
  {
    case 0: // along a coordinate axis
      axis[k] = random() < 0.5 ? 1.0 : -1.0;
      return axis;
    case 1: // near one
      axis[k] = random() < 0.5 ? 1.0 : -1.0;
      axis[(k + 1) % 3] = random.logUniform(1e-12, 1e-1) * (random() < 0.5 ? 1.0 : -1.0);
      axis[(k + 2) % 3] = random.logUniform(1e-12, 1e-1) * (random() < 0.5 ? 1.0 : -1.0);
      return axis;
    case 2: // in a coordinate plane
      axis = random.direction();
      axis[k] = 0.0;
      return axis;
    default:
      return random.direction();
  }
}

/// Within the cone to 1e-12 rad.
bool inCone(const BeamFrame& frame, const Vec3& v)
{
  const Vec3 p = frame.toPlane(v);
  return p.z > 0.0 && std::hypot(p.x, p.y) * frame.tanHalf <= p.z * (frame.tanHalf + 1e-12);
}

Case someCase(Numbers& random)
{
  const Vec3 places[] = { Vec3(0.0), { 10.5, -3.25, 2.0 }, { 5e5, 3.4e6, 10.0 },
    { -2853445.3, 4667464.9, 3268291.0 } };
  Case c;
  c.frame = makeBeamFrame(places[random.index(4)], someAxis(random), random.logUniform(1e-6, 1.0));
  // Half of the rays on the rim of the cone, where mistakes show.
  auto [x, y] = random.inDisc();
  if (random() < 0.5)
  {
    const double r = std::sqrt(x * x + y * y) * (1.0 + 1e-12);
    x /= r;
    y /= r;
  }
  // The point in scene coordinates is rounded, at places far from their origin by more than the
  // margins: on the rim half of the rounded points lie outside.
  do
  {
    const Vec3 exact = random.logUniform(1e-2, 1e4) * unitDirection(c.frame.direction(x, y));
    c.point = (c.frame.origin + exact) - c.frame.origin;
    x *= 1.0 - 1e-9;
    y *= 1.0 - 1e-9;
  } while (!inCone(c.frame, c.point));
  c.ray = unitDirection(c.point);
  // From far smaller than the beam's footprint to so large that the apex lies inside, or the centre
  // behind it.
  c.size = safeLength(c.point) * random.logUniform(1e-7, 1e2);
  return c;
}

/// Where in a unit cube the ray's point shall lie: inside, on a face, an edge or in a corner.
Vec3 somePlace(Numbers& random)
{
  Vec3 place = random.inCube(1.0);
  for (int axis = 0; axis < 3; ++axis)
  {
    if (random() < 0.6)
    {
      place[axis] = place[axis] < 0.0 ? -1.0 : 1.0;
    }
  }
  return place;
}

Vec3 someExtents(Numbers& random, double size)
{
  Vec3 half(size * random(), size * random(), size * random());
  if (random() < 0.2)
  {
    half[static_cast<int>(random.index(3))] = 0.0; // walls and floors have flat boxes
  }
  return half;
}

OBB around(const Case& c, Numbers& random, OBB*)
{
  const BeamFrame own = makeBeamFrame(Vec3(0.0), random() < 0.3 ? c.ray : random.direction(), 0.1);
  OBB box;
  if (random() < 0.5)
  {
    box.axes = { own.e1, own.e2, own.axis };
  }
  box.half = someExtents(random, c.size);
  const Vec3 p = somePlace(random) * box.half;
  box.center =
    c.frame.origin + c.point - (p.x * box.axes[0] + p.y * box.axes[1] + p.z * box.axes[2]);
  const Vec3 off = c.frame.origin + c.point - box.center;
  for (int i = 0; i < 3; ++i)
  {
    box.half[i] = std::fmax(box.half[i], std::fabs(glm::dot(off, box.axes[i]))); // rounding
  }
  return box;
}

BoundingSphere around(const Case& c, Numbers& random, BoundingSphere*)
{
  BoundingSphere sphere;
  const double share = random() < 0.6 ? 1.0 : random();
  sphere.center = c.frame.origin + c.point + share * c.size * random.direction();
  sphere.radius = std::fmax(c.size, glm::length(c.frame.origin + c.point - sphere.center));
  return sphere;
}

template <class Volume>
class BeamVolumes : public testing::Test
{
};
using BeamTestVolumes = testing::Types<OBB, BoundingSphere>;
TYPED_TEST_SUITE(BeamVolumes, BeamTestVolumes);
}

TYPED_TEST(BeamVolumes, NoVolumeThatARayOfTheConeMeetsIsRejected)
{
  Numbers random(41);
  int wrong = 0;
  int late = 0;
  int inside = 0;
  for (int i = 0; i < Cases; ++i)
  {
    const Case c = someCase(random);
    const TypeParam volume = around(c, random, static_cast<TypeParam*>(nullptr));
    const Vec3 point = c.frame.origin + c.point;
    ASSERT_TRUE(contains(volume, point));
    inside += contains(volume, c.frame.origin) ? 1 : 0;
    const double range = safeLength(c.point);
    double nearest = -1.0;
    double entry = -1.0;
    wrong += BeamVolumeTest(c.frame).meets(volume, nearest) ? 0 : 1;
    wrong += RayVolumeTest(c.frame.origin, Vec3(0.0), c.ray, 0.0, sizeFrom(c.frame.origin, volume))
               .meets(volume, entry)
      ? 0
      : 1;
    late += nearest > range || entry > range ? 1 : 0;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(late, 0) << "lower bounds beyond the point";
  EXPECT_GT(inside, Cases / 50);
  this->RecordProperty("apex_inside", inside);
}

TYPED_TEST(BeamVolumes, VolumesAimedAtThroughTheirMiddle)
{
  // The centre lies on the axis but for round-off: what is left of it across the axis is noise.
  Numbers random(43);
  int wrong = 0;
  for (int i = 0; i < Cases / 4; ++i)
  {
    const double halfBeamwidth = std::pow(10.0, -9.0 + 9.0 * random());
    const double range = std::pow(10.0, -2.0 + 7.0 * random());
    const Vec3 direction = random.direction();
    Case c;
    c.frame = makeBeamFrame(Vec3(0.0), direction, halfBeamwidth);
    c.size = range * std::pow(10.0, -6.0 + 5.0 * random());
    c.point = range * direction;
    if (random() < 0.5)
    {
      c.point += range * std::pow(10.0, -16.0 + 6.0 * random()) * random.direction();
    }
    const Vec3 half(
      c.size * (0.1 + random()), c.size * (0.1 + random()), c.size * (0.1 + random()));
    TypeParam volume;
    if constexpr (std::is_same_v<TypeParam, OBB>)
    {
      const BeamFrame own = makeBeamFrame(Vec3(0.0), random.direction(), 0.1);
      volume.center = c.point;
      volume.axes = { own.e1, own.e2, own.axis };
      volume.half = half;
    }
    else
    {
      volume.center = c.point;
      volume.radius = half.x;
    }
    double nearest = -1.0;
    wrong += BeamVolumeTest(c.frame).meets(volume, nearest) ? 0 : 1;
  }
  EXPECT_EQ(wrong, 0);
}

TYPED_TEST(BeamVolumes, VolumesBehindAndBesideAreRejected)
{
  Numbers random(43);
  for (int i = 0; i < 20000; ++i)
  {
    const BeamFrame frame =
      makeBeamFrame(random.inCube(10.0), someAxis(random), random.logUniform(1e-6, 1.0));
    const double angle = frame.halfBeamwidth * 1.05 + 0.02;
    const auto [x, y] = random.inDisc();
    const double phi = std::atan2(y, x);
    // A point at least `angle` off the axis, up to opposite.
    const double off = random(angle, Pi);
    const Vec3 d = std::cos(off) * frame.axis +
      std::sin(off) * (std::cos(phi) * frame.e1 + std::sin(phi) * frame.e2);
    Case c{ frame, d, random.logUniform(0.1, 1e3) * d, 0.0 };
    c.size = 1e-6 * safeLength(c.point);
    const TypeParam volume = around(c, random, static_cast<TypeParam*>(nullptr));
    double nearest;
    EXPECT_FALSE(BeamVolumeTest(frame).meets(volume, nearest));
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
