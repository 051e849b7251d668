// SPDX-License-Identifier: BSD-3-Clause
// Rays go together in packets by their number alone: neighbours of a stratified beam, and the same
// cost whatever a thread has traced before.
#include "BeamTracer.h"
#include "BoxTests.h"
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "PacketOrder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

using namespace avianlidar;

namespace
{
BeamRays stratifiedRays(std::uint64_t beam, std::size_t count)
{
  const StrataPartition strata(count);
  BeamRays rays;
  sampleBeam(0, beam, count, { 0.01, BeamProfile::Uniform }, Sampling::Stratified, &strata, rays);
  return rays;
}

/// Mean extent of the groups of sixteen, in radii of the beam.
double meanExtent(const BeamRays& rays, const std::vector<std::uint32_t>& order)
{
  double sum = 0.0;
  double groups = 0.0;
  for (std::size_t first = 0; first + PacketGroup <= order.size(); first += PacketGroup)
  {
    double most = 0.0;
    for (std::size_t i = first; i < first + PacketGroup; ++i)
    {
      for (std::size_t k = first; k < i; ++k)
      {
        most = std::max(most,
          std::hypot(rays.x[order[i]] - rays.x[order[k]], rays.y[order[i]] - rays.y[order[k]]));
      }
    }
    sum += most;
    groups += 1.0;
  }
  return sum / groups;
}
}

TEST(PacketOrder, EveryRayIsThereOnceAndBesideItsNeighbours)
{
  PacketOrder packets;
  for (const std::size_t count : { 1, 2, 15, 16, 17, 100, 333, 1000, 10001 })
  {
    const std::vector<std::uint32_t> order = packets.of(count);
    const std::set<std::uint32_t> all(order.begin(), order.end());
    ASSERT_EQ(order.size(), count);
    ASSERT_EQ(all.size(), count);
    EXPECT_EQ(*all.rbegin(), count - 1);
    if (count >= 100)
    {
      // Sixteen of N rays take a square of side sqrt(16 pi/N), if they are neighbours.
      const double side = std::sqrt(PacketGroup * Pi / static_cast<double>(count));
      EXPECT_LT(meanExtent(stratifiedRays(3, count), order), 2.2 * side) << count;
    }
  }
}

TEST(PacketOrder, DependsOnNothingButTheNumberOfRays)
{
  PacketOrder fresh;
  PacketOrder used;
  for (std::size_t count = 1; count < 300; ++count)
  {
    used.of(count);
  }
  for (const std::size_t count : { 299, 100, 3, 64 })
  {
    EXPECT_EQ(fresh.of(count), used.of(count));
  }
}

TEST(PacketOrder, ABeamCostsTheSameWhateverWasTracedBefore)
{
  geometrytest::Numbers random(5);
  const auto mesh =
    std::make_shared<TriangleMesh>(geometrytest::randomTriangles(random, 20000, 30.0, 0.3));
  const auto tree = buildCollisionTree(mesh, TreeOptions());
  const BeamFrame frame = makeBeamFrame(Vec3(-80.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0), 0.01);
  for (const std::size_t count : { 40, 100, 500 })
  {
    TraceCounters first;
    for (std::uint64_t before = 0; before < 6; ++before)
    {
      OneBeamTracer tracer(*tree);
      std::vector<Hit> hits;
      if (before > 0)
      {
        tracer.setBeam(frame);
        tracer.trace(stratifiedRays(before, count), TraceMode::Automatic, hits);
      }
      tracer.setBeam(frame);
      tracer.trace(stratifiedRays(99, count), TraceMode::Automatic, hits);
      ASSERT_GT(tracer.counters().candidates, 0u);
      first = before == 0 ? tracer.counters() : first;
      EXPECT_EQ(tracer.counters().candidates, first.candidates) << count << " rays";
      EXPECT_EQ(tracer.counters().nodesVisited, first.nodesVisited) << count << " rays";
    }
  }
}

TEST(PacketOrder, RaysThatComeWithTheirNeighboursKeepTheirOrder)
{
  // Those of sixteen small cones, cone by cone, as small targets have them.
  geometrytest::Numbers random(6);
  const auto mesh =
    std::make_shared<TriangleMesh>(geometrytest::randomTriangles(random, 20000, 30.0, 0.3));
  const auto tree = buildCollisionTree(mesh, TreeOptions());
  const BeamFrame frame = makeBeamFrame(Vec3(-80.0, 0.0, 0.0), Vec3(1.0, 0.0, 0.0), 0.1);
  BeamRays rays;
  for (int cone = 0; cone < 16; ++cone)
  {
    const double x = random(-0.7, 0.7);
    const double y = random(-0.7, 0.7);
    const BeamRays own = stratifiedRays(static_cast<std::uint64_t>(cone), 16);
    for (std::size_t i = 0; i < own.size(); ++i)
    {
      rays.x.push_back(x + 0.05 * own.x[i]);
      rays.y.push_back(y + 0.05 * own.y[i]);
    }
  }
  const auto count = static_cast<std::uint32_t>(rays.size());
  const auto trace = [&](bool inOrder, std::vector<std::uint32_t>& triangles)
  {
    OneBeamTracer tracer(*tree);
    const BeamBlock block{ &frame, 1, count,
      [&rays](std::size_t) -> const BeamRays& { return rays; }, inOrder };
    const BlockHits& found = tracer.traceBlock(block, TraceMode::Automatic);
    triangles.assign(found.triangles[0], found.triangles[0] + count);
    return found.counters[0];
  };
  std::vector<std::uint32_t> triangles[2];
  const TraceCounters parted = trace(false, triangles[0]);
  const TraceCounters together = trace(true, triangles[1]);
  EXPECT_EQ(triangles[0], triangles[1]);
  EXPECT_LT(5 * together.candidates, 4 * parted.candidates);
  EXPECT_LT(together.nodesVisited, parted.nodesVisited);
}
