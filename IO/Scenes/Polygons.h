// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Polygons.h
 * @brief Plane polygons with holes: repairs polygons and widens lines with GEOS, and makes
 * triangles.
 *
 * Coordinates are in metres. Walls are raised on the edges of the triangles, so that walls meet the
 * roof in whole edges.
 */
#ifndef AvianLidarPolygons_h
#define AvianLidarPolygons_h

#include "SceneTypes.h"

#include <geos_c.h>

#include <functional>
#include <memory>

namespace avianlidar::scene
{
using Vec2 = std::array<double, 2>;
/// Vertices in order. The first vertex is not repeated at the end.
using Ring = std::vector<Vec2>;

/// Polygon of one outer ring, which comes first, and the rings of its holes.
struct Polygon
{
  std::vector<Ring> rings;
};

/// Triangles that run anticlockwise in plan, and the edges of their outline. The triangles are on
/// the left of each edge.
struct Sheet
{
  std::vector<Point3> points;
  std::vector<std::array<std::int64_t, 3>> triangles;
  std::vector<std::array<std::int64_t, 2>> outline;
};

/// Context of GEOS. The context does not have handlers, so GEOS does not print errors. GEOS returns
/// null on failure.
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
    failIf(!geometry, "the polygon library GEOS cannot handle this geometry");
    return Geometry(geometry, [this](GEOSGeometry* g) { GEOSGeom_destroy_r(this->Get(), g); });
  }

  GEOSCoordSequence* Sequence(const Ring& ring, bool close) const
  {
    Ring all(ring);
    if (close && !ring.empty())
    {
      all.push_back(ring.front());
    }
    return GEOSCoordSeq_copyFromBuffer_r(
      this->Get(), all.data()->data(), static_cast<unsigned int>(all.size()), 0, 0);
  }

  Geometry MakePolygon(const Polygon& polygon) const
  {
    failIf(polygon.rings.empty() || polygon.rings[0].empty(), "a polygon has no points");
    std::vector<GEOSGeometry*> rings;
    for (const Ring& ring : polygon.rings)
    {
      rings.push_back(GEOSGeom_createLinearRing_r(this->Get(), this->Sequence(ring, true)));
    }
    return this->Own(GEOSGeom_createPolygon_r(
      this->Get(), rings[0], rings.data() + 1, static_cast<unsigned int>(rings.size() - 1)));
  }

  Geometry MakeMultiPolygon(const std::vector<Polygon>& polygons) const
  {
    std::vector<Geometry> made;
    for (const Polygon& polygon : polygons)
    {
      made.push_back(this->MakePolygon(polygon));
    }
    std::vector<GEOSGeometry*> parts;
    for (Geometry& part : made)
    {
      parts.push_back(part.release());
    }
    return this->Own(GEOSGeom_createCollection_r(
      this->Get(), GEOS_MULTIPOLYGON, parts.data(), static_cast<unsigned int>(parts.size())));
  }

  /// Combines one or more geometries by an operation on two, such as GEOSUnion_r(). Halves are
  /// combined first, because an operation takes longer on a geometry that has grown.
  using Operation = GEOSGeometry*(GEOSContextHandle_t, const GEOSGeometry*, const GEOSGeometry*);
  Geometry Combine(Operation* operation, std::vector<Geometry>::iterator begin,
    std::vector<Geometry>::iterator end) const
  {
    if (end - begin == 1)
    {
      return std::move(*begin);
    }
    const auto middle = begin + (end - begin) / 2;
    const Geometry first = this->Combine(operation, begin, middle);
    const Geometry second = this->Combine(operation, middle, end);
    return this->Own(operation(this->Get(), first.get(), second.get()));
  }

  /// Returns whether polygons are valid, and do not overlap.
  bool IsValid(const std::vector<Polygon>& polygons) const
  {
    const Geometry all =
      polygons.size() == 1 ? this->MakePolygon(polygons[0]) : this->MakeMultiPolygon(polygons);
    return GEOSisValid_r(this->Get(), all.get()) == 1;
  }

  Ring GetRing(const GEOSGeometry* ring) const
  {
    const GEOSCoordSequence* sequence = GEOSGeom_getCoordSeq_r(this->Get(), ring);
    unsigned int n = 0;
    GEOSCoordSeq_getSize_r(this->Get(), sequence, &n);
    failIf(n == 0, "the polygon library GEOS gave a ring without points");
    Ring points(n);
    GEOSCoordSeq_copyToBuffer_r(this->Get(), sequence, points.data()->data(), 0, 0);
    points.pop_back();
    return points;
  }

  /// Appends every polygon of a geometry, including polygons of nested collections.
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

/// Returns the area of a ring, m2, positive if the ring runs anticlockwise, else negative.
double SignedArea(const Ring& ring);
/// Returns the area of the outer ring minus the areas of the holes, m2.
double Area(const Polygon& polygon);

/// What MakeValid() has repaired.
struct Repairs
{
  bool isRepaired = false; ///< whether more changes than repeated vertices
  int strayHoles = 0;      ///< number of holes outside their outlines, which are left out
};

/**
 * Returns valid polygons for the region of `polygons`, without repeated vertices and without
 * crossing or overlapping rings. The result is empty if no region with an area is left.
 *
 * Each ring is made valid alone (GEOS MakeValid), because GEOS fills some holes that share edges.
 * Polygons that overlap are united. Equal nested polygons count once.
 * @param areNested true if a place inside an even number of all rings is outside: GDAL takes some
 * holes of OpenStreetMap that share edges for islands
 */
std::vector<Polygon> MakeValid(
  const std::vector<Polygon>& polygons, bool areNested, Repairs& repairs);

/// Returns the region within half of `width`, m, of a line, with flat ends and mitred corners.
std::vector<Polygon> WidenLine(const Ring& line, double width);

/// Triangulates a valid polygon at the height 0 (PolygonTriangulation.h). An edge is divided where
/// another ring touches it. Throws Error if the area of the triangles differs from the area of the
/// polygon.
Sheet Triangulate(const Polygon& polygon);

/// Finds the outline of a sheet: the edges of only one triangle.
void AddOutline(Sheet& sheet);

double Perimeter(const Polygon& polygon);
}

#endif
