// SPDX-License-Identifier: BSD-3-Clause
// Every split rule x volume x leaf size x way down the tree returns the hits of brute force,
// and all the same bits; so do rays from anywhere.
#include "BeamGroup.h"
#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "HitComparison.h"
#include "TracerTestScenes.h"

#include <gtest/gtest.h>

#include <string>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
class TracerScene : public testing::TestWithParam<int>
{
};

std::string sceneName(const testing::TestParamInfo<int>& info)
{
  std::string name = tracerScenes()[info.param].name;
  for (char& c : name)
  {
    c = c == ' ' ? '_' : c;
  }
  return name;
}
}

TEST_P(TracerScene, EqualsBruteForce)
{
  const int number = GetParam();
  const MadeScene scene = tracerScenes()[number];
  Numbers random(1000 + number);
  const Trees trees = allTrees(std::make_shared<TriangleMesh>(scene.make(random)));
  HitComparison sum;
  compareBeams(trees, scene.apex, random, 60, 40, sum);
  EXPECT_EQ(sum.wrong, 0u);
  EXPECT_EQ(sum.otherBits, std::vector<std::size_t>(trees.size(), 0));
  EXPECT_LE(sum.rangeError, 16.0);
  EXPECT_GT(sum.hits, 100u);
  // Rays near edges are rare, also where triangles are slivers or as small as a beam is wide.
  EXPECT_LT(
    static_cast<double>(sum.undecided), 0.02 * static_cast<double>(sum.undecided + sum.compared));
}

INSTANTIATE_TEST_SUITE_P(BeamTracer, TracerScene, testing::Range(0, 11), sceneName);

TEST(BeamTracer, EmptyTreeAndNoRays)
{
  const auto tree = buildCollisionTree(std::make_shared<TriangleMesh>(), TreeOptions());
  OneBeamTracer tracer(*tree);
  tracer.setBeam(makeBeamFrame(Vec3(0.0), { 0, 0, 1 }, 0.1));
  Numbers random(11);
  std::vector<Hit> hits;
  for (const TraceMode mode : { TraceMode::Automatic, TraceMode::Beams, TraceMode::SingleRays })
  {
    tracer.trace(raysInDisc(random, 10), mode, hits);
    ASSERT_EQ(hits.size(), 10u);
    EXPECT_FALSE(hits[3].valid());
    tracer.trace(BeamRays(), mode, hits);
    EXPECT_TRUE(hits.empty());
  }
  EXPECT_FALSE(tracer.traceFromApex({ 0, 0, 1 }).valid());
  EXPECT_FALSE(tracer.occluded({ 0, 0, 1 }, { 0, 0, 9 }, 0.0, NoTriangle, NoTriangle));
}

TEST(BeamTracer, SeenTrianglesFaceTheApex)
{
  CollisionTree tree;
  const auto made = std::make_shared<TriangleMesh>();
  TriangleMesh& mesh = *made;
  tree.mesh = made;
  addTriangle(mesh, { 0, 0, 10 }, { 2, 0, 10 }, { 0, 2, 10 });
  addTriangle(mesh, { 0, 0, 10 }, { 0, 2, 10 }, { 2, 0, 10 });
  addTriangle(mesh, { 0, 0, 10 }, { 1, 0, 10 }, { 2, 0, 10 });
  const SeenTriangle up = seeTriangle(SceneTriangles(tree), 0, { 0, 0, 4 });
  EXPECT_EQ(up.corners.a, Vec3(0, 0, 6));
  EXPECT_EQ(up.corners.b, Vec3(2, 0, 6));
  EXPECT_EQ(up.normal, Vec3(0, 0, -1));
  EXPECT_EQ(seeTriangle(SceneTriangles(tree), 1, { 0, 0, 4 }).normal, Vec3(0, 0, -1));
  EXPECT_EQ(seeTriangle(SceneTriangles(tree), 1, { 0, 0, 14 }).normal, Vec3(0, 0, 1));
  EXPECT_EQ(seeTriangle(SceneTriangles(tree), 2, { 0, 0, 4 }).normal, Vec3(0, 0, 0));
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

TEST(BeamTracer, TiesAtTheVertexOfAFanGoToTheLowestNumber)
{
  // A ray just outside a triangle, within the tolerance of its edge, has the range of its corner,
  // not that of the plane where the ray passes: far off where the plane is seen at grazing
  // incidence. All triangles of the fan tie.
  Numbers random(5);
  std::size_t different = 0;
  for (int round = 0; round < 6000; ++round)
  {
    const double width = std::vector<double>{ Pi / 3.0, 0.7, 0.3, 0.1, 0.02 }[round % 5];
    const Vec3 vertex(random(-1.0, 1.0), random(-1.0, 1.0), 1.0);
    const Vec3 aside = width * Vec3(random(-0.5, 0.5), random(-0.5, 0.5), 0.0);
    const BeamFrame frame = makeBeamFrame(Vec3(0.0), vertex + aside, width);
    const double depth = glm::dot(vertex, frame.axis);
    const double x = glm::dot(vertex, frame.e1) / depth / frame.tanHalf;
    const double y = glm::dot(vertex, frame.e2) / depth / frame.tanHalf;
    if (x * x + y * y > 0.9)
    {
      continue;
    }
    // A plane through the vertex that leans towards the line of sight.
    const double lean = random.logUniform(1e-3, 1.0);
    const BeamFrame sight = makeBeamFrame(Vec3(0.0), vertex, 0.1);
    const Vec3 along = sight.axis + lean * sight.e2;
    auto mesh = std::make_shared<TriangleMesh>();
    mesh->points.push_back(vertex);
    const double length = (random() < 0.5 ? -1.0 : 1.0) * random.logUniform(1e-3, 10.0);
    const double opening = random(0.02, 0.5);
    const double first = random(-0.5, 0.5);
    const std::uint32_t blades = 9 + static_cast<std::uint32_t>(random() * 12.0);
    for (std::uint32_t i = 0; i <= blades; ++i)
    {
      const double angle = first + opening * i;
      mesh->points.push_back(
        vertex + length * (std::cos(angle) * along + lean * std::sin(angle) * sight.e1));
    }
    for (std::uint32_t i = 0; i < blades; ++i)
    {
      mesh->triangles.push_back({ 0u, 1u + i, 2u + i });
    }
    std::swap(mesh->triangles.front(), mesh->triangles[random() < 0.5 ? 0 : blades - 1]);
    BeamRays rays;
    rays.resize(64);
    const double near = random.logUniform(1e-8, 3e-6);
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      rays.x[i] = x + near * random(-1.0, 1.0);
      rays.y[i] = y + near * random(-1.0, 1.0);
    }
    const auto tree = buildCollisionTree(mesh, TreeOptions{});
    OneBeamTracer tracer(*tree);
    tracer.setBeam(frame);
    std::vector<Hit> together;
    std::vector<Hit> singly;
    tracer.trace(rays, TraceMode::Automatic, together);
    tracer.trace(rays, TraceMode::SingleRays, singly);
    for (std::size_t i = 0; i < rays.size(); ++i)
    {
      different += sameBits(together[i], singly[i]) ? 0 : 1;
    }
  }
  EXPECT_EQ(different, 0u);
}
