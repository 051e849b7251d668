// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PolygonTriangulation.h
 * @brief Divides polygons with holes into triangles, for surfaces, mesh files and footprints. Not
 * installed.
 *
 * GLU's tessellator sweeps a line over the polygon and divides the region that an odd number of
 * rings surrounds. Rings may touch themselves and each other at corners and along edges: a VTK
 * polygon reaches its holes by a bridge of two edges (keyhole polygon), and outlines of GIS touch
 * themselves. VTK's ear cutting (vtkPolygon) and vtkContourTriangulator lose area of such polygons.
 * GEOS 3.11 cannot triangulate holes that meet at a point.
 *
 * Differs from GLU alone: the polygon is projected onto its mean plane and moved to the origin,
 * because GLU projects along an axis and loses area far from the origin. A quadrilateral is divided
 * along the shorter diagonal that lies inside. Edges of other polygons are flipped until the
 * triangles are Delaunay (Lawson 1977), because boxes of GLU's slivers are large. GLU takes
 * quadratic time if the line meets many edges: up to 0.5 min for 1e5 corners on a comb.
 */
#ifndef PolygonTriangulation_h
#define PolygonTriangulation_h

#include "Vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <vector>

class GLUtesselator;

namespace avianlidar
{
class PolygonTriangulation
{
public:
  using Triangle = std::array<std::int64_t, 3>;

  PolygonTriangulation();

  /**
   * Divides a polygon near a plane. The triangles turn in the sense of the first ring. A polygon
   * without area has no triangles. A polygon with a coordinate that is not finite becomes a fan.
   *
   * @param corners corners of all rings, m. Holes run against the sense of the outer ring.
   * @param ends for each ring, the index after its last corner
   */
  void Divide(const std::vector<Vec3>& corners, const std::vector<std::size_t>& ends);
  /// Divides a polygon of one ring.
  void Divide(const std::vector<Vec3>& corners) { this->Divide(corners, { corners.size() }); }

  /// Triangles, as indices of corners. Higher indices, from the number of corners on, are points of
  /// GetAdded().
  const std::vector<Triangle>& GetTriangles() const { return this->Triangles; }
  /// Points at which edges cross.
  const std::vector<Vec3>& GetAdded() const { return this->Added; }
  /// Area inside the rings if no ring crosses or overlaps another ring or itself, m2.
  double GetOutlineArea() const { return this->OutlineArea; }
  /// Area of the triangles in the mean plane, m2.
  double GetTriangleArea() const { return this->TriangleArea; }

  /// Largest coordinate of the corners, m.
  double GetLargest() const { return this->Largest; }

  /// Returns whether the triangles have the area of the outline, but for a millionth and rounding.
  /// @param rounding rounding of coordinates, m, if coarser than double precision
  bool IsWhole(double rounding) const;

private:
  bool Project(const std::vector<Vec3>& corners, const std::vector<std::size_t>& ends);
  bool DivideQuadrilateral();
  void Sweep(const std::vector<std::size_t>& ends);
  void FlipEdges();
  void AddPoint(const double* place, void* const* near, const float* weights, void** point);

  std::unique_ptr<GLUtesselator, void (*)(GLUtesselator*)> Tessellator;
  std::vector<Triangle> Triangles;
  std::vector<Vec3> Added;
  double OutlineArea = 0.0;
  double TriangleArea = 0.0;
  double Perimeter = 0.0;         ///< length of all rings, m
  double Largest = 0.0;           ///< largest coordinate, m
  Vec3 Origin{ 0.0 };             ///< first corner
  std::array<Vec3, 3> Axes{};     ///< two axes in the plane, and its normal
  std::vector<Vec3> Plane;        ///< corners, then added points, along the axes
  std::vector<std::size_t> Swept; ///< corners of triangles, as GLU gives them
  std::exception_ptr Failure;     ///< exception of a callback, which must not leave GLU
  unsigned int ErrorOfGlu = 0;    ///< last error that GLU has reported
};

/// Counts polygons whose triangles do not have the area of the outline.
class LostAreas
{
public:
  /// Counts the polygon that was divided last, unless its triangles are whole.
  /// @param name number of a cell or a face @param rounding as for IsWhole()
  void Check(const PolygonTriangulation& polygon, std::int64_t name, double rounding);

  /// Returns a sentence, or an empty text if no area was lost. @param kind "cell" or "face"
  std::string Sentence(const std::string& kind) const;

private:
  std::int64_t Count = 0;
  std::string Names; ///< of the first polygons
  std::string Share; ///< difference of the first polygon's areas, %
};
}

#endif
