// SPDX-License-Identifier: BSD-3-Clause
// The nearest point: brute force on clouds of every shape, ties among them, and few distances taken
// on all of them.
#include "PointTree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <tuple>

using namespace avianlidar;

namespace
{
struct Cloud
{
  std::string name;
  std::vector<Vec3> points;
};

/// Clouds of about `count` points that a grid of equal buckets serves well (the first) or badly.
std::vector<Cloud> cloudsOf(std::size_t count)
{
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> side(-50.0, 50.0);
  const auto inBox = [&]() { return Vec3(side(random), side(random), side(random)); };
  const auto make = [&](const std::string& name, const auto& pointOf)
  {
    Cloud cloud{ name, {} };
    for (std::size_t i = 0; i < count; ++i)
    {
      cloud.points.push_back(pointOf(i));
    }
    return cloud;
  };
  std::vector<Cloud> clouds{ make("box", [&](std::size_t) { return inBox(); }) };
  for (const double far : { 1e5, 1e9, 1e100 })
  {
    clouds.push_back(clouds[0]);
    clouds.back().name = "an outlier at " + std::to_string(far);
    clouds.back().points.push_back(Vec3(far, -far, 0.1 * far));
  }
  clouds.push_back(clouds[0]);
  clouds.back().name = "ten outliers";
  for (int i = 0; i < 10; ++i)
  {
    clouds.back().points.push_back(1e7 * inBox());
  }
  clouds.push_back(make("one place", [](std::size_t) { return Vec3(1.0, 2.0, 3.0); }));
  clouds.push_back(
    make("two places", [](std::size_t i) { return Vec3(i % 2 ? 1e6 : 0.0, 0.0, 0.1); }));
  clouds.push_back(
    make("line", [](std::size_t i) { return Vec3(0.01 * static_cast<double>(i), 0.0, 5.0); }));
  clouds.push_back(make("line askew",
    [](std::size_t i) { return 0.1 * static_cast<double>(i * i) * Vec3(1.0, 2.0, -3.0); }));
  clouds.push_back(
    make("plane", [&](std::size_t) { return Vec3(side(random), side(random), 7.0); }));
  clouds.push_back(make("clusters at two scales",
    [&](std::size_t i)
    { return (i % 2 ? 1e-5 : 1e3) * inBox() + Vec3(i % 2 ? 700.0 : 0.0, 0.0, 0.0); }));
  clouds.push_back(
    make("grid", [](std::size_t i) { return Vec3(i % 20, (i / 20) % 20, i / 400); }));
  return clouds;
}

/// Square of the distance, then the place: the least is the nearest of all.
using Found = std::tuple<double, double, double, double>;

Found found(double square, const Vec3& point)
{
  return { square, point.x, point.y, point.z };
}

Found bruteForce(const std::vector<Vec3>& points, const Vec3& place)
{
  Found least = found(std::numeric_limits<double>::infinity(), Vec3(0.0));
  for (const Vec3& point : points)
  {
    const Vec3 way = place - point;
    least = std::min(least, found(way.x * way.x + way.y * way.y + way.z * way.z, point));
  }
  return least;
}
}

TEST(PointTree, IsBruteForceToTheLastBit)
{
  for (const std::size_t count : { 1, 2, 8, 9, 17, 100, 700 })
  {
    const std::vector<Cloud> clouds = cloudsOf(count);
    for (const Cloud& to : clouds)
    {
      const PointTree tree(to.points);
      for (const Cloud& from : clouds)
      {
        for (std::size_t i = 0; i < from.points.size(); i += 1 + from.points.size() / 50)
        {
          const Vec3 place = from.points[i];
          const PointTree::Nearest nearest = tree.nearest(place);
          ASSERT_EQ(
            found(nearest.square, tree.points()[nearest.index]), bruteForce(to.points, place))
            << from.name << " to " << to.name;
          ASSERT_EQ(tree.nearestSquare(place), nearest.square);
        }
      }
    }
  }
  EXPECT_EQ(PointTree({}).nearestSquare(Vec3(0.0)), std::numeric_limits<double>::infinity());
}

TEST(PointTree, ChoosesAmongEquallyNearPoints)
{
  // Whole numbers, each place several times: every distance is exact, and many are equal.
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> side(-3, 3);
  std::vector<Vec3> points;
  for (int i = 0; i < 900; ++i)
  {
    points.push_back(Vec3(side(random), side(random), i % 3 ? side(random) : 0));
  }
  std::vector<Vec3> others = points;
  std::shuffle(others.begin(), others.end(), random);
  const PointTree tree(points);
  const PointTree other(others);
  std::map<std::tuple<double, double, double>, std::size_t> indices;
  for (int x = -8; x <= 8; ++x)
  {
    for (int y = -8; y <= 8; ++y)
    {
      for (int z = -8; z <= 8; ++z)
      {
        const Vec3 place(0.5 * x, 0.5 * y, 0.5 * z);
        const PointTree::Nearest nearest = tree.nearest(place);
        const Vec3 point = tree.points()[nearest.index];
        ASSERT_EQ(found(nearest.square, point), bruteForce(points, place));
        ASSERT_EQ(point, other.points()[other.nearest(place).index]);
        // One index for all points in a place, whatever is asked for.
        ASSERT_EQ(
          indices.emplace(std::tuple(point.x, point.y, point.z), nearest.index).first->second,
          nearest.index);
      }
    }
  }
  EXPECT_GT(indices.size(), 200u);
}

TEST(PointTree, TakesFewDistancesOnEveryCloud)
{
  constexpr std::size_t count = 20000;
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0.0, 0.02);
  for (const Cloud& cloud : cloudsOf(count))
  {
    const PointTree tree(cloud.points);
    std::size_t itself = 0;
    std::size_t beside = 0;
    for (const Vec3& point : cloud.points)
    {
      tree.nearestSquare(point, &itself);
      tree.nearestSquare(point + Vec3(noise(random), noise(random), noise(random)), &beside);
    }
    const double points = static_cast<double>(cloud.points.size());
    EXPECT_LT(static_cast<double>(itself) / points, 20.0) << cloud.name;
    EXPECT_LT(static_cast<double>(beside) / points, 40.0) << cloud.name;
  }
}
