// SPDX-License-Identifier: BSD-3-Clause
// Every split rule x volume x leaf size x way down the tree returns the hits of brute force,
// and all the same bits.
#include "BeamGroup.h"
#include "BeamTracer.h"
#include "CollisionTreeBuilder.h"
#include "TracerTestScenes.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
struct Beam
{
  BeamFrame frame;
  BeamRays rays;
};

/// Beams of all widths, aimed at triangles so that narrow ones hit something.
std::vector<Beam> beamsFor(
  const TriangleMesh& mesh, const Vec3& apex, Numbers& random, int count, int raysPerBeam)
{
  const double widths[] = { 1e-6, 1e-4, 5.6e-3, 0.1, 1.0 };
  std::vector<Beam> beams;
  for (int i = 0; i < count; ++i)
  {
    const auto t = static_cast<std::uint32_t>(random.index(mesh.size()));
    const double u = random();
    const double v = random() * (1.0 - u);
    const Vec3 target = mesh.corner(t, 0) + u * (mesh.corner(t, 1) - mesh.corner(t, 0)) +
      v * (mesh.corner(t, 2) - mesh.corner(t, 0));
    Beam beam;
    beam.frame = makeBeamFrame(apex, target - apex, widths[i % 5]);
    beam.rays = raysInDisc(random, static_cast<std::size_t>(raysPerBeam));
    beam.rays.x[0] = beam.rays.y[0] = 0.0;
    beams.push_back(beam);
  }
  return beams;
}

/// Four units of round-off of the largest of the three terms of an edge function, each way, in a
/// few operations, rad.
constexpr long double EdgeTolerance = 32.0L * 0x1p-53L;

void expectLikeOracle(const TriangleMesh& mesh, const Beam& beam, std::size_t ray, const Hit& hit,
  const OracleHit& oracle)
{
  ASSERT_EQ(hit.valid(), oracle.triangle != NoTriangle) << "ray " << ray;
  if (!hit.valid())
  {
    return;
  }
  const long double tolerance = std::fmax(1e-12L, 32.0L * 0x1p-53L / oracle.cosine) * oracle.range;
  EXPECT_LE(std::fabs(hit.range - oracle.range), tolerance) << "ray " << ray;
  if (hit.triangle != oracle.triangle)
  {
    // Equal ranges: coplanar triangles that overlap.
    const PairResult pair = testPair(mesh, hit.triangle, beam.frame.origin,
      rayDirection(beam.frame, beam.rays.x[ray], beam.rays.y[ray]));
    EXPECT_TRUE(pair.hit) << "ray " << ray << " triangle " << hit.triangle;
    EXPECT_LE(std::fabs(pair.range - oracle.range), tolerance) << "ray " << ray;
  }
}

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
  const auto mesh = std::make_shared<TriangleMesh>(scene.make(random));
  const auto trees = allTrees(mesh);
  std::size_t compared = 0;
  std::size_t hitCount = 0;
  std::size_t skipped = 0;
  for (const Beam& beam : beamsFor(*mesh, scene.apex, random, 60, 40))
  {
    std::vector<Hit> reference;
    for (std::size_t t = 0; t < trees.size(); ++t)
    {
      for (const TraceMode mode : { TraceMode::Automatic, TraceMode::Beams, TraceMode::SingleRays })
      {
        OneBeamTracer tracer(*trees[t]);
        tracer.setBeam(beam.frame);
        std::vector<Hit> hits;
        tracer.trace(beam.rays, mode, hits);
        if (reference.empty())
        {
          reference = hits;
        }
        ASSERT_EQ(hits.size(), reference.size());
        for (std::size_t i = 0; i < hits.size(); ++i)
        {
          ASSERT_TRUE(sameBits(hits[i], reference[i]))
            << "tree " << t << " mode " << static_cast<int>(mode) << " ray " << i << ": "
            << hits[i].triangle << " at " << hits[i].range << " against " << reference[i].triangle
            << " at " << reference[i].range;
        }
      }
    }
    for (std::size_t i = 0; i < reference.size(); ++i)
    {
      const OracleHit oracle = bruteForce(
        *mesh, scene.apex, rayDirection(beam.frame, beam.rays.x[i], beam.rays.y[i]), EdgeTolerance);
      if (reference[i].valid())
      {
        const double again = rangeOnTriangle(
          *trees[0], reference[i].triangle, beam.frame, beam.rays.x[i], beam.rays.y[i]);
        ASSERT_EQ(again, reference[i].range);
        ++hitCount;
      }
      if (oracle.nearEdge)
      {
        ++skipped;
        continue;
      }
      ++compared;
      expectLikeOracle(*mesh, beam, i, reference[i], oracle);
    }
  }
  RecordProperty("compared", static_cast<int>(compared));
  RecordProperty("hits", static_cast<int>(hitCount));
  EXPECT_GT(hitCount, 100u);
  // Rays near edges are rare, also where triangles are slivers or as small as a beam is wide.
  EXPECT_LT(static_cast<double>(skipped), 0.02 * static_cast<double>(skipped + compared))
    << skipped << " of " << skipped + compared;
}

INSTANTIATE_TEST_SUITE_P(BeamTracer, TracerScene, testing::Range(0, 9), sceneName);

TEST(BeamTracer, EqualRangesGoToTheLowerNumber)
{
  Numbers random(5);
  const auto mesh = std::make_shared<TriangleMesh>();
  for (int copy = 0; copy < 7; ++copy)
  {
    addTriangle(*mesh, { -5, -5, 20 }, { 5, -5, 21 }, { 0, 5, 22 });
  }
  for (const auto& tree : allTrees(mesh))
  {
    OneBeamTracer tracer(*tree);
    tracer.setBeam(makeBeamFrame(Vec3(0.0), { 0, 0, 1 }, 0.05));
    const BeamRays rays = raysInDisc(random, 50);
    for (const TraceMode mode : { TraceMode::Automatic, TraceMode::Beams, TraceMode::SingleRays })
    {
      std::vector<Hit> hits;
      tracer.trace(rays, mode, hits);
      for (const Hit& hit : hits)
      {
        EXPECT_EQ(hit.triangle, 0u);
      }
    }
  }
}

TEST(BeamTracer, FinelyMeshedTargetGivesTheSameBitsAndChangesStrategy)
{
  // 32,768 triangles, thousands of them in one beam.
  Numbers random(6);
  const auto mesh = std::make_shared<TriangleMesh>(
    closedSurface(6, [&](const Vec3&) { return random(9.99, 10.01); }));
  const auto tree = buildCollisionTree(mesh, TreeOptions());
  OneBeamTracer tracer(*tree);
  tracer.setBeam(makeBeamFrame(Vec3(0.0), { 1, 2, 3 }, 0.5));
  const BeamRays rays = raysInDisc(random, 200);
  std::vector<Hit> together;
  std::vector<Hit> singly;
  tracer.trace(rays, TraceMode::Automatic, together);
  const std::uint64_t candidates = tracer.counters().candidates;
  EntryPoints entryPoints;
  TraversalStack stack;
  const std::size_t potential = findPotential(
    *tree, makeBeamFrame(Vec3(0.0), { 1, 2, 3 }, 0.5), mesh->size(), entryPoints, stack)
                                  .count;
  EXPECT_LT(candidates, potential * 3 / 4);
  tracer.trace(rays, TraceMode::SingleRays, singly);
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    ASSERT_TRUE(sameBits(together[i], singly[i]));
    ASSERT_TRUE(together[i].valid());
  }
}

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

TEST(BeamTracer, CountersStartAgainWithEachBeam)
{
  Numbers random(12);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 300, 50.0, 20.0));
  const auto tree = buildCollisionTree(mesh, TreeOptions());
  OneBeamTracer tracer(*tree);
  std::vector<Hit> hits;
  for (int beam = 0; beam < 3; ++beam)
  {
    tracer.setBeam(makeBeamFrame(Vec3(0.0), mesh->points[7], 0.05));
    EXPECT_EQ(tracer.counters().raysTraced, 0u);
    tracer.trace(raysInDisc(random, 10), TraceMode::Automatic, hits);
    EXPECT_EQ(tracer.counters().raysTraced, 10u);
    EXPECT_GT(tracer.counters().nodesVisited, 0u);
    EXPECT_GT(tracer.counters().candidates, 0u);
    tracer.traceFromApex({ 1, 1, 1 });
    EXPECT_EQ(tracer.counters().raysTraced, 11u);
  }
}

TEST(BeamTracer, MovedToUtmAndEcefRangesAgreeToAMicrometre)
{
  const Vec3 places[] = { { 500000.25, 3450000.5, 12.0 }, { -2853445.34, 4667464.94, 3268291.03 },
    { 1e8, -1e8, 1e8 } };
  const double tolerances[] = { 1e-6, 1e-6, 1e-4 };
  for (int place = 0; place < 3; ++place)
  {
    Numbers random(13);
    const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 300, 400.0, 60.0));
    const auto moved = std::make_shared<TriangleMesh>(*mesh);
    for (Vec3& p : moved->points)
    {
      p += places[place];
    }
    const auto tree = buildCollisionTree(mesh, TreeOptions());
    const auto movedTree = buildCollisionTree(moved, TreeOptions());
    OneBeamTracer here(*tree);
    OneBeamTracer there(*movedTree);
    int compared = 0;
    for (int beam = 0; beam < 100; ++beam)
    {
      const Vec3 axis = random.direction();
      here.setBeam(makeBeamFrame(Vec3(0.0), axis, 0.05));
      there.setBeam(makeBeamFrame(places[place], axis, 0.05));
      const BeamRays rays = raysInDisc(random, 30);
      std::vector<Hit> hits;
      std::vector<Hit> movedHits;
      here.trace(rays, TraceMode::Automatic, hits);
      there.trace(rays, TraceMode::Automatic, movedHits);
      for (std::size_t i = 0; i < rays.size(); ++i)
      {
        const BeamFrame frame = makeBeamFrame(Vec3(0.0), axis, 0.05);
        const OracleHit oracle =
          bruteForce(*mesh, Vec3(0.0), rayDirection(frame, rays.x[i], rays.y[i]), 1e-7L);
        if (oracle.nearEdge || oracle.cosine < 1e-3L)
        {
          continue;
        }
        ASSERT_EQ(hits[i].triangle, movedHits[i].triangle);
        if (hits[i].valid())
        {
          EXPECT_NEAR(hits[i].range, movedHits[i].range, tolerances[place]);
          ++compared;
        }
      }
    }
    EXPECT_GT(compared, 500);
  }
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
