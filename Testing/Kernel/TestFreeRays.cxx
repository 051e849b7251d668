// SPDX-License-Identifier: BSD-3-Clause
// Rays from anywhere, and rays from the apex that are not a beam's own.
#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"

#include <gtest/gtest.h>

using namespace avianlidar;
using namespace geometrytest;

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
    OneBeamTracer tracer(*tree);
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
      const Hit hit = tracer.traceFrom(origin, direction, 0.0, NoTriangle);
      ASSERT_EQ(hit.triangle, oracle.triangle);
      if (!hit.valid())
      {
        continue;
      }
      EXPECT_NEAR(hit.range, static_cast<double>(oracle.range), 1e-10 * (1.0 + hit.range));
      // The same one ignored, or too near: something farther, or nothing.
      const Hit behind = tracer.traceFrom(origin, direction, 0.0, hit.triangle);
      EXPECT_NE(behind.triangle, hit.triangle);
      EXPECT_GE(behind.range, hit.range);
      const Hit later = tracer.traceFrom(origin, direction, 1.000001 * hit.range, NoTriangle);
      EXPECT_EQ(later.triangle, behind.triangle);
      const Vec3 d = direction / safeLength(direction);
      const Vec3 beyond = origin + 1.01 * hit.range * d;
      const Vec3 before = origin + 0.99 * hit.range * d;
      EXPECT_TRUE(tracer.occluded(origin, beyond, 0.0, NoTriangle, NoTriangle));
      EXPECT_FALSE(tracer.occluded(origin, before, 0.0, NoTriangle, NoTriangle));
      EXPECT_FALSE(tracer.occluded(origin, beyond, 0.02 * hit.range, NoTriangle, NoTriangle) &&
        behind.range > 1.01 * hit.range);
      if (behind.range > 1.02 * hit.range)
      {
        EXPECT_FALSE(tracer.occluded(origin, beyond, 0.0, hit.triangle, NoTriangle));
        EXPECT_FALSE(tracer.occluded(origin, beyond, 0.0, NoTriangle, hit.triangle));
      }
    }
  }
}

TEST(BeamTracer, TraceFromApexHasTheRangesOfTrace)
{
  Numbers random(10);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 300, 50.0, 20.0));
  const auto tree = buildCollisionTree(mesh, TreeOptions());
  OneBeamTracer tracer(*tree);
  const BeamFrame frame = makeBeamFrame({ 0.5, 0.25, 0.125 }, random.direction(), 0.5);
  tracer.setBeam(frame);
  const BeamRays rays = raysInDisc(random, 1000);
  std::vector<Hit> hits;
  tracer.trace(rays, TraceMode::Automatic, hits);
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    EXPECT_TRUE(sameBits(hits[i], tracer.traceFromApex(frame.direction(rays.x[i], rays.y[i]))));
  }
}
