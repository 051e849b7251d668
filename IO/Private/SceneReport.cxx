// SPDX-License-Identifier: BSD-3-Clause
#include "SceneReport.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace avianlidar::scene
{
namespace
{
constexpr double FarAway = 1e5;
// Of the square of the longest edge.
constexpr double DegenerateArea = 1e-12;

Vec3 operator-(const Vec3& a, const Vec3& b)
{
  return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

Vec3 Cross(const Vec3& a, const Vec3& b)
{
  return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

double Dot(const Vec3& a, const Vec3& b)
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool IsDegenerate(const Vec3& a, const Vec3& b, const Vec3& c)
{
  const Vec3 e0 = b - a, e1 = c - b, e2 = a - c;
  const Vec3 n = Cross(e0, e2);
  const double longest = std::max({ Dot(e0, e0), Dot(e1, e1), Dot(e2, e2) });
  return std::sqrt(Dot(n, n)) <= DegenerateArea * longest;
}

struct Box
{
  Vec3 low{ std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
    std::numeric_limits<double>::max() };
  Vec3 high{ std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest(),
    std::numeric_limits<double>::lowest() };

  void Add(const Vec3& p)
  {
    for (int i = 0; i < 3; ++i)
    {
      this->low[i] = std::min(this->low[i], p[i]);
      this->high[i] = std::max(this->high[i], p[i]);
    }
  }
};

// Whether a half-line meets a triangle in front of its start.
bool Meets(const Vec3& start, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c)
{
  const Vec3 e1 = b - a, e2 = c - a, h = Cross(direction, e2);
  const double determinant = Dot(e1, h);
  if (determinant == 0)
  {
    return false;
  }
  const Vec3 s = start - a, q = Cross(s, e1);
  const double u = Dot(s, h) / determinant, v = Dot(direction, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && Dot(e2, q) / determinant > 0;
}

// Up, down and sideways, a little askew so that none runs along an edge of something built square.
constexpr Vec3 Directions[6] = { { 0.00137, 0.00211, 1 }, { 0.00137, 0.00211, -1 },
  { 1, 0.0131, 0.0071 }, { -1, 0.0131, 0.0071 }, { 0.0113, 1, 0.0073 }, { 0.0113, -1, 0.0073 } };

std::array<int, 6> CountSurfaces(const Mesh& mesh, const Vec3& start)
{
  std::array<int, 6> counts{};
  for (const auto& t : mesh.triangles)
  {
    for (int i = 0; i < 6; ++i)
    {
      counts[i] +=
        Meets(start, Directions[i], mesh.points[t[0]], mesh.points[t[1]], mesh.points[t[2]]);
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
    Box box;
    std::size_t degenerate = 0;
    for (const auto& t : part.mesh.triangles)
    {
      const Vec3 &a = part.mesh.points[t[0]], &b = part.mesh.points[t[1]],
                 &c = part.mesh.points[t[2]];
      box.Add(a);
      box.Add(b);
      box.Add(c);
      degenerate += IsDegenerate(a, b, c);
    }
    char text[256];
    std::snprintf(text, sizeof text,
      ": %zu triangles, %zu degenerate, east %.2f to %.2f, north %.2f to %.2f, up %.2f to %.2f m",
      part.mesh.triangles.size(), degenerate, box.low[0], box.high[0], box.low[1], box.high[1],
      box.low[2], box.high[2]);
    built.report.push_back(part.name + text);
    if (degenerate > 0 && degenerate == part.mesh.triangles.size())
    {
      built.warnings.push_back(part.name + ": all " + std::to_string(degenerate) +
        " triangles are points or lines, which no ray meets: is the scale wrong?");
    }
    for (int i = 0; i < 3; ++i)
    {
      if (std::max(-box.low[i], box.high[i]) > FarAway &&
        (distant.empty() || distant.back() != part.name))
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
  int above = 0, below = 0;
  std::string container;
  for (const Part& part : built.parts)
  {
    const std::array<int, 6> counts = CountSurfaces(part.mesh, *scene.lidar);
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
      "; say \"inside\": true beside its position if that is meant");
  }
  else if (above > 0 && below == 0)
  {
    built.warnings.push_back(
      "the lidar is under the scene: there are surfaces above it and none below");
  }
}
}
