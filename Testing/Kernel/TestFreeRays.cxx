// SPDX-License-Identifier: BSD-3-Clause
// Rays from anywhere, the set of triangles that a cone may meet, and rays from the apex that are
// not a beam's own.
#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

using namespace avianlidar;
using namespace geometrytest;

TEST(BeamTracer, ConeTrianglesHoldEveryTriangleThatARayOfTheConeHits)
{
  Numbers random(7);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 400, 50.0, 10.0));
  for (const auto& tree : allTrees(mesh))
  {
    BeamTracer tracer(*tree, Precision::Double);
    const BeamFrame frame = makeBeamFrame({ 1, 2, 3 }, random.direction(), 0.2);
    tracer.setBeam(frame);
    std::vector<bool> inSet(mesh->size(), false);
    for (const std::uint32_t t : tracer.coneTriangles())
    {
      EXPECT_FALSE(inSet[t]);
      inSet[t] = true;
    }
    const BeamRays rays = raysInDisc(random, 20);
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      for (std::uint32_t t = 0; t < mesh->size(); ++t)
      {
        if (testPair(*mesh, t, frame.origin, rayDirection(frame, rays.x[i], rays.y[i])).hit)
        {
          EXPECT_TRUE(inSet[t]);
        }
      }
    }
  }
}

TEST(BeamTracer, FreeRaysEqualBruteForce)
{
  Numbers random(8);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 300, 50.0, 15.0));
  const Vec3 apex(400.0, -300.0, 200.0);
  for (Vec3& p : mesh->points)
  {
    p += apex;
  }
  for (const auto& tree : allTrees(mesh))
  {
    BeamTracer tracer(*tree, Precision::Single);
    tracer.setBeam(makeBeamFrame(apex, random.direction(), 0.1));
    for (int i = 0; i < 60; ++i)
    {
      const Vec3 origin = random.inCube(40.0);
      const Vec3 direction = random.logUniform(1e-3, 1e3) * random.direction();
      const OracleHit oracle = bruteForce(*mesh, apex + origin, unit(wide(direction)), 1e-11L);
      if (oracle.nearEdge)
      {
        continue;
      }
      const Hit hit = tracer.traceFrom(origin, direction, 0.0, NoTriangle, false);
      ASSERT_EQ(hit.triangle, oracle.triangle);
      if (!hit.valid())
      {
        continue;
      }
      EXPECT_NEAR(hit.range, static_cast<double>(oracle.range), 1e-10 * (1.0 + hit.range));
      // The same one ignored, or too near: something farther, or nothing.
      const Hit behind = tracer.traceFrom(origin, direction, 0.0, hit.triangle, false);
      EXPECT_NE(behind.triangle, hit.triangle);
      EXPECT_GE(behind.range, hit.range);
      const Hit later =
        tracer.traceFrom(origin, direction, 1.000001 * hit.range, NoTriangle, false);
      EXPECT_EQ(later.triangle, behind.triangle);
      const Vec3 d = direction / safeLength(direction);
      const Vec3 beyond = origin + 1.01 * hit.range * d;
      const Vec3 before = origin + 0.99 * hit.range * d;
      EXPECT_TRUE(tracer.occluded(origin, beyond, 0.0, NoTriangle, NoTriangle, false));
      EXPECT_FALSE(tracer.occluded(origin, before, 0.0, NoTriangle, NoTriangle, false));
      EXPECT_FALSE(
        tracer.occluded(origin, beyond, 0.02 * hit.range, NoTriangle, NoTriangle, false) &&
        behind.range > 1.01 * hit.range);
      if (behind.range > 1.02 * hit.range)
      {
        EXPECT_FALSE(tracer.occluded(origin, beyond, 0.0, hit.triangle, NoTriangle, false));
        EXPECT_FALSE(tracer.occluded(origin, beyond, 0.0, NoTriangle, hit.triangle, false));
      }
    }
  }
}

TEST(BeamTracer, InsideTheConeTheConesTrianglesAreEnough)
{
  Numbers random(9);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 600, 60.0, 6.0));
  for (const auto& tree : allTrees(mesh))
  {
    BeamTracer tracer(*tree, Precision::Single);
    const BeamFrame frame =
      makeBeamFrame(Vec3(0.0), random.direction(), random.logUniform(0.01, 0.5));
    tracer.setBeam(frame);
    const auto pointInCone = [&]()
    {
      const auto [x, y] = random.inDisc();
      return random(5.0, 60.0) * frame.direction(0.99 * x, 0.99 * y);
    };
    for (int i = 0; i < 200; ++i)
    {
      const Vec3 from = pointInCone();
      const Vec3 to = pointInCone();
      EXPECT_EQ(tracer.occluded(from, to, 1e-6, NoTriangle, NoTriangle, true),
        tracer.occluded(from, to, 1e-6, NoTriangle, NoTriangle, false));
      const Hit all = tracer.traceFrom(from, to - from, 0.0, NoTriangle, false);
      const Hit cone = tracer.traceFrom(from, to - from, 0.0, NoTriangle, true);
      const Vec3 end = from + all.range * glm::normalize(to - from);
      if (all.valid() && frame.contains(end))
      {
        EXPECT_TRUE(sameBits(all, cone));
      }
      else if (cone.valid())
      {
        EXPECT_GE(cone.range, all.range);
      }
      const Hit axial = tracer.traceFromApex(to, true);
      EXPECT_TRUE(sameBits(axial, tracer.traceFromApex(to, false)));
    }
  }
}

TEST(BeamTracer, TraceFromApexHasTheRangesOfTrace)
{
  Numbers random(10);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 300, 50.0, 20.0));
  const auto tree = buildCollisionTree(mesh, TreeOptions());
  BeamTracer tracer(*tree, Precision::Double);
  const BeamFrame frame = makeBeamFrame({ 0.5, 0.25, 0.125 }, random.direction(), 0.5);
  tracer.setBeam(frame);
  const BeamRays rays = raysInDisc(random, 1000);
  std::vector<Hit> hits;
  tracer.trace(rays, TraceMode::Automatic, hits);
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    EXPECT_TRUE(
      sameBits(hits[i], tracer.traceFromApex(frame.direction(rays.x[i], rays.y[i]), true)));
  }
}
