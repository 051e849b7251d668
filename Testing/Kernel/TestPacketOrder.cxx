// SPDX-License-Identifier: BSD-3-Clause
// Rays go together in packets by their number alone: neighbours of a stratified beam.
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
