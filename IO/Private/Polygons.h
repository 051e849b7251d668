// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Polygons.h
 * @brief Plane polygons with holes: repair, lines with a width, triangles. A thin cover of GEOS.
 *
 * Coordinates in metres. Triangulation is GEOS's constrained Delaunay triangulation: it adds no
 * vertices and drops none, so walls raised on the same rings meet the roof in whole edges.
 */
#ifndef AvianLidarPolygons_h
#define AvianLidarPolygons_h

#include <array>
#include <cstddef>
#include <vector>

namespace avianlidar::scene
{
using Vec2 = std::array<double, 2>;
/// Vertices in order; the last is not the first again.
using Ring = std::vector<Vec2>;

/// One outer ring and the rings of its holes.
struct Polygon
{
  std::vector<Ring> rings;
};

/// A polygon whose outer ring runs anticlockwise and whose holes run clockwise, with triangles that
/// run anticlockwise.
struct TriangulatedPolygon
{
  std::vector<Vec2> points;
  std::vector<std::vector<std::size_t>> rings;
  std::vector<std::array<std::size_t, 3>> triangles;
};

/// Twice the signed area is the usual sum; positive where the ring runs anticlockwise.
double SignedArea(const Ring& ring);
/// Area of the outer ring less that of the holes.
double Area(const Polygon& polygon);
double Area(const TriangulatedPolygon& polygon);

/**
 * The same region as valid polygons: repeated vertices are dropped, crossing or overlapping rings
 * resolved (GEOS MakeValid). No polygon where nothing with an area is left. `repaired` is set where
 * more than vertices changed.
 */
std::vector<Polygon> MakeValid(const Polygon& polygon, bool& repaired);

/// The region within half a width of a line, with flat ends and mitred corners.
std::vector<Polygon> WidenLine(const Ring& line, double width);

/// What each of the triangles, which run anticlockwise, shares with a valid polygon, less what is
/// smaller than 1e-6 m2 or narrower than 1e-4 m (area over half the perimeter).
std::vector<std::vector<Polygon>> CutToTriangles(
  const Polygon& polygon, const std::vector<Ring>& triangles);

/// Triangles of a valid polygon. Throws Error if GEOS fails or the areas differ by more than 1e-9
/// of the whole and their rounding.
TriangulatedPolygon Triangulate(const Polygon& polygon);
}

#endif
