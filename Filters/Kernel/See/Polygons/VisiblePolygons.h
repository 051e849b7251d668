// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VisiblePolygons.h
 * @brief Visible surfaces of a beam, as convex polygons that partition the disc except for the sky.
 *
 * In the beam's plane (BeamTriangles.h) the visible surfaces are the upper envelope of 1/z, an
 * affine function on each triangle. Convex pieces partition an octagon around the disc. Triangles
 * are taken front to back. A piece that a triangle overlaps is cut by the triangle's sides and,
 * where the planes cross, by the line of equal 1/z. An open piece shows the sky. The search ends
 * when no piece is open and the next triangle lies behind all pieces.
 *
 * A line that passes a corner within Snap does not cut a side at this corner. Pieces with an area
 * below LeastArea are left out. The sum of the areas of these pieces gives VisiblePolygons::lost.
 *
 * Source: Weiler and Atherton, "Hidden Surface Removal Using Polygon Area Sorting", SIGGRAPH 1977.
 * Differs: all pieces are convex and partition the view, so no general clipper is needed.
 * Valid: any triangles. The areas of all pieces, including the pieces that are left out, sum to the
 * area of the octagon within 1e-12 of this area. The result depends only on the beam and the
 * triangles that enter the disc, not on the order of the triangles.
 * Test: TestVisiblePolygons.cxx, TestPolygonEdges.cxx.
 */
#ifndef avianlidar_VisiblePolygons_h
#define avianlidar_VisiblePolygons_h

#include "BeamTriangles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// A convex polygon, counterclockwise or clockwise.
struct PlaneRing
{
  static constexpr int MostCorners = 32;
  PlanePoint corners[MostCorners];
  int size = 0;

  PlaneRing() = default;
  PlaneRing(const PlaneRing& other) { *this = other; }
  PlaneRing& operator=(const PlaneRing& other)
  {
    this->size = other.size;
    std::copy(other.corners, other.corners + other.size, this->corners);
    return *this;
  }
  void add(const PlanePoint& p) { this->corners[this->size++] = p; }
  double area() const { return std::fabs(this->signedArea()); }
  double signedArea() const; ///< positive if counterclockwise
  /// True if the ring has at most MostCorners corners after one more cut.
  bool mayBeCut() const { return this->size + 2 <= MostCorners; }
};

/// Distance from a corner, half-beamwidths, within which a line counts as passing through the
/// corner.
constexpr double Snap = 1e-11;

/// Side of a line on which a ring lies. A ring on the line itself counts as Negative.
enum class SideOfLine
{
  Positive,
  Negative,
  Both
};

/// Find on which side of a line a ring lies, and cut the ring if it lies on both sides. @param line
/// line of slope 1, so that values of the line are distances
SideOfLine cutRing(
  const PlaneRing& ring, const PlaneLine& line, PlaneRing& positive, PlaneRing& negative);

/// An octagon that contains the disc.
PlaneRing octagonAround();

/// Keep the part of a ring where a function is positive, or the whole ring if it has too many
/// corners to be cut. @return false if nothing is left
bool clipRing(PlaneRing& ring, const PlaneLine& line);

/// Visible polygons of a beam, which may extend beyond the disc.
struct VisiblePolygons
{
  struct Polygon
  {
    std::uint32_t surface;
    std::uint32_t end; ///< end of the corners, which begin where the previous polygon ends
  };
  std::vector<PlaneSurface> surfaces;
  std::vector<Polygon> polygons;
  std::vector<PlanePoint> corners;
  double lost = 0.0;   ///< area of the pieces left out / area of the disc
  bool facing = false; ///< whether light may go between two surfaces

  /// Add a surface with one polygon.
  void add(const PlaneSurface& surface, const PlaneRing& ring);

  /// Call f(surface, ring) for each polygon.
  template <class F>
  void forEach(F f) const
  {
    std::uint32_t begin = 0;
    for (const Polygon& polygon : this->polygons)
    {
      PlaneRing ring;
      for (; begin < polygon.end; ++begin)
      {
        ring.add(this->corners[begin]);
      }
      f(this->surfaces[polygon.surface], ring);
    }
  }

  /// The triangle seen at a point, or NoTriangle.
  std::uint32_t triangleAt(const PlanePoint& p) const;

  std::size_t bytes() const
  {
    return sizeof(VisiblePolygons) + sizeof(PlaneSurface) * this->surfaces.capacity() +
      sizeof(Polygon) * this->polygons.capacity() + sizeof(PlanePoint) * this->corners.capacity();
  }
};

/// Result of a search.
enum class SeenByBeam : std::uint8_t
{
  Nothing = 0,  ///< no surface enters the disc
  Polygons = 1, ///< all visible polygons were found
  TooMuch = 2   ///< too many triangles or polygons
};

/// Finds the polygons of one beam after the other. Each thread needs its own object. The scene must
/// outlive the object.
class PolygonFinder
{
public:
  /// @param mostTriangles largest number of triangles in the disc; three times this number is the
  /// largest number of polygons
  /// @param mostCandidates largest number of triangles that are set up, if above mostTriangles
  PolygonFinder(
    const SceneTriangles& scene, std::size_t mostTriangles, std::size_t mostCandidates = 0)
    : Entering(scene, std::max(mostTriangles, mostCandidates))
    , MostTriangles(mostTriangles)
    , MostCandidates(std::max(mostTriangles, mostCandidates))
  {
  }

  void begin(const BeamFrame& frame) { this->Entering.begin(frame); }

  /// Add triangles, in any order. Every triangle that may enter the cone must be added exactly
  /// once.
  void add(const std::uint32_t* triangles, std::size_t count)
  {
    this->Entering.add(triangles, count);
  }

  /// @param found visible polygons, set if the result is SeenByBeam::Polygons
  SeenByBeam find(std::unique_ptr<VisiblePolygons>& found);

  /// The triangles that were added. After find() these triangles are sorted, unless more than
  /// mostCandidates triangles enter the disc.
  BeamTriangles& entering() { return this->Entering; }
  const std::vector<const BeamSurface*>& candidates() const { return this->Entering.nearest(); }

private:
  using Candidate = BeamSurface;
  static constexpr std::uint32_t Open = 0xffffffffu;
  /// A piece of the octagon. Circles limit the comparison of a candidate to a few of the pieces'
  /// rings.
  struct Piece
  {
    PlanePoint centre; ///< centre of a circle around the piece
    double radius;
    double leastInverse;     ///< lower bound of 1/z, 1/m
    std::uint32_t candidate; ///< number of the surface seen in the piece, or Open
    void findCircle(const PlaneRing& ring);
  };
  /// Corners and plane of a visible surface.
  struct Facet
  {
    Vec3 corners[6];
    int size;
    Vec3 normal; ///< unit normal, towards the apex
    double height;
  };
  bool insert(std::uint32_t number);
  bool meet(std::size_t piece, std::uint32_t number);
  bool isBehindAll(const Candidate& candidate) const;
  bool isNearer(
    const Candidate& one, const Candidate& two, const PlaneRing*& inner, PlaneRing& nearer);
  void keepPiece(const PlaneRing& ring, std::uint32_t candidate, std::size_t place);
  void collect(VisiblePolygons& found);
  Facet facetOf(const PlaneSurface& surface);
  bool isFacing(const VisiblePolygons& found);

  BeamTriangles Entering;
  const std::size_t MostTriangles;
  const std::size_t MostCandidates;
  std::vector<Piece> Pieces;
  std::vector<PlaneRing> Rings; ///< rings of the pieces
  std::size_t PiecesOpen = 0;
  double LostArea = 0.0;
  PlaneRing Outside[5]; ///< parts of a piece outside a candidate
  int NumberOutside = 0;
  std::vector<std::uint32_t> Numbers;
  std::vector<Facet> Facets;
};
}

#endif
