// SPDX-License-Identifier: BSD-3-Clause
// Persistence in closed form, cells and their neighbours by brute force, bounded memory, the order
// of points.
#include "ClutterMap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

using namespace avianlidar;

namespace
{
using Key = ClutterMap::Key;

Vec3 pointAt(double azimuth, double elevation, double range)
{
  const double a = azimuth * RadiansPerDegree;
  const double e = elevation * RadiansPerDegree;
  return range * Vec3(std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e));
}

/// The sum of the weights of n scans, added one by one.
double weights(double window, int scans)
{
  double sum = 0.0;
  for (int k = 0; k < scans; ++k)
  {
    sum += std::pow(1.0 - 1.0 / window, k);
  }
  return sum;
}
}

TEST(TestClutterMap, CellsOfPoints)
{
  const ClutterGrid grid{ 1.5, 0.375, 0.5 };
  EXPECT_EQ(grid.columns(), 960);
  const auto cellOf = [&](double azimuth, double elevation, double range)
  { return ClutterMap::cellOf(ClutterMap::keyOf(grid, pointAt(azimuth, elevation, range))); };
  for (const double azimuth : { 0.0, 0.375, 90.0, 180.0, 270.0, 359.625 })
  {
    for (const double off : { -0.18, 0.0, 0.18 })
    {
      EXPECT_EQ(cellOf(azimuth + off, 0.1, 10.0).azimuth, std::lround(azimuth / 0.375));
    }
  }
  EXPECT_EQ(cellOf(0.0, 0.74, 10.0).elevation, 1);
  EXPECT_EQ(cellOf(0.0, -0.76, 10.0).elevation, -2);
  EXPECT_EQ(cellOf(0.0, 90.0, 10.0).elevation, 180);
  EXPECT_EQ(cellOf(0.0, 0.0, 1.49).range, 0);
  EXPECT_EQ(cellOf(0.0, 0.0, 1.51).range, 1);
  EXPECT_EQ(cellOf(10.0, 0.0, 1e30).range, ClutterMap::MostRanges - 1);
  const ClutterCell own = ClutterMap::cellOf(ClutterMap::keyOf(grid, Vec3(0.0)));
  EXPECT_TRUE(own.azimuth == 0 && own.elevation == 0 && own.range == 0);
}

TEST(TestClutterMap, MiddlesAreInTheirCells)
{
  for (const ClutterGrid& grid : { ClutterGrid{}, ClutterGrid{ 0.001, 0.001, 0.001 },
         ClutterGrid{ 1000.0, 90.0, 90.0 }, ClutterGrid{ 0.7, 1.0 / 3.0, 0.7 } })
  {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> side(-500.0, 500.0);
    std::vector<Key> keys;
    for (int i = 0; i < 1000; ++i)
    {
      const Key key = ClutterMap::keyOf(grid, { side(random), side(random), side(random) });
      const ClutterCell cell = ClutterMap::cellOf(key);
      EXPECT_TRUE(ClutterMap::holds(grid, cell));
      EXPECT_EQ(ClutterMap::keyOf(cell), key);
      keys.push_back(key);
    }
    const ClutterMap map = ClutterMap(grid).learned(keys);
    const std::vector<Vec3> middles = map.middles();
    for (std::size_t i = 0; i < middles.size(); ++i)
    {
      const Key key = map.keys()[i];
      if (std::fabs(ClutterMap::cellOf(key).elevation * grid.elevationStep) < 89.0)
      {
        EXPECT_EQ(ClutterMap::keyOf(grid, middles[i]), key);
      }
    }
  }
  EXPECT_FALSE(ClutterMap::holds({}, { -1, 0, 0 }));
  EXPECT_FALSE(ClutterMap::holds({}, { 960, 0, 0 }));
  EXPECT_FALSE(ClutterMap::holds({}, { 0, 241, 0 }));
  EXPECT_FALSE(ClutterMap::holds({}, { 0, 0, -1 }));
}

TEST(TestClutterMap, PersistenceInClosedForm)
{
  // An echo in every third scan: sums of a geometric series.
  for (const double window : { 1.0, 2.0, 20.0, 500.0, 100000.0 })
  {
    ClutterMap map({}, window);
    const Key key = ClutterMap::keyOf({}, Vec3(10.0, 0.0, 0.0));
    const Key always = ClutterMap::keyOf({}, Vec3(0.0, 10.0, 0.0));
    double hits = 0.0;
    for (int scan = 0; scan < 100; ++scan)
    {
      const bool hit = scan % 3 == 0;
      hits = hits * (1.0 - 1.0 / window) + (hit ? 1.0 : 0.0);
      map = map.learned(hit ? std::vector<Key>{ always, key, key } : std::vector<Key>{ always });
      const double expected = hits / weights(window, scan + 1);
      const std::vector<double> found = map.probabilities({ key, always }, 0, 0);
      EXPECT_NEAR(found[0], expected, 1e-9) << window << " " << scan;
      EXPECT_NEAR(found[1], 1.0, 1e-9);
    }
    EXPECT_EQ(map.scans(), 100);
  }
}

TEST(TestClutterMap, NeighboursByBruteForce)
{
  std::mt19937_64 random(5);
  const ClutterGrid grid{ 1.0, 10.0, 10.0 }; // few cells: neighbours across north, too
  const auto scan = [&]()
  {
    std::uniform_real_distribution<double> side(-6.0, 6.0);
    std::vector<Key> keys;
    for (int i = 0; i < 200; ++i)
    {
      keys.push_back(
        ClutterMap::keyOf(grid, Vec3{ side(random), side(random), 0.3 * side(random) }));
    }
    return keys;
  };
  ClutterMap map(grid, 5.0);
  for (int i = 0; i < 4; ++i)
  {
    map = map.learned(scan());
  }
  const std::vector<Key> points = scan();
  for (const int rangeTolerance : { 0, 1, 3, 10 })
  {
    for (const int angularTolerance : { 0, 1, 2, 10 })
    {
      const std::vector<double> found = map.probabilities(points, rangeTolerance, angularTolerance);
      for (std::size_t i = 0; i < points.size(); ++i)
      {
        const ClutterCell own = ClutterMap::cellOf(points[i]);
        double largest = 0.0;
        for (std::size_t k = 0; k < map.keys().size(); ++k)
        {
          const ClutterCell cell = ClutterMap::cellOf(map.keys()[k]);
          const int turn = std::abs(cell.azimuth - own.azimuth);
          const bool near = std::min(turn, grid.columns() - turn) <= angularTolerance &&
            std::abs(cell.elevation - own.elevation) <= angularTolerance &&
            std::abs(cell.range - own.range) <= rangeTolerance;
          largest = near ? std::max(largest, map.persistence(k)) : largest;
        }
        EXPECT_EQ(found[i], largest);
      }
    }
  }
}

TEST(TestClutterMap, OrderOfPointsDoesNotMatter)
{
  std::mt19937_64 random(2);
  std::uniform_int_distribution<int> any(0, 50);
  ClutterMap one;
  ClutterMap other;
  for (int scan = 0; scan < 20; ++scan)
  {
    std::vector<Key> keys;
    for (int i = 0; i < 100; ++i)
    {
      keys.push_back(ClutterMap::keyOf({ any(random), any(random) - 25, any(random) }));
    }
    one = one.learned(keys);
    std::shuffle(keys.begin(), keys.end(), random);
    other = other.learned(keys);
  }
  ASSERT_EQ(one.keys(), other.keys());
  for (std::size_t k = 0; k < one.keys().size(); ++k)
  {
    EXPECT_EQ(one.persistence(k), other.persistence(k));
  }
}

TEST(TestClutterMap, MemoryIsBounded)
{
  // New cells in every scan: each is kept until its persistence is below the least.
  for (const double window : { 5.0, 100.0, 1000.0 })
  {
    ClutterMap map({}, window);
    const int points = 3;
    int next = 0;
    std::size_t most = 0;
    const int scans = static_cast<int>(10.0 * std::max(window, 100.0));
    for (int scan = 0; scan < scans; ++scan)
    {
      std::vector<Key> keys;
      for (int i = 0; i < points; ++i)
      {
        keys.push_back(ClutterMap::keyOf({ 0, 0, next++ }));
      }
      map = map.learned(keys);
      most = std::max(most, map.keys().size());
    }
    EXPECT_LE(most, points / map.persistenceKept());
    // A cell weighs q^k / W after k scans.
    const double age = std::log(map.persistenceKept() * window) / std::log(1.0 - 1.0 / window);
    EXPECT_NEAR(static_cast<double>(map.keys().size()), points * (age + 1.0), points);
  }
  EXPECT_EQ(ClutterMap({}, 100.0).persistenceKept(), 0.001);
}
