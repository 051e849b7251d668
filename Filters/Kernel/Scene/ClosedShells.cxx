// SPDX-License-Identifier: BSD-3-Clause
#include "ClosedShells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

namespace avianlidar
{
namespace
{
using Triangle = std::array<std::uint32_t, 3>;

Triangle turnedOver(const Triangle& t)
{
  return { t[0], t[2], t[1] };
}

/// Disjoint sets, with the turn of each member against the first member of its set.
class JoinedSets
{
public:
  explicit JoinedSets(std::size_t size)
    : Parent(size)
    , Turned(size, false)
  {
    std::iota(this->Parent.begin(), this->Parent.end(), 0u);
  }
  std::pair<std::uint32_t, bool> find(std::uint32_t i)
  {
    bool turned = false;
    while (this->Parent[i] != i)
    {
      const std::uint32_t above = this->Parent[i];
      this->Turned[i] = this->Turned[i] != this->Turned[above];
      this->Parent[i] = this->Parent[above];
      turned = turned != this->Turned[i];
      i = this->Parent[i];
    }
    return { i, turned };
  }
  /// Join the sets of two members. @param turned true if one member is turned against the other
  /// @return false if the members are already joined with the other turn
  bool join(std::uint32_t a, std::uint32_t b, bool turned)
  {
    const auto [one, oneTurned] = this->find(a);
    const auto [two, twoTurned] = this->find(b);
    const bool between = turned != (oneTurned != twoTurned);
    if (one == two)
    {
      return !between;
    }
    this->Parent[std::max(one, two)] = std::min(one, two);
    this->Turned[std::max(one, two)] = between;
    return true;
  }

private:
  std::vector<std::uint32_t> Parent;
  std::vector<bool> Turned; ///< turn against the parent; false for the first member of a set
};

/// Side of a triangle, from the lower to the higher of its two merged points.
struct Side
{
  std::uint32_t low, high, triangle;
  bool forth;                                    ///< true if the triangle runs from low to high
  std::pair<std::uint32_t, std::uint32_t> given; ///< the points as given, lower first
  std::uint32_t apex;
};

std::vector<Side> sidesOf(
  const std::vector<Triangle>& triangles, const std::vector<Triangle>& given)
{
  std::vector<Side> sides;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
  {
    for (std::size_t k = 0; k < 3; ++k)
    {
      const std::size_t next = (k + 1) % 3;
      const std::uint32_t a = triangles[t][k];
      const std::uint32_t b = triangles[t][next];
      sides.push_back({ std::min(a, b), std::max(a, b), t, a < b,
        std::minmax(given[t][k], given[t][next]), triangles[t][(k + 2) % 3] });
    }
  }
  std::sort(sides.begin(), sides.end(),
    [](const Side& a, const Side& b)
    {
      return std::tie(a.low, a.high, a.given, a.triangle) <
        std::tie(b.low, b.high, b.given, b.triangle);
    });
  return sides;
}

/// Pair sides by their angle about the edge. Pair coincident triangles only if unavoidable.
void pairByAngle(const std::vector<Vec3>& points, std::vector<Side>& sides)
{
  const Vec3 from = points[sides[0].low];
  const Vec3 along = unitVector(points[sides[0].high] - from);
  const auto across = [&](const Side& side)
  {
    const Vec3 to = points[side.apex] - from;
    return to - glm::dot(to, along) * along;
  };
  const Vec3 first = across(sides[0]);
  const Vec3 second = glm::cross(along, first);
  std::vector<std::pair<double, std::size_t>> angles;
  for (std::size_t i = 0; i < sides.size(); ++i)
  {
    const Vec3 v = across(sides[i]);
    angles.emplace_back(std::atan2(glm::dot(v, second), glm::dot(v, first)), i);
  }
  std::sort(angles.begin(), angles.end());
  const std::size_t count = angles.size();
  std::array<std::size_t, 2> coincident{};
  for (std::size_t i = 0; i < count; ++i)
  {
    const double between = angles[(i + 1) % count].first - angles[i].first;
    coincident[i % 2] += std::fabs(between) < 1e-9 || std::fabs(between) > 2.0 * Pi - 1e-9;
  }
  const std::size_t begin = coincident[0] <= coincident[1] ? 0 : 1;
  std::vector<Side> ordered;
  for (std::size_t i = 0; i < count; ++i)
  {
    ordered.push_back(sides[angles[(begin + i) % count].second]);
  }
  sides = std::move(ordered);
}

/// Order the sides of one edge in pairs, so that the two sides of each pair belong to one shell.
void pairSides(const std::vector<Vec3>& points, std::vector<Side>& sides)
{
  if (sides.size() == 2)
  {
    return;
  }
  std::vector<Side> pairs;
  std::vector<Side> left;
  for (std::size_t i = 0; i < sides.size();)
  {
    std::size_t end = i;
    while (end < sides.size() && sides[end].given == sides[i].given)
    {
      ++end;
    }
    std::vector<Side>& where = end - i == 2 ? pairs : left;
    where.insert(where.end(), sides.begin() + static_cast<std::ptrdiff_t>(i),
      sides.begin() + static_cast<std::ptrdiff_t>(end));
    i = end;
  }
  if (!left.empty())
  {
    pairByAngle(points, left);
  }
  pairs.insert(pairs.end(), left.begin(), left.end());
  sides = std::move(pairs);
}

/// Winding number, about a place, of a shell that faces outward: 1 inside, 1/2 on a face, else 0.
double windingOf(
  const std::vector<Vec3>& points, const std::vector<Triangle>& triangles, const Vec3& place)
{
  double sum = 0.0; // sum of solid angles (Van Oosterom and Strackee 1983)
  for (const Triangle& t : triangles)
  {
    const Vec3 a = points[t[0]] - place;
    const Vec3 b = points[t[1]] - place;
    const Vec3 c = points[t[2]] - place;
    const double x = glm::length(a);
    const double y = glm::length(b);
    const double z = glm::length(c);
    const double down = x * y * z + glm::dot(a, b) * z + glm::dot(b, c) * x + glm::dot(c, a) * y;
    const double up = glm::dot(a, glm::cross(b, c));
    constexpr double rounding = 1e-12;
    if (std::fabs(up) <= rounding * x * y * z && down <= rounding * x * y * z)
    {
      return 0.5;
    }
    sum += 2.0 * std::atan2(up, down);
  }
  return sum / (4.0 * Pi);
}

struct Shell
{
  std::vector<Triangle> triangles; ///< triangles facing outward
  Vec3 low{ Infinity };
  Vec3 high{ -Infinity };
  double volume = 0.0; ///< volume, m3
  double given = 0.0;  ///< signed volume as the triangles were wound, m3

  /// How the triangles were wound: 1 outward, -1 inward, 0 both ways.
  int wound() const
  {
    const double most = (1.0 - 1e-9) * this->volume;
    return this->given >= most ? 1 : (this->given <= -most ? -1 : 0);
  }
};

/// True if no part of a shell lies outside another shell, and most of the first shell is not in the
/// faces of the second shell.
bool isInside(const std::vector<Vec3>& points, const Shell& one, const Shell& other)
{
  if (glm::any(glm::lessThan(one.low, other.low)) ||
    glm::any(glm::greaterThan(one.high, other.high)))
  {
    return false;
  }
  const std::size_t step = std::max<std::size_t>(one.triangles.size() / 32, 1);
  int amid = 0; // triangles amid the other shell, less triangles in its faces
  for (std::size_t i = 0; i < one.triangles.size(); i += step)
  {
    const Triangle& t = one.triangles[i];
    const Vec3 middle = (points[t[0]] + points[t[1]] + points[t[2]]) / 3.0;
    const double winding = windingOf(points, other.triangles, middle);
    if (winding < 0.25)
    {
      return false;
    }
    amid += winding > 0.75 ? 1 : -1;
  }
  return amid > 0;
}

/// Turn the holes, which are wound against the smallest shell about them.
void turnHoles(const std::vector<Vec3>& points, std::vector<Shell>& shells)
{
  std::vector<std::size_t> order(shells.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&](std::size_t a, std::size_t b) { return shells[a].volume > shells[b].volume; });
  std::vector<bool> turned(shells.size(), false);
  for (std::size_t i = 1; i < order.size(); ++i)
  {
    const Shell& shell = shells[order[i]];
    for (std::size_t k = i; k-- > 0 && shell.wound() != 0;)
    {
      const Shell& about = shells[order[k]];
      if (about.wound() != 0 && isInside(points, shell, about))
      {
        turned[order[i]] = turned[order[k]] != (about.wound() != shell.wound());
        break;
      }
    }
  }
  for (std::size_t i = 0; i < shells.size(); ++i)
  {
    if (turned[i])
    {
      std::vector<Triangle>& triangles = shells[i].triangles;
      std::transform(triangles.begin(), triangles.end(), triangles.begin(), turnedOver);
    }
  }
}
}

TriangleMesh closedShells(const TriangleMesh& mesh, std::string& problem)
{
  // Corners with equal coordinates become one point.
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<std::uint32_t> merged;
  std::vector<Vec3> points;
  for (const Vec3& p : mesh.points)
  {
    if (!isFinite(p))
    {
      problem = "has a point that is not finite, expected a closed surface";
      return {};
    }
    const auto [at, isNew] =
      known.insert({ { p.x, p.y, p.z }, static_cast<std::uint32_t>(points.size()) });
    merged.push_back(at->second);
    if (isNew)
    {
      points.push_back(p);
    }
  }
  std::vector<Triangle> triangles;
  std::vector<Triangle> given;
  for (const Triangle& t : mesh.triangles)
  {
    const Triangle m{ merged[t[0]], merged[t[1]], merged[t[2]] };
    if (m[0] != m[1] && m[1] != m[2] && m[2] != m[0])
    {
      triangles.push_back(m);
      given.push_back(t);
    }
  }

  const std::vector<Side> sides = sidesOf(triangles, given);
  JoinedSets joined(triangles.size());
  std::size_t odd = 0;
  bool isOrientable = true;
  for (std::size_t i = 0; i < sides.size();)
  {
    const Side& first = sides[i];
    std::vector<Side> edge;
    for (; i < sides.size() && sides[i].low == first.low && sides[i].high == first.high; ++i)
    {
      edge.push_back(sides[i]);
    }
    if (edge.size() % 2 != 0)
    {
      ++odd;
      continue;
    }
    pairSides(points, edge);
    for (std::size_t k = 0; k < edge.size(); k += 2)
    {
      isOrientable &=
        joined.join(edge[k].triangle, edge[k + 1].triangle, edge[k].forth == edge[k + 1].forth);
    }
  }
  if (odd > 0 || triangles.empty())
  {
    problem = "has " + std::to_string(odd) +
      " edges with one triangle (or another odd number), and " + std::to_string(triangles.size()) +
      " triangles, expected a closed surface";
    return {};
  }
  if (!isOrientable)
  {
    problem = "has one side only, as a Klein bottle has, expected a closed surface";
    return {};
  }

  std::map<std::uint32_t, std::size_t> numbers;
  std::vector<Shell> shells;
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
  {
    const auto [first, turned] = joined.find(i);
    const std::size_t number = numbers.insert({ first, shells.size() }).first->second;
    shells.resize(std::max(shells.size(), number + 1));
    Shell& shell = shells[number];
    const Triangle& t = triangles[i];
    const Vec3& about = points[triangles[first][0]];
    const double volume =
      glm::dot(points[t[0]] - about, glm::cross(points[t[1]] - about, points[t[2]] - about)) / 6.0;
    shell.given += volume;
    shell.volume += turned ? -volume : volume;
    shell.triangles.push_back(turned ? turnedOver(t) : t);
    for (const std::uint32_t corner : t)
    {
      shell.low = glm::min(shell.low, points[corner]);
      shell.high = glm::max(shell.high, points[corner]);
    }
  }
  for (Shell& shell : shells)
  {
    if (shell.volume < 0.0)
    {
      shell.volume = -shell.volume;
      std::transform(
        shell.triangles.begin(), shell.triangles.end(), shell.triangles.begin(), turnedOver);
    }
  }
  turnHoles(points, shells);

  TriangleMesh result;
  result.points = std::move(points);
  for (const Shell& shell : shells)
  {
    result.triangles.insert(result.triangles.end(), shell.triangles.begin(), shell.triangles.end());
  }
  return result;
}
}
