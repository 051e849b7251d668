// SPDX-License-Identifier: BSD-3-Clause
// Whatever a descent for one path finds stands in the list of what paths of its kind may meet, for
// every tree; and where nothing stands, the list is empty.
#include "EchoTestScene.h"

#include "OneBeamTracer.h"
#include "PathSpace.h"
#include "RaySamples.h"
#include "SecondaryTrace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace echotest;

namespace
{
/// One beam with its hits, and a connection between every pair of them that look at each other.
struct Lit
{
  Scene scene;
  std::shared_ptr<const CollisionTree> tree;
  BeamFrame frame;
  BeamSamples hits;
  SampleGeometry geometry;
  SecondaryConnections connections;

  Lit(const Scene& given, const Vec3& direction, double halfBeamwidth, const TreeOptions& options,
    std::uint64_t beam)
    : scene(given)
    , tree(buildCollisionTree(scene.mesh, options))
    , frame(makeBeamFrame(Vec3(0.0), direction, halfBeamwidth))
  {
    constexpr std::size_t count = 60;
    const StrataPartition strata(count);
    BeamRays rays;
    sampleBeam(0, beam, count, halfBeamwidth, BeamProfile::Uniform, Sampling::Stratified, &strata,
      RandomPurpose::Rays, rays);
    OneBeamTracer tracer(*this->tree);
    tracer.setBeam(this->frame);
    std::vector<Hit> found;
    tracer.trace(rays, TraceMode::Automatic, found);
    std::vector<std::uint32_t> triangles;
    for (const Hit& hit : found)
    {
      triangles.push_back(hit.triangle);
    }
    RaySamples().find(*this->scene.mesh, this->frame, rays, triangles, this->hits, this->geometry);
    for (std::size_t i = 0; i < this->hits.size(); ++i)
    {
      EXPECT_EQ(this->hits.range[i], found[this->hits.ray[i]].range);
    }
    for (std::uint32_t a = 0; a < this->hits.size(); ++a)
    {
      for (std::uint32_t b = 0; b < this->hits.size(); ++b)
      {
        const Vec3 step = this->point(b) - this->point(a);
        if (glm::dot(this->geometry.normal(a), step) > 1e-6 &&
          glm::dot(this->geometry.normal(b), step) < -1e-6)
        {
          this->connections.add(a, b, 0, 1.0);
        }
      }
    }
    this->connections.measure(this->hits, this->geometry);
  }

  Vec3 point(std::uint32_t hit) const
  {
    return this->hits.range[hit] * this->geometry.direction(hit);
  }
};

bool holds(const PathSpace::Candidates* candidates, std::uint32_t triangle)
{
  return !candidates || std::count(candidates->begin(), candidates->end(), triangle) > 0;
}

struct Tally
{
  int empty = 0;
  int listed = 0;
  int met = 0;
};

/// Every mirror path and every connection of the beam, followed by the tracer.
void check(const Lit& lit, Tally& mirrors, Tally& connections)
{
  OneBeamTracer tracer(*lit.tree);
  tracer.setBeam(lit.frame);
  const auto count = [](const PathSpace::Candidates* candidates, const Hit& met, Tally& tally)
  {
    tally.empty += candidates && candidates->empty();
    tally.listed += candidates && !candidates->empty();
    tally.met += met.valid();
    return !met.valid() || holds(candidates, met.triangle);
  };
  PathSpace space;
  space.lookBefore(*lit.tree, lit.frame, lit.hits, lit.geometry);
  for (std::uint32_t i = 0; i < lit.hits.size(); ++i)
  {
    const Vec3 direction = mirrorDirection(lit.geometry.direction(i), lit.geometry.normal(i));
    const double reach = distanceInCone(lit.frame, lit.point(i), lit.hits.range[i], direction);
    const Hit met = tracer.traceFrom(
      lit.point(i), direction, surfaceMargin(lit.hits.range[i]), lit.geometry.triangle(i), reach);
    ASSERT_TRUE(count(space.ofMirror(i), met, mirrors)) << i;
    ASSERT_TRUE(!space.isKnownFree(i) || !met.valid()) << i;
  }
  space.lookBetween(*lit.tree, lit.frame, lit.hits, lit.geometry, lit.connections);
  for (std::size_t i = 0; i < lit.connections.size(); ++i)
  {
    const std::uint32_t one = lit.connections.one[i];
    const std::uint32_t two = lit.connections.two[i];
    const double margin = surfaceMargin(std::max(lit.hits.range[one], lit.hits.range[two]));
    Hit met = tracer.traceFrom(lit.point(one), lit.point(two) - lit.point(one), margin,
      lit.geometry.triangle(one), lit.connections.length[i] - margin);
    if (met.triangle == lit.geometry.triangle(two))
    {
      met = Hit();
    }
    ASSERT_TRUE(count(space.ofConnection(i), met, connections)) << i;
  }
}

/// Large triangles about a corner of two walls on the ground, some pillars before it.
Scene yard(unsigned seed)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, -2.0), Vec3(100.0, 0.0, 0.0), Vec3(0.0, 100.0, 0.0), Wall);
  scene.plate(Vec3(105.0, -5.0, 3.0), Vec3(5.0, 5.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall);
  scene.plate(Vec3(105.0, 5.0, 3.0), Vec3(5.0, -5.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall);
  for (unsigned i = 0; i < seed % 5; ++i)
  {
    scene.box(
      Vec3(97.0 + 8.0 * uniform(random), 3.0 * uniform(random), 0.0), Vec3(0.2, 0.2, 2.0), Wall, 1);
  }
  return scene;
}
}

TEST(PathSpace, ListsHoldWhatPathsMeet)
{
  const double widths[] = { 1e-3, 0.01, 0.03 };
  Tally mirrors;
  Tally connections;
  for (unsigned seed = 0; seed < 60; ++seed)
  {
    for (BoundingVolumeType volume :
      { BoundingVolumeType::AABB, BoundingVolumeType::OBB, BoundingVolumeType::Sphere })
    {
      const TreeOptions options{ SplitRule::SurfaceAreaHeuristic, volume, 2 };
      const Vec3 direction(100.0, 0.05 * (seed % 9) - 0.2, 0.06 * (seed % 7) - 0.2);
      const Lit lit(yard(seed), direction, widths[seed % 3], options, seed);
      check(lit, mirrors, connections);
    }
  }
  EXPECT_GT(mirrors.met, 1000);
  EXPECT_GT(mirrors.empty, 500);
  EXPECT_GT(mirrors.listed, 1000);
  EXPECT_GT(connections.met, 1000);
  EXPECT_GT(connections.empty, 1000);
  EXPECT_GT(connections.listed, 1000);
}

TEST(PathSpace, NothingStandsBeforeAFacade)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(0.5, 10.0, 0.0), Vec3(0.0, 0.0, 10.0), Wall);
  scene.box(Vec3(50.0, 20.0, 0.0), Vec3(5.0), Wall, 1); // beside the beam
  scene.box(Vec3(150.0, 0.0, 0.0), Vec3(5.0), Wall, 2); // behind
  const Lit lit(scene, Vec3(1.0, 0.001, 0.0), 5.6e-3, TreeOptions{}, 0);
  PathSpace space;
  space.lookBefore(*lit.tree, lit.frame, lit.hits, lit.geometry);
  for (std::size_t i = 0; i < lit.hits.size(); ++i)
  {
    EXPECT_TRUE(space.isKnownFree(i));
    ASSERT_TRUE(space.ofMirror(i));
    EXPECT_TRUE(space.ofMirror(i)->empty());
  }
}

TEST(PathSpace, WhatLiesLowBeforeASurfaceIsListed)
{
  // A kerb of 0.3 m on the ground, before a wall.
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, -2.0), Vec3(100.0, 0.0, 0.0), Vec3(0.0, 100.0, 0.0), Wall);
  scene.plate(Vec3(103.0, 0.0, -1.85), Vec3(0.0, 5.0, 0.0), Vec3(0.0, 0.0, 0.15), Wall);
  scene.plate(Vec3(106.0, 0.0, 3.0), Vec3(0.0, 20.0, 0.0), Vec3(0.0, 0.0, 5.0), Wall);
  const Lit lit(scene, Vec3(103.0, 0.3, -1.7), 0.01, TreeOptions{}, 0);
  Tally mirrors;
  Tally connections;
  check(lit, mirrors, connections);
  EXPECT_GT(mirrors.met, 5);
  EXPECT_GT(connections.met, 20);
  // Seen from the ground the kerb is in the way of both.
  const auto isKerb = [](const PathSpace::Candidates* s)
  { return s && (holds(s, 2) || holds(s, 3)); };
  PathSpace space;
  space.lookBefore(*lit.tree, lit.frame, lit.hits, lit.geometry);
  int listed = 0;
  for (std::uint32_t i = 0; i < lit.hits.size(); ++i)
  {
    listed += lit.geometry.triangle(i) < 2 && isKerb(space.ofMirror(i));
  }
  EXPECT_GT(listed, 0);
  space.lookBetween(*lit.tree, lit.frame, lit.hits, lit.geometry, lit.connections);
  int between = 0;
  for (std::size_t i = 0; i < lit.connections.size(); ++i)
  {
    between += lit.geometry.triangle(lit.connections.one[i]) < 2 &&
      lit.geometry.triangle(lit.connections.two[i]) > 3 && isKerb(space.ofConnection(i));
  }
  EXPECT_GT(between, 0);
}
