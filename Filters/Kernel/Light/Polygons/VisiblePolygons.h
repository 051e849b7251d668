// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VisiblePolygons.h
 * @brief Which surface a beam sees where: convex polygons, each of one surface, that partition the
 * beam's disc but for what is open sky.
 *
 * In the beam's plane (BeamTriangles.h) what is seen where is the upper envelope of affine
 * functions over convex polygons. Convex pieces partition an octagon around the disc; triangles are
 * taken front to back. A piece that a triangle overlaps is cut by the triangle's sides and, where
 * both planes overlap, by the line of equal 1/z. The search ends when no piece is open and the next
 * triangle lies behind all of them.
 *
 * A line that passes a corner within Snap does not cut there. Pieces that are smaller than
 * LeastArea are left out and their area is summed (VisiblePolygons::lost).
 *
 * Source: Weiler and Atherton, "Hidden Surface Removal Using Polygon Area Sorting", SIGGRAPH 1977.
 * Differs: all pieces are convex and partition the view, so that nothing needs a general clipper.
 * Valid: any triangles. Pieces and `lost` sum up to the octagon within 1e-12 of its area. The
 * result depends on the beam and the triangles that enter the disc alone, not on their order.
 * Test: TestVisiblePolygons.cxx, TestPolygonScan.cxx.
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
  double signedArea() const; ///< by the sense of rotation
  /// True if another cut does not exceed MostCorners.
  bool mayBeCut() const { return this->size + 2 <= MostCorners; }
};

/// A line no farther than this from a corner, in half-beamwidths, passes through it.
constexpr double Snap = 1e-11;

/// Where a ring lies: a ring on the line is on the negative side.
enum class SideOfLine
{
  Positive,
  Negative,
  Both
};

/// Cut a ring that lies on both sides of a line. @param line with a slope of 1: values are
/// distances
SideOfLine cutRing(
  const PlaneRing& ring, const PlaneLine& line, PlaneRing& positive, PlaneRing& negative);

/// An octagon that holds the disc.
PlaneRing octagonAround();

/// Keep the part of a ring where a function is positive; all of it, if it has too many corners to
/// be cut. @return false if nothing is left
bool clipRing(PlaneRing& ring, const PlaneLine& line);

/// Visible polygons of a beam. They may extend beyond the disc.
struct VisiblePolygons
{
  struct Polygon
  {
    std::uint32_t surface;
    std::uint32_t end; ///< of its corners; they begin where those of the polygon before end
  };
  std::vector<PlaneSurface> surfaces;
  std::vector<Polygon> polygons;
  std::vector<PlanePoint> corners;
  double lost = 0.0;   ///< area of the pieces left out, over that of the disc
  bool facing = false; ///< light may go from one surface to another

  /// Add a polygon of a surface of its own.
  void add(const PlaneSurface& surface, const PlaneRing& ring);

  /// f(surface, ring) for each polygon.
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

  /// The triangle seen at a point; NoTriangle: none.
  std::uint32_t triangleAt(const PlanePoint& p) const;

  std::size_t bytes() const
  {
    return sizeof(VisiblePolygons) + sizeof(PlaneSurface) * this->surfaces.capacity() +
      sizeof(Polygon) * this->polygons.capacity() + sizeof(PlanePoint) * this->corners.capacity();
  }
};

/// What a search has found.
enum class SeenByBeam : std::uint8_t
{
  Nothing = 0,  ///< no surface enters the disc
  Polygons = 1, ///< all that is visible
  TooMuch = 2   ///< too many triangles or polygons
};

/// Finds the polygons of one beam after the other. One per thread; the scene must outlive it.
class PolygonFinder
{
public:
  /// @param mostTriangles that may enter the disc; polygons may be three times as many
  /// @param mostCandidates that are set up for others, if more
  PolygonFinder(
    const SceneTriangles& scene, std::size_t mostTriangles, std::size_t mostCandidates = 0)
    : Entering(scene, std::max(mostTriangles, mostCandidates))
    , MostTriangles(mostTriangles)
    , MostCandidates(std::max(mostTriangles, mostCandidates))
  {
  }

  void begin(const BeamFrame& frame) { this->Entering.begin(frame); }

  /// Add triangles, in any order, each once. All that may enter the cone must be added.
  void add(const std::uint32_t* triangles, std::size_t count)
  {
    this->Entering.add(triangles, count);
  }

  /// @param found set if the result is SeenByBeam::Polygons
  SeenByBeam find(std::unique_ptr<VisiblePolygons>& found);

  /// The triangles that were added; sorted after find(), unless there are more than are set up.
  BeamTriangles& entering() { return this->Entering; }
  const std::vector<const BeamSurface*>& candidates() const { return this->Entering.nearest(); }

private:
  using Candidate = BeamSurface;
  static constexpr std::uint32_t Open = 0xffffffffu;
  /// A piece of the octagon. All are looked at for each candidate, but few of their rings.
  struct Piece
  {
    PlanePoint centre; ///< of a circle that holds it
    double radius;
    double leastInverse;     ///< 1/m
    std::uint32_t candidate; ///< what is seen there; Open: nothing
    void findCircle(const PlaneRing& ring);
  };
  /// Corners and plane of a visible surface.
  struct Facet
  {
    Vec3 corners[6];
    int size;
    Vec3 normal; ///< unit, towards the apex
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
  std::vector<PlaneRing> Rings; ///< of the pieces
  std::size_t PiecesOpen = 0;
  double LostArea = 0.0;
  PlaneRing Outside[5]; ///< parts of a piece that a triangle leaves
  int NumberOutside = 0;
  std::vector<std::uint32_t> Numbers;
  std::vector<Facet> Facets;
};
}

#endif
