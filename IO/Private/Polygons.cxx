// SPDX-License-Identifier: BSD-3-Clause
#include "Polygons.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace avianlidar::scene
{
namespace
{
// Length of edges that are removed, m. Maps do not resolve such edges, which only make slivers.
constexpr double SmallestEdge = 1e-6;
constexpr double AreaTolerance = 1e-9;

Ring WithoutRepeats(const Ring& ring)
{
  Ring kept;
  for (const Vec2& p : ring)
  {
    if (kept.empty() || std::hypot(p[0] - kept.back()[0], p[1] - kept.back()[1]) > SmallestEdge)
    {
      kept.push_back(p);
    }
  }
  while (kept.size() > 1 &&
    std::hypot(kept.front()[0] - kept.back()[0], kept.front()[1] - kept.back()[1]) <= SmallestEdge)
  {
    kept.pop_back();
  }
  return kept;
}
}

double Perimeter(const Polygon& polygon)
{
  double length = 0;
  for (const Ring& ring : polygon.rings)
  {
    for (std::size_t i = 0; i < ring.size(); ++i)
    {
      const Vec2& next = ring[(i + 1) % ring.size()];
      length += std::hypot(next[0] - ring[i][0], next[1] - ring[i][1]);
    }
  }
  return length;
}

double SignedArea(const Ring& ring)
{
  // Coordinates are relative to the first vertex, because large products would cancel.
  double sum = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i)
  {
    sum += (ring[i][0] - ring[0][0]) * (ring[i + 1][1] - ring[0][1]) -
      (ring[i + 1][0] - ring[0][0]) * (ring[i][1] - ring[0][1]);
  }
  return 0.5 * sum;
}

double Area(const Polygon& polygon)
{
  double area = 0;
  for (std::size_t i = 0; i < polygon.rings.size(); ++i)
  {
    area += (i == 0 ? 1 : -1) * std::abs(SignedArea(polygon.rings[i]));
  }
  return area;
}

std::vector<Polygon> MakeValid(const Polygon& polygon, bool& repaired)
{
  Polygon clean;
  for (std::size_t i = 0; i < polygon.rings.size(); ++i)
  {
    Ring ring = WithoutRepeats(polygon.rings[i]);
    if (ring.size() >= 3)
    {
      clean.rings.push_back(std::move(ring));
    }
    else if (i == 0)
    {
      return {};
    }
  }
  if (clean.rings.empty())
  {
    return {};
  }
  const Geos geos;
  const Geos::Geometry geometry = geos.MakePolygon(clean);
  if (GEOSisValid_r(geos.Get(), geometry.get()) == 1)
  {
    return { clean };
  }
  repaired = true;
  std::vector<Polygon> polygons;
  geos.Collect(geos.Own(GEOSMakeValid_r(geos.Get(), geometry.get())).get(), polygons);
  return polygons;
}

std::vector<Polygon> WidenLine(const Ring& line, double width)
{
  const Ring clean = WithoutRepeats(line);
  if (clean.size() < 2)
  {
    return {};
  }
  const Geos geos;
  // WithoutRepeats() removes the last vertex of a closed line, and Sequence() adds it again.
  const bool closed = line.size() > 2 && line.front() == line.back();
  const Geos::Geometry geometry =
    geos.Own(GEOSGeom_createLineString_r(geos.Get(), geos.Sequence(clean, closed)));
  const double mitreLimit = 5;
  const Geos::Geometry region = geos.Own(GEOSBufferWithStyle_r(
    geos.Get(), geometry.get(), width / 2, 4, GEOSBUF_CAP_FLAT, GEOSBUF_JOIN_MITRE, mitreLimit));
  std::vector<Polygon> polygons;
  geos.Collect(region.get(), polygons);
  return polygons;
}

Sheet Triangulate(const Polygon& polygon)
{
  Sheet sheet;
  std::map<Vec2, std::int64_t> index;
  for (std::size_t r = 0; r < polygon.rings.size(); ++r)
  {
    Ring ring = polygon.rings[r];
    if ((SignedArea(ring) > 0) != (r == 0))
    {
      std::reverse(ring.begin(), ring.end());
    }
    std::vector<std::int64_t> ids;
    for (const Vec2& p : ring)
    {
      const auto inserted = index.emplace(p, static_cast<std::int64_t>(sheet.points.size()));
      if (inserted.second)
      {
        sheet.points.push_back({ p[0], p[1], 0.0 });
      }
      ids.push_back(inserted.first->second);
    }
    for (std::size_t i = 0; i < ids.size(); ++i)
    {
      sheet.outline.push_back({ ids[i], ids[(i + 1) % ids.size()] });
    }
  }
  const Geos geos;
  const Geos::Geometry geometry = geos.MakePolygon(polygon);
  std::vector<Polygon> pieces;
  geos.Collect(
    geos.Own(GEOSConstrainedDelaunayTriangulation_r(geos.Get(), geometry.get())).get(), pieces);
  double covered = 0;
  for (const Polygon& piece : pieces)
  {
    Ring corners = piece.rings[0];
    if (SignedArea(corners) < 0)
    {
      std::reverse(corners.begin(), corners.end());
    }
    sheet.triangles.push_back(
      { index.at(corners.at(0)), index.at(corners.at(1)), index.at(corners.at(2)) });
    covered += SignedArea({ corners[0], corners[1], corners[2] });
  }
  const double area = Area(polygon);
  // The products that make the area of a long narrow polygon are far larger than the area. Their
  // rounding is as large.
  const double rounding =
    4 * std::numeric_limits<double>::epsilon() * std::pow(Perimeter(polygon), 2);
  failIf(!(std::abs(covered - area) <= AreaTolerance * area + rounding), "a polygon of ",
    std::to_string(area), " m2 cannot be triangulated");
  return sheet;
}
}
