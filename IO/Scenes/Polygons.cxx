// SPDX-License-Identifier: BSD-3-Clause
#include "Polygons.h"

#include "PolygonTriangulation.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

namespace avianlidar::scene
{
namespace
{
// Length of edges that are removed, m. Maps do not resolve such edges, which only make slivers.
constexpr double SmallestEdge = 1e-6;

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

// Leaves out rings of fewer than three vertices. The result is empty without an outer ring.
Polygon WithoutRepeats(const Polygon& polygon)
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
  return clean;
}

double AreaOf(const Geos& geos, const GEOSGeometry* geometry)
{
  double area = 0;
  GEOSArea_r(geos.Get(), geometry, &area);
  return area;
}

// Returns whether a hole has an area, and none of it lies in the outline.
bool IsOutside(const Geos& geos, const GEOSGeometry* hole, const GEOSGeometry* outline)
{
  return AreaOf(geos, hole) > 0 &&
    AreaOf(geos, geos.Own(GEOSIntersection_r(geos.Get(), hole, outline)).get()) == 0;
}

// Exchanges the first ring with a ring around it, which is the outline.
void PutOutlineFirst(const Geos& geos, std::vector<Geos::Geometry>& rings)
{
  for (Geos::Geometry& ring : rings)
  {
    if (AreaOf(geos, ring.get()) > AreaOf(geos, rings[0].get()) &&
      GEOSContains_r(geos.Get(), ring.get(), rings[0].get()) == 1)
    {
      std::swap(ring, rings[0]);
    }
  }
}

// Returns the geometries, equal ones once. Two equal rings would leave nothing of each other.
std::vector<Geos::Geometry> WithoutEqual(const Geos& geos, std::vector<Geos::Geometry> all)
{
  std::vector<Geos::Geometry> kept;
  std::vector<double> areas;
  for (Geos::Geometry& one : all)
  {
    const double area = AreaOf(geos, one.get());
    bool isNew = true;
    for (std::size_t i = 0; i < kept.size() && isNew; ++i)
    {
      isNew = std::abs(areas[i] - area) > 1e-9 * area ||
        GEOSEquals_r(geos.Get(), kept[i].get(), one.get()) != 1;
    }
    if (isNew)
    {
      kept.push_back(std::move(one));
      areas.push_back(area);
    }
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

std::vector<Polygon> MakeValid(
  const std::vector<Polygon>& polygons, bool areNested, Repairs& repairs)
{
  const Geos geos;
  std::vector<Polygon> clean;
  for (const Polygon& polygon : polygons)
  {
    Polygon one = WithoutRepeats(polygon);
    if (!one.rings.empty())
    {
      clean.push_back(std::move(one));
    }
  }
  if (clean.empty() || geos.IsValid(clean))
  {
    return clean;
  }
  repairs.isRepaired = true;
  std::vector<Geos::Geometry> parts;
  for (const Polygon& polygon : clean)
  {
    std::vector<Geos::Geometry> rings;
    for (const Ring& ring : polygon.rings)
    {
      std::vector<Polygon> areas; // without the lines that GEOS adds
      geos.Collect(
        geos.Own(GEOSMakeValid_r(geos.Get(), geos.MakePolygon({ { ring } }).get())).get(), areas);
      rings.push_back(geos.MakeMultiPolygon(areas));
    }
    if (!areNested && rings.size() > 1)
    {
      PutOutlineFirst(geos, rings);
      const Geos::Geometry shell = std::move(rings[0]);
      repairs.strayHoles += static_cast<int>(std::count_if(rings.begin() + 1, rings.end(),
        [&](const Geos::Geometry& hole) { return IsOutside(geos, hole.get(), shell.get()); }));
      const Geos::Geometry holes = geos.Combine(&GEOSUnion_r, rings.begin() + 1, rings.end());
      rings.clear();
      rings.push_back(geos.Own(GEOSDifference_r(geos.Get(), shell.get(), holes.get())));
    }
    std::move(rings.begin(), rings.end(), std::back_inserter(parts));
  }
  if (areNested)
  {
    parts = WithoutEqual(geos, std::move(parts));
  }
  std::vector<Polygon> valid;
  geos.Collect(
    geos.Combine(areNested ? &GEOSSymDifference_r : &GEOSUnion_r, parts.begin(), parts.end()).get(),
    valid);
  return valid;
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
  std::vector<glm::dvec3> corners;
  std::vector<std::size_t> ends;
  for (std::size_t r = 0; r < polygon.rings.size(); ++r)
  {
    Ring ring = polygon.rings[r];
    if ((SignedArea(ring) > 0) != (r == 0))
    {
      std::reverse(ring.begin(), ring.end());
    }
    for (const Vec2& p : ring)
    {
      corners.emplace_back(p[0], p[1], 0.0);
    }
    ends.push_back(corners.size());
  }
  PolygonTriangulation triangulation;
  triangulation.Divide(corners, ends);
  failIf(!triangulation.IsWhole(0.0), "a polygon of ", triangulation.GetOutlineArea(),
    " m2 has rings that cross or overlap");
  corners.insert(corners.end(), triangulation.GetAdded().begin(), triangulation.GetAdded().end());
  // Rings share the vertices at which they touch.
  Sheet sheet;
  std::map<Vec2, std::int64_t> index;
  std::vector<std::int64_t> ids;
  for (const glm::dvec3& p : corners)
  {
    const auto inserted =
      index.emplace(Vec2{ p.x, p.y }, static_cast<std::int64_t>(sheet.points.size()));
    if (inserted.second)
    {
      sheet.points.push_back({ p.x, p.y, 0.0 });
    }
    ids.push_back(inserted.first->second);
  }
  for (const auto& [a, b, c] : triangulation.GetTriangles())
  {
    sheet.triangles.push_back({ ids[a], ids[b], ids[c] });
  }
  AddOutline(sheet);
  return sheet;
}

void AddOutline(Sheet& sheet)
{
  using Edge = std::array<std::int64_t, 2>;
  std::set<Edge> edges;
  for (const auto& [a, b, c] : sheet.triangles)
  {
    for (const Edge& edge : { Edge{ a, b }, Edge{ b, c }, Edge{ c, a } })
    {
      if (edges.erase({ edge[1], edge[0] }) == 0)
      {
        edges.insert(edge);
      }
    }
  }
  sheet.outline.assign(edges.begin(), edges.end());
}
}
