// SPDX-License-Identifier: BSD-3-Clause
#include "Polygons.h"

#include "SceneTypes.h"

#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>

namespace avianlidar::scene
{
namespace
{
// Below what any map resolves; such edges only make slivers.
constexpr double SmallestEdge = 1e-6;
constexpr double AreaTolerance = 1e-9;
constexpr double SmallestPiece = 1e-6; // m2
constexpr double SmallestWidth = 1e-4; // m, below which vertices of pieces are one

// Without handlers GEOS keeps silent and returns null.
class Geos
{
public:
  using Geometry = std::unique_ptr<GEOSGeometry, std::function<void(GEOSGeometry*)>>;

  Geos()
    : Handle(GEOS_init_r(), &GEOS_finish_r)
  {
  }
  GEOSContextHandle_t Get() const { return this->Handle.get(); }

  Geometry Own(GEOSGeometry* geometry) const
  {
    if (!geometry)
    {
      throw Error("the polygon library GEOS cannot handle this geometry");
    }
    return Geometry(geometry, [this](GEOSGeometry* g) { GEOSGeom_destroy_r(this->Get(), g); });
  }

  GEOSCoordSequence* Sequence(const Ring& ring, bool close) const
  {
    const auto n = static_cast<unsigned int>(ring.size());
    GEOSCoordSequence* sequence = GEOSCoordSeq_create_r(this->Get(), n + close, 2);
    for (unsigned int i = 0; i < n + close; ++i)
    {
      const Vec2& p = ring[i % n];
      GEOSCoordSeq_setXY_r(this->Get(), sequence, i, p[0], p[1]);
    }
    return sequence;
  }

  Geometry MakePolygon(const Polygon& polygon) const
  {
    std::vector<GEOSGeometry*> rings;
    for (const Ring& ring : polygon.rings)
    {
      rings.push_back(GEOSGeom_createLinearRing_r(this->Get(), this->Sequence(ring, true)));
    }
    return this->Own(GEOSGeom_createPolygon_r(
      this->Get(), rings[0], rings.data() + 1, static_cast<unsigned int>(rings.size() - 1)));
  }

  Ring GetRing(const GEOSGeometry* ring) const
  {
    const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(this->Get(), ring);
    unsigned int n = 0;
    GEOSCoordSeq_getSize_r(this->Get(), sequence, &n);
    Ring points(n > 0 ? n - 1 : 0);
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      GEOSCoordSeq_getXY_r(
        this->Get(), sequence, static_cast<unsigned int>(i), &points[i][0], &points[i][1]);
    }
    return points;
  }

  // Every polygon of a geometry, whatever it is nested in.
  void Collect(const GEOSGeometry* geometry, std::vector<Polygon>& polygons) const
  {
    if (GEOSGeomTypeId_r(this->Get(), geometry) == GEOS_POLYGON)
    {
      if (GEOSisEmpty_r(this->Get(), geometry))
      {
        return;
      }
      Polygon polygon;
      polygon.rings.push_back(this->GetRing(GEOSGetExteriorRing_r(this->Get(), geometry)));
      const int holes = GEOSGetNumInteriorRings_r(this->Get(), geometry);
      for (int i = 0; i < holes; ++i)
      {
        polygon.rings.push_back(this->GetRing(GEOSGetInteriorRingN_r(this->Get(), geometry, i)));
      }
      polygons.push_back(std::move(polygon));
      return;
    }
    const int parts = GEOSGetNumGeometries_r(this->Get(), geometry);
    for (int i = 0; i < parts; ++i)
    {
      const GEOSGeometry* part = GEOSGetGeometryN_r(this->Get(), geometry, i);
      if (part != geometry)
      {
        this->Collect(part, polygons);
      }
    }
  }

private:
  std::unique_ptr<GEOSContextHandle_HS, decltype(&GEOS_finish_r)> Handle;
};

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

void CollectTriangles(const std::vector<Polygon>& pieces, const std::map<Vec2, std::size_t>& index,
  TriangulatedPolygon& result)
{
  for (const Polygon& piece : pieces)
  {
    Ring corners = piece.rings[0];
    if (SignedArea(corners) < 0)
    {
      std::reverse(corners.begin(), corners.end());
    }
    std::array<std::size_t, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i)
    {
      triangle[i] = index.at(corners.at(i));
    }
    result.triangles.push_back(triangle);
  }
}
}

double SignedArea(const Ring& ring)
{
  // About the first vertex: far from the origin the products would cancel.
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

double Area(const TriangulatedPolygon& polygon)
{
  double area = 0;
  for (const auto& t : polygon.triangles)
  {
    area += SignedArea({ polygon.points[t[0]], polygon.points[t[1]], polygon.points[t[2]] });
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
  // A closed line comes without its last vertex twice, and is closed again.
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

std::vector<std::vector<Polygon>> CutToTriangles(
  const Polygon& polygon, const std::vector<Ring>& triangles)
{
  const Geos geos;
  const Geos::Geometry whole = geos.MakePolygon(polygon);
  const std::unique_ptr<const GEOSPreparedGeometry,
    std::function<void(const GEOSPreparedGeometry*)>>
    prepared(GEOSPrepare_r(geos.Get(), whole.get()),
      [&geos](const GEOSPreparedGeometry* p) { GEOSPreparedGeom_destroy_r(geos.Get(), p); });
  std::vector<std::vector<Polygon>> pieces(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
  {
    const Geos::Geometry triangle = geos.MakePolygon({ { triangles[i] } });
    if (GEOSPreparedContainsProperly_r(geos.Get(), prepared.get(), triangle.get()) == 1)
    {
      pieces[i].push_back({ { triangles[i] } });
      continue;
    }
    if (GEOSPreparedIntersects_r(geos.Get(), prepared.get(), triangle.get()) == 0)
    {
      continue;
    }
    std::vector<Polygon> shared;
    geos.Collect(
      geos.Own(GEOSIntersection_r(geos.Get(), whole.get(), triangle.get())).get(), shared);
    for (const Polygon& part : shared)
    {
      bool repaired = false;
      for (Polygon& piece : MakeValid(part, repaired))
      {
        if (Area(piece) > std::max(SmallestPiece, SmallestWidth * Perimeter(piece) / 2))
        {
          pieces[i].push_back(std::move(piece));
        }
      }
    }
  }
  return pieces;
}

TriangulatedPolygon Triangulate(const Polygon& polygon)
{
  TriangulatedPolygon result;
  std::map<Vec2, std::size_t> index;
  for (std::size_t r = 0; r < polygon.rings.size(); ++r)
  {
    Ring ring = polygon.rings[r];
    if ((SignedArea(ring) > 0) != (r == 0))
    {
      std::reverse(ring.begin(), ring.end());
    }
    result.rings.emplace_back();
    for (const Vec2& p : ring)
    {
      const auto inserted = index.emplace(p, result.points.size());
      if (inserted.second)
      {
        result.points.push_back(p);
      }
      result.rings.back().push_back(inserted.first->second);
    }
  }
  const Geos geos;
  const Geos::Geometry geometry = geos.MakePolygon(polygon);
  std::vector<Polygon> pieces;
  geos.Collect(
    geos.Own(GEOSConstrainedDelaunayTriangulation_r(geos.Get(), geometry.get())).get(), pieces);
  CollectTriangles(pieces, index, result);
  const double area = Area(polygon);
  // Of a long narrow polygon the products of an area are far above it, and so is their rounding.
  const double rounding =
    4 * std::numeric_limits<double>::epsilon() * std::pow(Perimeter(polygon), 2);
  if (!(std::abs(Area(result) - area) <= AreaTolerance * area + rounding))
  {
    throw Error("a polygon of " + std::to_string(area) + " m2 cannot be triangulated");
  }
  return result;
}
}
