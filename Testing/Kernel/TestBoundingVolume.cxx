// SPDX-License-Identifier: BSD-3-Clause
#include "AABB.h"
#include "BoundingVolume.h"
#include "GeometryTestScene.h"
#include "PrincipalAxes.h"

#include <gtest/gtest.h>

#include <numeric>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
struct Aligned
{
  using Volume = OBB;
  static OBB fit(const TriangleList& triangles) { return alignedBox(triangles); }
};
struct Oriented
{
  using Volume = OBB;
  static OBB fit(const TriangleList& triangles) { return orientedBox(triangles); }
};
struct Round
{
  using Volume = BoundingSphere;
  static BoundingSphere fit(const TriangleList& triangles) { return boundingSphere(triangles); }
};

std::vector<Vec3> somePoints(Numbers& random)
{
  const double scale = random.logUniform(1e-6, 1e6);
  const Vec3 place = random() < 0.5 ? Vec3(0.0) : random.inCube(1e8);
  // Flat, thin and single-point sets too.
  const Vec3 shape(1.0, random() < 0.3 ? 0.0 : random(), random() < 0.3 ? 0.0 : 1e-3 * random());
  const BeamFrame turn = makeBeamFrame(Vec3(0.0), random.direction(), 0.1);
  std::vector<Vec3> points(1 + random.index(40));
  for (Vec3& p : points)
  {
    const Vec3 q = scale * random.inCube(1.0) * shape;
    p = place + q.x * turn.e1 + q.y * turn.e2 + q.z * turn.axis;
  }
  return points;
}

/// A volume around points, each the corners of a triangle.
template <class Fit>
typename Fit::Volume fitTo(const std::vector<Vec3>& points)
{
  TriangleMesh mesh;
  mesh.points = points;
  std::vector<std::uint32_t> numbers(points.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  for (const std::uint32_t i : numbers)
  {
    mesh.triangles.push_back({ i, i, i });
  }
  return Fit::fit({ mesh, numbers.data(), numbers.size() });
}
}

// That volumes hold what they were fitted to is TestCollisionTreeBuilder's.
TEST(BoundingVolume, OfNothingAreEmpty)
{
  EXPECT_TRUE(fitTo<Aligned>({}).empty());
  EXPECT_TRUE(fitTo<Oriented>({}).empty());
  EXPECT_TRUE(fitTo<Round>({}).empty());
  EXPECT_FALSE(fitTo<Oriented>({ { 1, 2, 3 }, { 4, 5, 7 } }).empty());
  EXPECT_FALSE(fitTo<Round>({ { 1, 2, 3 }, { 4, 5, 7 } }).empty());
}

TEST(BoundingVolume, BoxIsTheSmallest)
{
  const OBB box = fitTo<Aligned>({ { 1, -2, 3 }, { 4, 5, -6 }, { 0, 0, 0 } });
  EXPECT_EQ(box.center, Vec3(2, 1.5, -1.5));
  EXPECT_NEAR(surfaceArea(box), 2.0 * (4 * 7 + 7 * 9 + 9 * 4), 1e-12 * surfaceArea(box));
}

TEST(BoundingVolume, OrientedBoxFollowsAnObliqueBar)
{
  Numbers random(54);
  const BeamFrame turn = makeBeamFrame(Vec3(0.0), { 1, 2, 3 }, 0.1);
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i)
  {
    points.push_back((i & 1 ? 10.0 : -10.0) * turn.axis + (i & 2 ? 1.0 : -1.0) * turn.e1 +
      (i & 4 ? 0.5 : -0.5) * turn.e2 + Vec3(100, 200, 300));
  }
  const OBB box = fitTo<Oriented>(points);
  EXPECT_NEAR(surfaceArea(box), 8.0 * (10 * 1 + 1 * 0.5 + 0.5 * 10), 1e-9);
  EXPECT_NEAR(glm::length(box.center - Vec3(100, 200, 300)), 0.0, 1e-9);
  EXPECT_LT(surfaceArea(box), surfaceArea(fitTo<Aligned>(points)));
}

TEST(BoundingVolume, OrientedBoxIsNeverMuchLargerThanTheAlignedOne)
{
  Numbers random(55);
  for (int i = 0; i < 1000; ++i)
  {
    const std::vector<Vec3> points = somePoints(random);
    const double aligned = surfaceArea(fitTo<Aligned>(points));
    const double size = safeLength(points[0]);
    EXPECT_LE(surfaceArea(fitTo<Oriented>(points)),
      aligned * (1.0 + 1e-12) + 1e-13 * size * (size + std::sqrt(aligned)));
  }
}

TEST(BoundingVolume, SphereIsNearlyTheSmallest)
{
  // Points on a sphere all around: the smallest is that sphere.
  Numbers random(56);
  std::vector<Vec3> points;
  for (int i = 0; i < 500; ++i)
  {
    points.push_back(Vec3(5, 6, 7) + 3.0 * random.direction());
  }
  const BoundingSphere sphere = fitTo<Round>(points);
  EXPECT_LT(sphere.radius, 3.0 * 1.05);
  EXPECT_GE(sphere.radius, 2.99);
}

TEST(BoundingVolume, PrincipalAxes)
{
  Numbers random(57);
  for (int i = 0; i < 2000; ++i)
  {
    const BeamFrame turn = makeBeamFrame(Vec3(0.0), random.direction(), 0.1);
    const double big = random.logUniform(1e-20, 1e20);
    const double value[3] = { big, big * random(0.1, 0.9), big * random(0.0, 0.05) };
    const Vec3 axis[3] = { turn.axis, turn.e1, turn.e2 };
    glm::dmat3 m(0.0);
    for (int k = 0; k < 3; ++k)
    {
      m += value[k] * glm::outerProduct(axis[k], axis[k]);
    }
    const glm::dmat3 found = principalAxes(m);
    for (int k = 0; k < 3; ++k)
    {
      EXPECT_NEAR(std::fabs(glm::dot(found[k], axis[k])), 1.0, 1e-10);
    }
    EXPECT_NEAR(glm::dot(glm::cross(found[0], found[1]), found[2]), 1.0, 1e-12);
  }
  EXPECT_EQ(principalAxes(glm::dmat3(0.0))[0], Vec3(1, 0, 0));
  EXPECT_EQ(principalAxes(glm::dmat3(NAN))[0], Vec3(1, 0, 0));
}
