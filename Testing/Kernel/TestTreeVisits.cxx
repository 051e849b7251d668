// SPDX-License-Identifier: BSD-3-Clause
// Visits of nodes are those of the search for hits where it tests nodes beam by beam, lead to all
// that is hit in every tree, and are the same for threads, orders of the beams and levels.
#include "TreeVisits.h"

#include "BeamTracer.h"
#include "TracerTestScenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

using namespace avianlidar;
using namespace geometrytest;

namespace
{
constexpr std::uint32_t AllLevels = 1000;

/// Beams of one width from one place, aimed at triangles and past them.
ScanBeams beamsFor(const TriangleMesh& mesh, const Vec3& apex, Numbers& random, std::size_t count)
{
  ScanBeams beams;
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto t = static_cast<std::uint32_t>(random.index(mesh.size()));
    beams.ids.push_back(i);
    beams.origins.push_back(apex);
    beams.directions.push_back(
      i % 4 == 0 ? random.direction() : unitDirection(mesh.corner(t, 1) - apex));
  }
  return beams;
}

ScanBeams oneOf(const ScanBeams& beams, std::size_t i)
{
  ScanBeams one;
  one.ids = { beams.ids[i] };
  one.origins = { beams.origins[i] };
  one.directions = { beams.directions[i] };
  return one;
}

TreeVisits visitsOf(const CollisionTree& tree, const ScanBeams& beams, double halfBeamwidth,
  std::uint32_t level = AllLevels, int threads = 1)
{
  TreeVisits visits;
  EXPECT_TRUE(countVisits(tree, beams, halfBeamwidth, level, threads, {}, visits));
  return visits;
}

std::int64_t sum(const std::vector<std::int64_t>& values)
{
  return std::accumulate(values.begin(), values.end(), std::int64_t{ 0 });
}

std::int64_t leavesMet(const CollisionTree& tree, const TreeVisits& visits)
{
  std::int64_t leaves = 0;
  for (std::size_t n = 0; n < tree.nodes.size(); ++n)
  {
    leaves += tree.nodes[n].isLeaf() ? visits.met[n] : 0;
  }
  return leaves;
}

/// Leaf of every triangle, and parent of every node.
struct Ways
{
  std::vector<std::uint32_t> leafOf, parentOf;
  explicit Ways(const CollisionTree& tree)
    : leafOf(tree.order.size())
    , parentOf(tree.nodes.size(), 0)
  {
    for (std::uint32_t n = 0; n < tree.nodes.size(); ++n)
    {
      const TreeNode& node = tree.nodes[n];
      for (std::uint32_t i = 0; i < node.count; ++i)
      {
        this->leafOf[tree.order[node.first + i]] = n;
      }
      if (!node.isLeaf())
      {
        this->parentOf[node.first] = this->parentOf[node.first + 1] = n;
      }
    }
  }
};

/// Children are tested by the beams that meet their parent, and by no others.
void expectOneDescent(const CollisionTree& tree, const TreeVisits& visits, std::size_t beams)
{
  ASSERT_EQ(visits.tested.size(), tree.nodes.size());
  EXPECT_EQ(visits.tested[0], static_cast<std::int64_t>(beams));
  for (std::size_t n = 0; n < tree.nodes.size(); ++n)
  {
    ASSERT_LE(visits.met[n], visits.tested[n]);
    if (!tree.nodes[n].isLeaf())
    {
      ASSERT_EQ(visits.tested[tree.nodes[n].first], visits.met[n]);
      ASSERT_EQ(visits.tested[tree.nodes[n].first + 1], visits.met[n]);
    }
  }
}

/// One beam against the tracer: what it counts, and where its hits are.
void expectSearched(const CollisionTree& tree, const Ways& ways, const ScanBeams& beam,
  double halfBeamwidth, const BeamRays& rays, std::size_t& hitCount)
{
  const TreeVisits visits = visitsOf(tree, beam, halfBeamwidth);
  BeamTracer tracer(tree, Precision::Single);
  tracer.setBeam(makeBeamFrame(beam.origins[0], beam.directions[0], halfBeamwidth));
  std::vector<Hit> hits;
  tracer.trace(rays, TraceMode::Automatic, hits);
  if (tree.wide.nodes.empty())
  {
    // Each packet of its rays goes through the list of leaves, eight at a time.
    const auto packets = static_cast<std::int64_t>((rays.size() + 63) / 64);
    const std::int64_t leaves = (leavesMet(tree, visits) + 7) / 8;
    const std::int64_t nodes = sum(visits.tested) + packets * 8 * leaves;
    ASSERT_EQ(static_cast<std::uint64_t>(nodes), tracer.counters().nodesVisited);
  }
  for (const Hit& hit : hits)
  {
    if (!hit.valid())
    {
      continue;
    }
    ++hitCount;
    for (std::uint32_t n = ways.leafOf[hit.triangle];; n = ways.parentOf[n])
    {
      ASSERT_EQ(visits.met[n], 1);
      if (n == 0)
      {
        break;
      }
    }
  }
}
}

TEST(TreeVisits, AreThoseOfTheSearch)
{
  const double widths[] = { 1e-4, 5.6e-3, 0.05 }; // wider ones are traced ray by ray
  std::size_t hitCount = 0;
  std::size_t unfolded = 0;
  int number = 0;
  for (const MadeScene& scene : tracerScenes())
  {
    SCOPED_TRACE(scene.name);
    Numbers random(70 + number);
    const auto mesh = std::make_shared<TriangleMesh>(scene.make(random));
    const ScanBeams beams = beamsFor(*mesh, scene.apex, random, 24);
    const double width = widths[number++ % 3];
    // Too many for two beams to share a packet, and more than one packet.
    const BeamRays rays = raysInDisc(random, number % 2 ? 40 : 100);
    for (const auto& tree : allTrees(mesh))
    {
      const Ways ways(*tree);
      unfolded += tree->wide.nodes.empty();
      TreeVisits added;
      added.tested.assign(tree->nodes.size(), 0);
      added.met.assign(tree->nodes.size(), 0);
      for (std::size_t i = 0; i < beams.size(); ++i)
      {
        const ScanBeams one = oneOf(beams, i);
        expectSearched(*tree, ways, one, width, rays, hitCount);
        const TreeVisits visits = visitsOf(*tree, one, width);
        for (std::size_t n = 0; n < tree->nodes.size(); ++n)
        {
          added.tested[n] += visits.tested[n];
          added.met[n] += visits.met[n];
        }
      }
      const TreeVisits all = visitsOf(*tree, beams, width);
      expectOneDescent(*tree, all, beams.size());
      EXPECT_EQ(all.tested, added.tested);
      EXPECT_EQ(all.met, added.met);
    }
  }
  EXPECT_GT(hitCount, 10000u);
  EXPECT_GT(unfolded, 50u);
}

TEST(TreeVisits, DoNotDependOnThreadsOrderOrLevel)
{
  Numbers random(5);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 2000, 200.0, 20.0));
  ScanBeams beams = beamsFor(*mesh, Vec3(0.0), random, 700);
  for (const auto& tree : allTrees(mesh))
  {
    const TreeVisits all = visitsOf(*tree, beams, 0.01);
    std::reverse(beams.directions.begin(), beams.directions.end());
    for (const int threads : { 2, 3, 8 })
    {
      const TreeVisits same = visitsOf(*tree, beams, 0.01, AllLevels, threads);
      EXPECT_EQ(same.tested, all.tested);
      EXPECT_EQ(same.met, all.met);
    }
    const std::vector<std::uint32_t> depths = tree->depths();
    for (const std::uint32_t level : { 0u, 1u, 4u, depths.back(), depths.back() + 1 })
    {
      const TreeVisits upper = visitsOf(*tree, beams, 0.01, level, 2);
      const std::size_t count = nodesToLevel(*tree, level);
      EXPECT_EQ(static_cast<std::ptrdiff_t>(count),
        std::count_if(depths.begin(), depths.end(), [&](auto depth) { return depth <= level; }));
      ASSERT_EQ(upper.tested.size(), count);
      EXPECT_TRUE(std::equal(upper.tested.begin(), upper.tested.end(), all.tested.begin()));
      EXPECT_TRUE(std::equal(upper.met.begin(), upper.met.end(), all.met.begin()));
    }
  }
}

TEST(TreeVisits, OfNothingAreNone)
{
  const auto empty = std::make_shared<TriangleMesh>();
  Numbers random(6);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 50, 20.0, 5.0));
  const ScanBeams beams = beamsFor(*mesh, Vec3(0.0), random, 5);
  for (const auto& tree : allTrees(empty))
  {
    EXPECT_TRUE(visitsOf(*tree, beams, 0.01).tested.empty());
  }
  for (const auto& tree : allTrees(mesh))
  {
    const TreeVisits none = visitsOf(*tree, ScanBeams(), 0.01);
    EXPECT_EQ(none.tested.size(), tree->nodes.size());
    EXPECT_EQ(sum(none.tested), 0);
  }
}

TEST(TreeVisits, Stop)
{
  Numbers random(7);
  const auto mesh = std::make_shared<TriangleMesh>(randomTriangles(random, 50, 20.0, 5.0));
  const ScanBeams beams = beamsFor(*mesh, Vec3(0.0), random, 5);
  TreeVisits visits;
  EXPECT_FALSE(countVisits(
    *allTrees(mesh).front(), beams, 0.01, AllLevels, 1, [](double) { return false; }, visits));
}
