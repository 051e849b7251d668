// SPDX-License-Identifier: BSD-3-Clause
// Clusters: those of brute force, whatever the order of the points.
#include "Clusters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <random>

using namespace avianlidar;

namespace
{
/// Points in groups, from beside the sensor to far away.
std::vector<CloudPoint> someCloud(unsigned seed, int groups, int inEach, const Vec3& sensor)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> side(-1.0, 1.0);
  std::vector<CloudPoint> points;
  for (int group = 0; group < groups; ++group)
  {
    const double range = std::pow(10.0, 1.5 + 1.5 * side(random));
    const Vec3 middle = sensor + range * Vec3(side(random), side(random), side(random));
    for (int i = 0; i < inEach; ++i)
    {
      const double spread = 0.01 * range + 1.0;
      points.push_back({ middle + spread * Vec3(side(random), side(random), side(random)),
        side(random), 0.1 + 0.05 * side(random) });
    }
  }
  return points;
}

/// The least point of the component of each.
std::vector<std::size_t> bruteForce(
  const std::vector<CloudPoint>& points, const Vec3& sensor, double distance, double angle)
{
  std::vector<std::size_t> least(points.size());
  std::iota(least.begin(), least.end(), std::size_t{ 0 });
  for (bool changed = true; changed;)
  {
    changed = false;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      for (std::size_t j = 0; j < i; ++j)
      {
        const double range =
          0.5 * (safeLength(points[i].position - sensor) + safeLength(points[j].position - sensor));
        if (least[i] != least[j] &&
          safeLength(points[i].position - points[j].position) <= distance + angle * range)
        {
          least[i] = least[j] = std::min(least[i], least[j]);
          changed = true;
        }
      }
    }
  }
  return least;
}
}

TEST(Clusters, AreThoseOfBruteForce)
{
  const Vec3 sensor(300.0, -200.0, 5.0);
  for (const auto& [distance, angle] :
    { std::pair(1.5, 0.01), std::pair(0.0, 0.02), std::pair(3.0, 0.0), std::pair(0.5, 0.4) })
  {
    const std::vector<CloudPoint> points = someCloud(1, 60, 6, sensor);
    const Clusters clusters = findClusters(points, sensor, distance, angle);
    const std::vector<std::size_t> expected = bruteForce(points, sensor, distance, angle);
    std::map<std::size_t, std::size_t> matching;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      const auto known = matching.emplace(expected[i], clusters.ofPoint[i]).first;
      EXPECT_EQ(known->second, clusters.ofPoint[i]) << distance << " " << angle << " " << i;
    }
    EXPECT_EQ(matching.size(), clusters.all.size()) << distance << " " << angle;
    EXPECT_LT(clusters.all.size(), points.size());
  }
}

TEST(Clusters, AreTheMeansOfTheirPoints)
{
  const std::vector<CloudPoint> points{ { { 10, 0, 0 }, 1.0, 0.1 }, { { 100, 0, 0 }, 5.0, 0.2 },
    { { 11, 0, 0 }, 2.0, 0.3 } };
  const Clusters clusters = findClusters(points, Vec3(0.0), 1.0, 0.0);
  EXPECT_EQ(clusters.ofPoint, (std::vector<std::size_t>{ 0, 1, 0 }));
  EXPECT_EQ(clusters.all[0].center, Vec3(10.5, 0, 0));
  EXPECT_EQ(clusters.all[0].time, 1.5);
  EXPECT_DOUBLE_EQ(clusters.all[0].rangeVariance, 0.05);
  EXPECT_EQ(clusters.all[0].points, 2);
  EXPECT_EQ(findClusters(points, Vec3(0.0), 0.999, 0.0).all.size(), 3u);
  EXPECT_EQ(findClusters(points, Vec3(0.0), 0.0, 0.0).all.size(), 3u);
  EXPECT_TRUE(findClusters({}, Vec3(0.0), 1.0, 0.0).all.empty());
}

TEST(Clusters, HaveTheSameBitsInAnyOrder)
{
  const Vec3 sensor(0.0);
  std::vector<CloudPoint> points = someCloud(2, 50, 20, sensor);
  points.push_back(points.front());
  const Clusters first = findClusters(points, sensor, 1.0, 0.01);
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::shuffle(order.begin(), order.end(), std::mt19937_64(3));
  std::vector<CloudPoint> shuffled;
  for (const std::size_t i : order)
  {
    shuffled.push_back(points[i]);
  }
  const Clusters second = findClusters(shuffled, sensor, 1.0, 0.01);
  ASSERT_EQ(first.all.size(), second.all.size());
  for (std::size_t i = 0; i < first.all.size(); ++i)
  {
    EXPECT_EQ(first.all[i].center, second.all[i].center);
    EXPECT_EQ(first.all[i].time, second.all[i].time);
    EXPECT_EQ(first.all[i].rangeVariance, second.all[i].rangeVariance);
  }
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    EXPECT_EQ(second.ofPoint[i], first.ofPoint[order[i]]);
  }
}
