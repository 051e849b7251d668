// SPDX-License-Identifier: BSD-3-Clause
// Groups of beams: whole and compact; beams traced in a block have the hits of single rays; the
// candidates of a beam hold every hit once.
#include "BeamGroup.h"
#include "BeamTracer.h"
#include "Candidates.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "InstructionTargets.h"
#include "VolumeTree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <set>

using namespace avianlidar;
using namespace geometrytest;

TEST(BeamGroup, BeamsInOrderAreAllThereAndNeighbours)
{
  Numbers random(21);
  std::vector<BeamFrame> frames;
  // A scan of 40 columns of 25 channels, shuffled.
  for (const BeamFrame& frame : window(Vec3(0.0), { 1, 2, 0.1 }, 40, 25, 0.01, 0.005))
  {
    frames.push_back(frame);
    std::swap(frames.back(), frames[static_cast<std::size_t>(random() * frames.size())]);
  }
  std::vector<std::uint32_t> beams(frames.size());
  std::iota(beams.begin(), beams.end(), 0u);
  std::vector<std::uint64_t> keys;
  orderBeams(frames.data(), beams, keys);
  EXPECT_EQ(std::set<std::uint32_t>(beams.begin(), beams.end()).size(), frames.size());
  double apart = 0.0;
  for (std::size_t first = 0; first + 16 <= beams.size(); first += 16)
  {
    double most = 0.0;
    for (std::size_t i = first; i < first + 16; ++i)
    {
      most = std::max(most, glm::distance(frames[beams[first]].axis, frames[beams[i]].axis));
    }
    apart += most / static_cast<double>(beams.size() / 16);
  }
  // Sixteen beams in a square are 3 sqrt(2) steps across; in order of a column, 15.
  EXPECT_LT(apart, 7.5 * 0.01);
  beams.clear();
  orderBeams(frames.data(), beams, keys);
  EXPECT_TRUE(beams.empty());
}

TEST(BeamGroup, ABlockOfBeamsHasTheHitsOfSingleRays)
{
  Numbers random(23);
  for (int round = 0; round < 24; ++round)
  {
    auto mesh = std::make_shared<TriangleMesh>(
      randomTriangles(random, 400, 50.0, random.logUniform(0.05, 20.0)));
    // Ground, far wider than high, below the beams and around them.
    addTriangle(*mesh, { -300, -300, -2 }, { 300, -300, -2 }, { 300, 300, -2 });
    addTriangle(*mesh, { -300, -300, -2 }, { 300, 300, -2 }, { -300, 300, -2 });
    const auto tree = buildCollisionTree(mesh, TreeOptions());
    const double width = random.logUniform(1e-4, 0.1);
    std::vector<BeamFrame> frames =
      window({ 0, 0, 0 }, random.direction(), 7, 5, width * random.logUniform(0.5, 30.0), width);
    // Another apex, another width, and beams all around.
    const auto other = window({ 1, 2, 3 }, random.direction(), 2, 3, 0.01, width);
    frames.insert(frames.begin() + 11, other.begin(), other.end());
    frames.push_back(makeBeamFrame({ 0, 0, 0 }, random.direction(), 0.5 * width));
    for (int i = 0; i < 9; ++i)
    {
      frames.push_back(makeBeamFrame({ 0, 0, 0 }, random.direction(), 0.5));
    }
    const std::uint32_t counts[] = { 1, 2, 7, 8, 16, 33, 100, 300 };
    const std::uint32_t rays = counts[round % 8];
    std::vector<BeamRays> drawn;
    for (std::size_t b = 0; b < frames.size(); ++b)
    {
      drawn.push_back(raysInDisc(random, rays));
    }
    DrawnRays given(drawn.data());
    const TracedBeams block{ frames.data(), frames.size(), rays, &given };
    const auto check = [&]()
    {
      for (const TraceMode mode : { TraceMode::Automatic, TraceMode::Beams })
      {
        const SceneTriangles togetherScene(*tree);
        BeamTracer together(togetherScene);
        OneBeamTracer alone(*tree);
        const TracedHits& found = together.traceBeams(block, mode);
        std::vector<Hit> singly;
        for (std::size_t b = 0; b < frames.size(); ++b)
        {
          alone.setBeam(frames[b]);
          alone.trace(drawn[b], TraceMode::SingleRays, singly);
          EXPECT_EQ(found.counters[b].raysTraced, rays);
          bool any = false;
          for (std::size_t i = 0; i < singly.size(); ++i)
          {
            any = any || singly[i].valid();
            const std::uint32_t triangle = found.triangles[b] ? found.triangles[b][i] : NoTriangle;
            ASSERT_EQ(triangle, singly[i].triangle)
              << "round " << round << " beam " << b << " ray " << i;
          }
          EXPECT_EQ(found.triangles[b] != nullptr, any);
        }
      }
    };
    echotest::forEachInstructionTarget(check);
    for (const bool together : { true, false })
    {
      BeamCandidates candidates;
      std::vector<std::multiset<std::uint32_t>> lists(frames.size());
      const SceneTriangles all(*tree);
      candidates.begin(all, frames.data(), frames.size(), together);
      while (candidates.next())
      {
        EXPECT_TRUE(lists[candidates.beam()].empty());
        const std::vector<std::uint32_t>& found =
          candidates.collect(std::numeric_limits<double>::infinity());
        lists[candidates.beam()].insert(found.begin(), found.end());
      }
      OneBeamTracer alone(*tree);
      std::vector<Hit> hits;
      for (std::size_t b = 0; b < frames.size(); ++b)
      {
        alone.setBeam(frames[b]);
        alone.trace(drawn[b], TraceMode::SingleRays, hits);
        for (const Hit& hit : hits)
        {
          ASSERT_TRUE(!hit.valid() || lists[b].count(hit.triangle) == 1)
            << "round " << round << " beam " << b << " triangle " << hit.triangle;
        }
      }
    }
  }
}

TEST(BeamGroup, RaysAreDrawnOnlyForBeamsThatMayHit)
{
  TriangleMesh wall;
  addTriangle(wall, { -1, 10, -1 }, { 1, 10, -1 }, { 0, 10, 2 });
  const auto tree = buildCollisionTree(std::make_shared<TriangleMesh>(wall), TreeOptions());
  Numbers random(24);
  std::vector<BeamFrame> frames;
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < 32; ++i)
  {
    ids.push_back(static_cast<std::uint64_t>(i));
    frames.push_back(
      makeBeamFrame(Vec3(0.0), { std::sin(Pi / 16.0 * i), std::cos(Pi / 16.0 * i), 0.0 }, 0.005));
  }
  BeamSampler sampler(Sensor(), Sampling::Stratified, 50);
  DrawnRays drawn(sampler, 0);
  drawn.begin(ids, 0, ids.size());
  const TracedBeams block{ frames.data(), frames.size(), 50, &drawn };
  OneBeamTracer tracer(*tree);
  const TracedHits& found = tracer.traceBeams(block, TraceMode::Automatic);
  EXPECT_NE(found.triangles[0], nullptr);
  for (std::size_t b = 0; b < ids.size(); ++b)
  {
    EXPECT_EQ(drawn.has(b), b == 0) << b;
  }
}

TEST(BeamGroup, TreesWithoutWideFormAreDescendedOnceABeam)
{
  Numbers random(25);
  const auto mesh =
    std::make_shared<TriangleMesh>(closedSurface(3, [](const Vec3&) { return 10.0; }));
  for (const BoundingVolumeType volume : { BoundingVolumeType::OBB, BoundingVolumeType::Sphere })
  {
    const auto tree =
      buildVolumeTree(mesh, TreeOptions{ SplitRule::SurfaceAreaHeuristic, volume, 4 });
    OneBeamTracer tracer(*tree);
    std::vector<Hit> hits;
    std::uint64_t nodes[2];
    for (const TraceMode mode : { TraceMode::Automatic, TraceMode::SingleRays })
    {
      // The apex in the origin of the coordinates, where nothing has a size of its own.
      tracer.setBeam(makeBeamFrame(Vec3(0.0), { 1, 2, 3 }, 0.01));
      tracer.trace(raysInDisc(random, 100), mode, hits);
      nodes[mode == TraceMode::SingleRays ? 1 : 0] = tracer.counters().nodesVisited;
    }
    EXPECT_LT(20 * nodes[0], nodes[1]);
  }
}
