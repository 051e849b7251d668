// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTracer.h"
#include "GeometryTestScene.h"
#include "TriangleTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
bool oppositeBits(double a, double b)
{
  return a == -b;
}

double rangeAlong(const Corners& corners, const Vec3& direction)
{
  const Vec3 d = unitDirection(direction);
  return rayAccepted(corners, d) ? rangeOf(corners, planeOf(corners), d, 0.0) : NoRange;
}

using Long3 = glm::vec<3, long double, glm::highp>;

/// Kahan's difference of products again: for needles long double alone is not enough.
Long3 longCross(const Long3& u, const Long3& v)
{
  const auto difference = [](long double a, long double b, long double c, long double d)
  {
    const long double cd = c * d;
    return std::fma(a, b, -cd) + std::fma(-c, d, cd);
  };
  return { difference(u.y, v.z, u.z, v.y), difference(u.z, v.x, u.x, v.z),
    difference(u.x, v.y, u.y, v.x) };
}

/// Distance of the point at `range` along d from the triangle, in extended precision.
double distanceFrom(const Corners& t, const Vec3& d, double range)
{
  const Long3 p = static_cast<long double>(range) * Long3(d);
  const Long3 corner[3] = { Long3(t.a), Long3(t.b), Long3(t.c) };
  const Long3 normal = longCross(corner[1] - corner[0], corner[2] - corner[0]);
  long double nearest = std::numeric_limits<long double>::infinity();
  bool above = true;
  for (int i = 0; i < 3; ++i)
  {
    const Long3 a = corner[i];
    const Long3 side = corner[(i + 1) % 3] - a;
    const long double squared = glm::dot(side, side);
    const long double share =
      squared > 0.0L ? std::clamp(glm::dot(p - a, side) / squared, 0.0L, 1.0L) : 0.0L;
    nearest = std::min(nearest, glm::length(p - a - share * side));
    above = above && glm::dot(longCross(side, p - a), normal) >= 0.0L;
  }
  if (above)
  {
    nearest = std::min(nearest, std::fabs(glm::dot(p - corner[0], normal)) / glm::length(normal));
  }
  return static_cast<double>(nearest);
}

Corners someTriangle(Numbers& random)
{
  const Vec3 center = random.logUniform(1.0, 1e4) * random.direction();
  const double size = random.logUniform(1e-4, 1e3);
  const Vec3 a = center + random.inCube(size);
  const Vec3 b = center + random.inCube(size);
  return { a, b, center + random.inCube(size) };
}
}

TEST(TriangleTest, SharedEdgesHaveTheSameBitsButForTheSign)
{
  // What watertightness rests on; it fails where the compiler contracts products and sums.
  Numbers random(91);
  for (int i = 0; i < 200000; ++i)
  {
    const Corners t = someTriangle(random);
    const EdgeVector there = edgeVector(t.a, t.b);
    const EdgeVector back = edgeVector(t.b, t.a);
    ASSERT_TRUE(oppositeBits(there.e.x, back.e.x) && oppositeBits(there.e.y, back.e.y) &&
      oppositeBits(there.e.z, back.e.z));
    ASSERT_EQ(there.spread, back.spread);
    const BeamPlaneMap map(makeBeamFrame(Vec3(0.0), t.c, random.logUniform(1e-6, 1.0)));
    const BeamEdge p = map.edge(there, 1.0);
    const BeamEdge q = map.edge(back, -1.0);
    ASSERT_TRUE(p.x == q.x && p.y == q.y && p.z == q.z && p.tolerance == q.tolerance);
  }
}

TEST(TriangleTest, ErrorsOfEdgeFunctionsStayWithinTheirTolerance)
{
  Numbers random(92);
  for (int i = 0; i < 200000; ++i)
  {
    const Corners t = someTriangle(random);
    const BeamFrame frame = makeBeamFrame(
      Vec3(0.0), 0.5 * (t.a + t.b) + 1e-3 * random() * t.c, random.logUniform(1e-6, 1.0));
    const auto [x, y] = random.inDisc();
    const long double tan = frame.tanHalf;
    const Vec3L d = wide(frame.axis) + tan * (static_cast<long double>(x) * wide(frame.e1)) +
      tan * (static_cast<long double>(y) * wide(frame.e2));
    const long double exact = dot(cross(wide(t.a) - wide(t.b), wide(t.a) + wide(t.b)), d);
    const BeamEdge e = BeamPlaneMap(frame).edge(edgeVector(t.a, t.b), 1.0);
    ASSERT_LE(std::fabs((e.x * x + e.y * y) + e.z - exact), e.tolerance);
  }
}

TEST(TriangleTest, RangesAreThoseOfThePlane)
{
  // n . a / n . d by hand: the plane z = 10 seen at an angle, from both sides of the triangle.
  const Corners t{ { -5, -5, 10 }, { 5, -5, 10 }, { 0, 10, 10 } };
  const Corners turned{ t.a, t.c, t.b };
  EXPECT_DOUBLE_EQ(rangeAlong(t, { 0, 0, 1 }), 10.0);
  EXPECT_DOUBLE_EQ(rangeAlong(turned, { 0, 0, 7 }), 10.0);
  EXPECT_DOUBLE_EQ(rangeAlong(t, { 0.1, 0.4, 1 }), 10.0 * std::sqrt(1.17));
  EXPECT_EQ(rangeAlong(t, { 0, 0, -1 }), NoRange);
  EXPECT_EQ(rangeAlong(turned, { 0, 0, -1 }), NoRange);
  EXPECT_EQ(rangeAlong(t, { 1, 1, 1 }), NoRange);
  // On a vertex and on an edge.
  EXPECT_DOUBLE_EQ(rangeAlong(t, t.a), std::sqrt(150.0));
  EXPECT_DOUBLE_EQ(rangeAlong(t, 0.5 * (t.a + t.b)), std::sqrt(125.0));
}

TEST(TriangleTest, DegenerateTrianglesAreNeverHit)
{
  Numbers random(93);
  for (int i = 0; i < 10000; ++i)
  {
    const Vec3 a = random.inCube(10.0);
    const Vec3 b = random.inCube(10.0);
    for (const Corners& t : { Corners{ a, a, b }, Corners{ a, b, b }, Corners{ a, b, a },
           Corners{ a, a, a }, Corners{ a, 2.0 * a, 4.0 * a }, Corners{ Vec3(0.0), a, b } })
    {
      EXPECT_EQ(rangeAlong(t, a), NoRange);
      EXPECT_EQ(rangeAlong(t, 0.5 * (a + b)), NoRange);
    }
  }
}

TEST(TriangleTest, RangesOfSliversStayWithinTheirCorners)
{
  Numbers random(94);
  int hits = 0;
  for (int i = 0; i < 200000; ++i)
  {
    // Needles of all shapes and sides, many seen nearly edge-on, some reaching behind the apex.
    const Vec3 a = random.inCube(50.0);
    const Vec3 b = a + random.logUniform(1e-3, 1e3) * random.direction();
    const Vec3 c = a + random() * (b - a) + random.logUniform(1e-13, 1.0) * random.direction();
    const Corners t{ a, b, c };
    const double u = random();
    const double v = random() * (1.0 - u);
    const Vec3 target = a + u * (b - a) + v * (c - a);
    const Vec3 d = unitDirection(target);
    const double range = rangeAlong(t, d);
    if (range == NoRange)
    {
      continue;
    }
    ++hits;
    const double za = glm::dot(a, d);
    const double zb = glm::dot(b, d);
    const double zc = glm::dot(c, d);
    EXPECT_GT(range, 0.0);
    EXPECT_LE(range, std::fmax(za, std::fmax(zb, zc)) * (1.0 + 1e-14) + 1e-12);
    EXPECT_GE(range, std::fmin(za, std::fmin(zb, zc)) * (1.0 - 1e-14) - 1e-12);
    // The hit lies on the triangle: its distance from the target is along the sliver's surface as
    // seen by the ray, so for those not seen along their length it is the target.
    const double sine = glm::length(glm::cross(glm::normalize(b - a), d));
    if (sine > 0.1 && range < 200.0)
    {
      EXPECT_NEAR(range, safeLength(target), 1e-9);
    }
  }
  EXPECT_GT(hits, 150000);
}

TEST(TriangleTest, HitsAtGrazingIncidenceLieOnTheirTriangle)
{
  // Triangles about a point of the ray, of all sizes and shapes, at all angles, corners far beyond
  // the hit and behind the apex among them: the guarantee of TriangleTest.h in extended precision.
  Numbers random(95);
  int asPlane = 0;
  for (int i = 0; i < 300000; ++i)
  {
    const Vec3 d = unitDirection(random.direction());
    const Vec3 across = glm::normalize(glm::cross(d, random.direction()));
    const Vec3 other = glm::normalize(glm::cross(d, across) + random.inCube(0.5));
    const Vec3 forward = d + random.logUniform(1e-10, 1.0) * other;
    const Vec3 hit = random.logUniform(1e-3, 1e3) * d;
    Vec3 corner[3];
    for (Vec3& c : corner)
    {
      const double u = random.logUniform(1e-12, 1e3) * (random() < 0.5 ? -1.0 : 1.0);
      const double v = random.logUniform(1e-12, 1e3) * (random() < 0.5 ? -1.0 : 1.0);
      c = hit + u * forward + v * across;
    }
    const Corners t{ corner[0], corner[1], corner[2] };
    const TrianglePlane plane = planeOf(t);
    const PlaneRange found = rangeOnPlane(t, plane, d.x, d.y, d.z);
    if (!rayAccepted(t, d) || found.kind != 1 ||
      std::fabs(glm::dot(plane.normal, d)) >= WellShaped * plane.longestSquared)
    {
      continue;
    }
    ++asPlane;
    const double farthest =
      std::fmax(glm::length(t.a), std::fmax(glm::length(t.b), glm::length(t.c)));
    EXPECT_LE(distanceFrom(t, d, found.range), 32.0 * RoundOffDouble * farthest);
  }
  EXPECT_GT(asPlane, 20000);
}

TEST(TriangleTest, NeedlesAreNotHitBeyondTheirEnds)
{
  // Both long edges pass any ray within rounding of their lines; the end must still end.
  const Corners t{ { 10, -1, 0 }, { 10, 1, 0 }, { 10, 1, 1e-9 } };
  EXPECT_GT(rangeAlong(t, { 10, 0.5, 0.7e-9 }), 0.0);
  EXPECT_EQ(rangeAlong(t, { 10, -1.0 - 1e-9, 0 }), NoRange);
  EXPECT_EQ(rangeAlong(t, { 10, 1.0 + 1e-9, 0.5e-9 }), NoRange);
  const BeamFrame frame = makeBeamFrame(Vec3(0.0), { 10, -1, 0 }, 5.6e-3);
  for (const double beyond : { 1e-5, 1e-3, 0.1 })
  {
    const Vec3 p = frame.toPlane({ 10, -1.0 - beyond * 0.056, 0 });
    const Vec3 d = unitDirection(frame.direction(p.x / p.z, p.y / p.z));
    EXPECT_TRUE(!beamRayAccepted(BeamPlaneMap(frame), t, p.x / p.z, p.y / p.z) ||
      rangeOf(t, planeOf(t), d, beamRayMargin(frame)) == NoRange);
  }
}

TEST(TriangleTest, UnitDirectionsOfAnyLength)
{
  for (const double length : { 1e-300, 1e-30, 1.0, 3.7, 1e30, 1e300 })
  {
    const Vec3 d = unitDirection(length * Vec3(1, -2, 2));
    EXPECT_DOUBLE_EQ(d.x, 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(d.y, -2.0 / 3.0);
    const Vec3 u = unitVector(length * Vec3(1, -2, 2));
    EXPECT_DOUBLE_EQ(u.x, 1.0 / 3.0);
    EXPECT_DOUBLE_EQ(u.y, -2.0 / 3.0);
    EXPECT_DOUBLE_EQ(safeLength(length * Vec3(1, -2, 2)), 3.0 * length);
  }
  Numbers random(96);
  for (int i = 0; i < 1000; ++i)
  {
    const Vec3 v = random.inCube(1.0);
    EXPECT_EQ(unitDirection(v), unitDirection(0x1p20 * v));
    EXPECT_EQ(inversePowerOfTwo(0x1p-5 * 1.75), 0x1p5);
  }
}
