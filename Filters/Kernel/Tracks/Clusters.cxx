// SPDX-License-Identifier: BSD-3-Clause
#include "Clusters.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace avianlidar
{
namespace
{
/// Least reach of cells, m: it applies where only points in one place are neighbours.
constexpr double LeastCell = 1e-3;

/// Level of the cell, which is 2^level m wide, then its place along x, y and z.
using Cell = std::array<std::int64_t, 4>;

struct CellHash
{
  std::size_t operator()(const Cell& cell) const
  {
    std::uint64_t hash = 0;
    for (const std::int64_t part : cell)
    {
      hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 29;
    }
    return static_cast<std::size_t>(hash);
  }
};

auto contentOf(const CloudPoint& point)
{
  return std::make_tuple(
    point.position.x, point.position.y, point.position.z, point.time, point.rangeError);
}

/// Indices of the values, sorted by content.
template <class T, class Content>
std::vector<std::size_t> orderOf(const std::vector<T>& values, Content content)
{
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b) { return content(values[a]) < content(values[b]); });
  return order;
}

/// Points that belong to no cluster yet, by cell.
class Grid
{
public:
  Grid(const std::vector<CloudPoint>& points, const Vec3& sensor, double distance, double angle)
    : Distance(distance)
    , Angle(angle)
  {
    for (const CloudPoint& point : points)
    {
      this->Places.push_back(point.position - sensor);
      this->Ranges.push_back(safeLength(this->Places.back()));
      const int level = levelOf(this->reach(this->Ranges.back()));
      this->Cells[cellOf(level, this->Places.back())].push_back(this->Places.size() - 1);
    }
  }

  /// Takes a point and its neighbours out of their cells.
  void take(std::size_t point, std::vector<std::size_t>& taken)
  {
    const Vec3& place = this->Places[point];
    const double mine = this->reach(this->Ranges[point]);
    // Ranges of two points differ by at most their distance, so no neighbour is farther away.
    const double farthest = mine / (1.0 - 0.5 * this->Angle) * (1.0 + 1e-9);
    const double change = this->Angle * farthest;
    for (int level = levelOf(mine - change); level <= levelOf(mine + change); ++level)
    {
      const Cell first = cellOf(level, place - farthest);
      const Cell last = cellOf(level, place + farthest);
      for (std::int64_t x = first[1]; x <= last[1]; ++x)
      {
        for (std::int64_t y = first[2]; y <= last[2]; ++y)
        {
          for (std::int64_t z = first[3]; z <= last[3]; ++z)
          {
            this->takeFrom({ level, x, y, z }, point, taken);
          }
        }
      }
    }
  }

private:
  double reach(double range) const { return this->Distance + this->Angle * range; }

  static int levelOf(double reach) { return std::ilogb(std::fmax(reach, LeastCell)) + 1; }

  static Cell cellOf(int level, const Vec3& place)
  {
    const Vec3 cell = glm::floor(place / std::ldexp(1.0, level));
    return { level, static_cast<std::int64_t>(cell.x), static_cast<std::int64_t>(cell.y),
      static_cast<std::int64_t>(cell.z) };
  }

  void takeFrom(const Cell& cell, std::size_t point, std::vector<std::size_t>& taken)
  {
    const auto found = this->Cells.find(cell);
    if (found == this->Cells.end())
    {
      return;
    }
    std::vector<std::size_t>& left = found->second;
    const auto isNeighbour = [&](std::size_t other)
    {
      const double most = this->reach(0.5 * (this->Ranges[point] + this->Ranges[other]));
      const Vec3 apart = this->Places[point] - this->Places[other];
      return other == point || glm::dot(apart, apart) <= most * most;
    };
    const auto end = std::partition(
      left.begin(), left.end(), [&](std::size_t other) { return !isNeighbour(other); });
    taken.insert(taken.end(), end, left.end());
    left.erase(end, left.end());
    if (left.empty())
    {
      this->Cells.erase(found);
    }
  }

  double Distance;
  double Angle;
  std::vector<Vec3> Places; ///< places relative to the sensor, m
  std::vector<double> Ranges;
  std::unordered_map<Cell, std::vector<std::size_t>, CellHash> Cells;
};

/// Mean of a cluster. The order of members, and with it rounding, depends only on their content.
Cluster meanOf(const std::vector<CloudPoint>& points, const std::vector<std::size_t>& members)
{
  const CloudPoint& first = points[members[0]];
  Cluster mean{ Vec3(0.0), 0.0, 0.0, static_cast<int>(members.size()) };
  for (const std::size_t member : members)
  {
    const CloudPoint& point = points[member];
    mean.center += point.position - first.position;
    mean.time += point.time - first.time;
    mean.rangeVariance += point.rangeError * point.rangeError;
  }
  const double count = static_cast<double>(members.size());
  mean.center = first.position + mean.center / count;
  mean.time = first.time + mean.time / count;
  mean.rangeVariance /= count;
  return mean;
}
}

Clusters findClusters(
  const std::vector<CloudPoint>& points, const Vec3& sensor, double distance, double angle)
{
  const std::vector<std::size_t> byContent = orderOf(points, contentOf);
  std::vector<std::size_t> placeOf(points.size());
  std::vector<CloudPoint> sorted;
  for (const std::size_t point : byContent)
  {
    placeOf[point] = sorted.size();
    sorted.push_back(points[point]);
  }
  Grid grid(sorted, sensor, distance, angle);
  std::vector<Cluster> found;
  std::vector<std::size_t> clusterOf(points.size(), points.size());
  for (std::size_t seed = 0; seed < sorted.size(); ++seed)
  {
    if (clusterOf[seed] < points.size())
    {
      continue;
    }
    std::vector<std::size_t> members;
    grid.take(seed, members);
    for (std::size_t next = 0; next < members.size(); ++next)
    {
      clusterOf[members[next]] = found.size();
      grid.take(members[next], members);
    }
    found.push_back(meanOf(sorted, members));
  }
  const std::vector<std::size_t> order = orderOf(found,
    [](const Cluster& c) { return std::make_tuple(c.center.x, c.center.y, c.center.z, c.time); });
  Clusters clusters;
  std::vector<std::size_t> rank(order.size());
  for (const std::size_t cluster : order)
  {
    rank[cluster] = clusters.all.size();
    clusters.all.push_back(found[cluster]);
  }
  for (const std::size_t place : placeOf)
  {
    clusters.ofPoint.push_back(rank[clusterOf[place]]);
  }
  return clusters;
}
}
