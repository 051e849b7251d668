// SPDX-License-Identifier: BSD-3-Clause
// Lanes do the arithmetic of one ray against one triangle, bit for bit.
#include "TriangleLanes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

using namespace avianlidar;

namespace
{
template <class T>
bool sameBits(T a, T b)
{
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/// Triangles in and around the beam: well shaped, slivers, seen at grazing incidence, behind,
/// degenerate.
Corners someTriangle(std::mt19937_64& random, const BeamFrame& frame)
{
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const double range = std::pow(10.0, 1.0 + 2.0 * uniform(random));
  const double size = range * frame.tanHalf * std::pow(10.0, 2.0 * uniform(random));
  const Vec3 center = range * frame.direction(1.5 * uniform(random), 1.5 * uniform(random));
  const auto corner = [&]
  { return center + size * Vec3(uniform(random), uniform(random), uniform(random)); };
  Corners t{ corner(), corner(), corner() };
  const double kind = uniform(random);
  if (kind > 0.7)
  {
    t.c = t.a + 0.5 * (t.b - t.a) + 1e-7 * (t.c - center); // a needle
  }
  else if (kind > 0.4)
  {
    t.b += 1000.0 * size * frame.axis; // grazing
  }
  else if (kind < -0.95)
  {
    t.c = t.b;
  }
  return t;
}

template <typename Real>
void compare(unsigned seed)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int accepted = 0;
  int slivers = 0;
  for (int round = 0; round < 400; ++round)
  {
    const BeamFrame frame =
      makeBeamFrame(Vec3(0.0), Vec3(uniform(random), uniform(random), uniform(random)),
        std::pow(10.0, -2.0 + uniform(random)));
    const BeamPlaneMap map(frame);
    std::vector<double> x, y;
    while (x.size() < 53)
    {
      const double px = uniform(random);
      const double py = uniform(random);
      if (px * px + py * py <= 1.0)
      {
        x.push_back(px);
        y.push_back(py);
      }
    }
    RayLanes<Real> rays;
    rays.set(frame, x.data(), y.data(), x.size());
    std::vector<double> nearest(x.size(), std::numeric_limits<double>::infinity());
    std::vector<std::uint32_t> owner(x.size(), NoTriangle);
    for (std::uint32_t batch = 0; batch < 4; ++batch)
    {
      TriangleLanes<Real> lanes;
      for (int lane = 0; lane < TriangleLanes<Real>::Width; ++lane)
      {
        lanes.put(lane, 8 * batch + lane, someTriangle(random, frame));
      }
      lanes.prepare(map);
      for (int lane = 0; lane < TriangleLanes<Real>::Width; ++lane)
      {
        const Corners corners = lanes.corners(lane);
        BeamTriangle<Real> alone;
        if (!alone.set(map, corners))
        {
          EXPECT_FALSE(lanes.candidate[lane]);
          continue;
        }
        for (int e = 0; e < 3; ++e)
        {
          ASSERT_TRUE(sameBits(lanes.x[e][lane], alone.edges[e].x) &&
            sameBits(lanes.y[e][lane], alone.edges[e].y) &&
            sameBits(lanes.z[e][lane], alone.edges[e].z) &&
            sameBits(lanes.tolerance[e][lane], alone.edges[e].tolerance));
        }
        EXPECT_EQ(lanes.candidate[lane] != 0, !alone.missesCone());
        const RayBundle bundle{ 0, rays.padded, frame.axis, frame.sinHalf, frame.cosHalf,
          beamRayMargin(frame) };
        bool changed = false;
        if (lanes.candidate[lane] && testRays(lanes, lane, rays, bundle.begin, bundle.end))
        {
          takeRanges(corners, lanes.id[lane], bundle, rays, changed);
        }
        const TrianglePlane plane = planeOf(corners);
        for (std::size_t i = 0; i < x.size(); ++i)
        {
          const Vec3 d = unitDirection(frame.direction(x[i], y[i]));
          ASSERT_TRUE(
            sameBits(d.x, rays.dx[i]) && sameBits(d.y, rays.dy[i]) && sameBits(d.z, rays.dz[i]));
          if (!beamRayAccepted<Real>(
                map, corners, static_cast<Real>(x[i]), static_cast<Real>(y[i])))
          {
            continue;
          }
          ++accepted;
          slivers += rangeOnPlane(corners, plane, d.x, d.y, d.z).kind == 2;
          const double range = rangeOf(corners, plane, d, bundle.angularMargin);
          if (range > 0.0 &&
            (range < nearest[i] || (range == nearest[i] && lanes.id[lane] < owner[i])))
          {
            nearest[i] = range;
            owner[i] = lanes.id[lane];
          }
        }
      }
    }
    for (std::size_t i = 0; i < x.size(); ++i)
    {
      ASSERT_TRUE(sameBits(nearest[i], rays.range[i])) << round << " ray " << i;
      ASSERT_EQ(owner[i], static_cast<std::uint32_t>(rays.triangle[i]));
    }
  }
  EXPECT_GT(accepted, 10000);
  EXPECT_GT(slivers, 100);
}
}

TEST(TriangleLanes, SingleIsOneRayAgainstOneTriangleBitForBit)
{
  compare<float>(1);
}

TEST(TriangleLanes, DoubleIsOneRayAgainstOneTriangleBitForBit)
{
  compare<double>(2);
}
