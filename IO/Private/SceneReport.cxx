// SPDX-License-Identifier: BSD-3-Clause
#include "SceneReport.h"

#include "Vector.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace avianlidar::scene
{
namespace
{
constexpr double FarAway = 1e5;
// Area of a degenerate triangle, as a share of the square of the longest edge.
constexpr double DegenerateArea = 1e-12;

using glm::cross;
using glm::dot;
using Vector = glm::dvec3;

Vector CornerOf(const Mesh& mesh, std::int64_t point)
{
  const Vec3& p = mesh.points[point];
  return { p[0], p[1], p[2] };
}

bool IsDegenerate(const Vector& a, const Vector& b, const Vector& c)
{
  const Vector e0 = b - a, e1 = c - b, e2 = a - c;
  const Vector n = cross(e0, e2);
  const double longest = std::max({ dot(e0, e0), dot(e1, e1), dot(e2, e2) });
  return std::sqrt(dot(n, n)) <= DegenerateArea * longest;
}

// Returns whether a half-line meets a triangle.
bool Meets(
  const Vector& start, const Vector& direction, const Vector& a, const Vector& b, const Vector& c)
{
  const Vector e1 = b - a, e2 = c - a, h = cross(direction, e2);
  const double determinant = dot(e1, h);
  if (determinant == 0)
  {
    return false;
  }
  const Vector s = start - a, q = cross(s, e1);
  const double u = dot(s, h) / determinant, v = dot(direction, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && dot(e2, q) / determinant > 0;
}

// Directions up, down and sideways, a little askew so that edges of rectangular buildings are not
// along a direction.
const Vector Directions[6] = { { 0.00137, 0.00211, 1 }, { 0.00137, 0.00211, -1 },
  { 1, 0.0131, 0.0071 }, { -1, 0.0131, 0.0071 }, { 0.0113, 1, 0.0073 }, { 0.0113, -1, 0.0073 } };

std::array<int, 6> CountSurfaces(const Mesh& mesh, const Vector& start)
{
  std::array<int, 6> counts{};
  for (const auto& t : mesh.triangles)
  {
    for (int i = 0; i < 6; ++i)
    {
      counts[i] += Meets(
        start, Directions[i], CornerOf(mesh, t[0]), CornerOf(mesh, t[1]), CornerOf(mesh, t[2]));
    }
  }
  return counts;
}
}

void ReportExtents(BuiltScene& built)
{
  std::vector<std::string> distant;
  for (const Part& part : built.parts)
  {
    Vector low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    std::size_t degenerate = 0;
    for (const auto& t : part.mesh.triangles)
    {
      const Vector corners[] = { CornerOf(part.mesh, t[0]), CornerOf(part.mesh, t[1]),
        CornerOf(part.mesh, t[2]) };
      for (const Vector& corner : corners)
      {
        low = min(low, corner);
        high = max(high, corner);
      }
      degenerate += IsDegenerate(corners[0], corners[1], corners[2]);
    }
    char text[256];
    std::snprintf(text, sizeof text,
      ": %zu triangles, %zu degenerate, east %.2f to %.2f, north %.2f to %.2f, up %.2f to %.2f m",
      part.mesh.triangles.size(), degenerate, low[0], high[0], low[1], high[1], low[2], high[2]);
    built.report.push_back(part.name + text);
    if (degenerate > 0 && degenerate == part.mesh.triangles.size())
    {
      built.warnings.push_back(part.name + ": all " + std::to_string(degenerate) +
        " triangles are points or lines, which no ray meets: is the scale wrong?");
    }
    for (int i = 0; i < 3; ++i)
    {
      if (std::max(-low[i], high[i]) > FarAway && (distant.empty() || distant.back() != part.name))
      {
        distant.push_back(part.name);
      }
    }
  }
  if (!distant.empty())
  {
    built.warnings.push_back(distant.front() +
      (distant.size() > 1 ? " and " + std::to_string(distant.size() - 1) + " more objects reach"
                          : " reaches") +
      " more than 100 km from the origin: is the position, the scale or the crs wrong?");
  }
}

void ReportLidar(BuiltScene& built)
{
  const Scene& scene = built.description;
  if (!scene.lidar || built.parts.empty())
  {
    return;
  }
  const Vector lidar((*scene.lidar)[0], (*scene.lidar)[1], (*scene.lidar)[2]);
  int above = 0, below = 0;
  std::string container;
  for (const Part& part : built.parts)
  {
    const std::array<int, 6> counts = CountSurfaces(part.mesh, lidar);
    above += counts[0];
    below += counts[1];
    if (std::all_of(counts.begin(), counts.end(), [](int count) { return count % 2 == 1; }))
    {
      container = part.name;
    }
  }
  built.report.push_back("lidar: " + std::to_string(above) + " surfaces above, " +
    std::to_string(below) + " below" +
    (container.empty() ? std::string() : ", inside " + container));
  if (!container.empty() && !scene.lidarInside)
  {
    built.warnings.push_back("the lidar is inside " + container +
      ": if the position is right, add \"inside\": true to the lidar");
  }
  else if (above > 0 && below == 0)
  {
    built.warnings.push_back(
      "the lidar is under the scene: surfaces lie above the lidar, but not below the lidar");
  }
}
}
