// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTriangles.h
 * @brief The triangles that enter a beam's disc, set up in the beam's plane, nearest first.
 *
 * The beam fills the unit disc of its plane (BeamFrame.h). In this plane a triangle is the
 * intersection of the half-planes of its edge functions (TriangleTest.h). On the triangle, 1/z is
 * an affine function, with z the distance along the axis. Triangles are set up eight at a time, in
 * SIMD lanes. Two triangles with consecutive numbers become one surface if they form a convex
 * quadrilateral whose corners lie in one plane within the rounding of scene coordinates. Triangles
 * that share a plane (CoincidentFaces.h) have the same 1/z and are sorted by number.
 *
 * Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988, for half-planes.
 * Differs: the plane lies across a beam's axis, and the unit disc takes the place of pixels.
 * Valid: any triangles. The result depends only on the beam and the triangles that enter the disc,
 * not on the order of the triangles. A triangle that overlaps the disc by less than rounding may be
 * left out.
 * Test: TestVisiblePolygons.cxx, TestBeamCells.cxx.
 */
#ifndef avianlidar_BeamTriangles_h
#define avianlidar_BeamTriangles_h

#include "BeamFrame.h"
#include "SceneTriangles.h"
#include "TriangleTest.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace avianlidar
{
/// A point of the beam's plane, in half-beamwidths.
struct PlanePoint
{
  double x, y;
};

/// An affine function on the beam's plane, or the line where the function is 0.
struct PlaneLine
{
  double x = 0.0, y = 0.0, z = 0.0;
  double at(const PlanePoint& p) const { return (this->x * p.x + this->y * p.y) + this->z; }
  double slope() const { return std::sqrt(this->x * this->x + this->y * this->y); }
};

/// Radii, in half-beamwidths, of the inscribed and circumscribed circles of an octagon around the
/// disc. The margin of 1e-6 exceeds rounding.
constexpr double InRadius = 1.0 + 1e-6;
constexpr double OutRadius = InRadius * 1.0823922002923940; // 1/cos(pi/8)

/// A plane surface in the beam: a triangle, or a quadrilateral of two triangles.
struct PlaneSurface
{
  std::uint32_t triangle;
  std::uint32_t other; ///< triangle of the other half, or NoTriangle
  PlaneLine diagonal;  ///< side between the halves, negative on the other half
  PlaneLine inverse;   ///< 1/z on the plane, 1/m
  double height;       ///< distance of the plane from the apex, m
  double leastInverse; ///< lower bound of 1/z at all corners, 1/m

  /// The half that holds a point of the surface.
  std::uint32_t triangleAt(const PlanePoint& p) const
  {
    return this->other != NoTriangle && this->diagonal.at(p) < 0.0 ? this->other : this->triangle;
  }
};

constexpr double AreaUnknown = -1.0;

/// A surface that enters the disc.
struct BeamSurface : PlaneSurface
{
  std::uint32_t crosses; ///< bits of the sides of the triangle that meet the octagon
  int count = 0;         ///< number of `lines`
  PlaneLine lines[4];    ///< sides that meet the octagon; slope 1, positive inside
  double mostInverse;    ///< upper bound of 1/z in the octagon, 1/m
  double sortInverse;    ///< key of sort(), 1/m: mostInverse, or the bound of a shared plane
  double area;           ///< area, half-beamwidths squared; AreaUnknown for surfaces across the rim
};

/// Sets up the triangles of one beam after the other. Each thread needs its own object. The scene
/// must outlive the object.
class BeamTriangles
{
public:
  /// @param most largest number of triangles that are set up; if more triangles enter, only the
  /// numbers of triangles are kept
  explicit BeamTriangles(
    const SceneTriangles& scene, std::size_t most = std::numeric_limits<std::size_t>::max())
    : Scene(scene)
    , Most(most)
  {
  }

  void begin(const BeamFrame& frame);

  /// Add triangles, in any order. Every triangle that may enter the cone must be added exactly
  /// once.
  void add(const std::uint32_t* triangles, std::size_t count);

  /// Must be called after the last add(). @return number of triangles that enter, exact up to
  /// `most`
  std::size_t finish();

  /// If more than `most` triangles enter, append the numbers of all triangles that enter, and of
  /// some other triangles.
  void appendNumbers(std::vector<std::uint32_t>& numbers) const;

  /// Join the halves of quadrilaterals, and sort the surfaces, nearest first. Must be called after
  /// the last add(). @return the surfaces
  const std::vector<const BeamSurface*>& sort();
  const std::vector<const BeamSurface*>& nearest() const { return this->Nearest; }

  /// Corners of a triangle relative to the apex, m.
  Corners cornersOf(std::uint32_t triangle) const
  {
    return this->Scene.cornersFrom(triangle, this->Frame.origin);
  }

private:
  void setUp(const std::uint32_t* triangles, std::size_t count);
  std::uint8_t findJoint(std::uint32_t triangle) const;
  bool join(BeamSurface& one, const BeamSurface& two);

  std::uint8_t jointAfter(std::uint32_t triangle);

  const SceneTriangles& Scene;
  const std::size_t Most;
  BeamFrame Frame;
  std::vector<std::uint32_t> Waiting; ///< triangles not yet set up
  std::vector<BeamSurface> Surfaces;  ///< surfaces, of which the first `Count` are valid
  std::size_t Count = 0;
  std::vector<const BeamSurface*> Nearest;
  std::vector<std::uint8_t> Joints; ///< findJoint() of the triangles of the tree
  std::vector<std::uint64_t> Keys;
  std::vector<std::uint32_t> ByTriangle;
};
}

#endif
