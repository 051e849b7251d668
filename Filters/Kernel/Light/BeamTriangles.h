// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTriangles.h
 * @brief The triangles that enter a beam's disc, set up in the beam's plane, nearest first.
 *
 * In the beam's plane (BeamFrame.h) the beam lies in the unit disc; a triangle is the intersection
 * of the half-planes of its edge functions (TriangleTest.h), and 1/z of its plane an affine
 * function, z the distance along the axis. Triangles are set up eight at a time, in SIMD lanes. Two
 * triangles with consecutive numbers that form a convex quadrilateral in one plane, but for the
 * rounding of scene coordinates, are one surface. Triangles that take the plane of another
 * (CoincidentFaces.h) have its 1/z, and come in the order of their numbers.
 *
 * Source: Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988, for half-planes.
 * Differs: the plane is across a beam's axis, and has the unit disc instead of pixels.
 * Valid: any triangles. The result depends on the beam and the triangles that enter the disc alone,
 * not on their order. A triangle that touches the disc in less than rounding may be left out.
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

/// An affine function on the beam's plane, or the line where it is 0.
struct PlaneLine
{
  double x = 0.0, y = 0.0, z = 0.0;
  double at(const PlanePoint& p) const { return (this->x * p.x + this->y * p.y) + this->z; }
  double slope() const { return std::sqrt(this->x * this->x + this->y * this->y); }
};

/// Radii, in half-beamwidths, of the circles in and around an octagon that holds the disc by more
/// than rounding.
constexpr double InRadius = 1.0 + 1e-6;
constexpr double OutRadius = InRadius * 1.0823922002923940; // 1/cos(pi/8)

/// A plane in the beam: a triangle, or two halves of a quadrilateral.
struct PlaneSurface
{
  std::uint32_t triangle;
  std::uint32_t other; ///< the other half; NoTriangle: there is none
  PlaneLine diagonal;  ///< negative on the other half
  PlaneLine inverse;   ///< 1/z, 1/m
  double height;       ///< distance of the plane from the apex, m
  double leastInverse; ///< lower bound of 1/z, 1/m: no corner is farther

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
  std::uint32_t crosses; ///< of the triangle: bit k, side k meets the octagon
  int count = 0;         ///< of `lines`
  PlaneLine lines[4];    ///< sides that meet the octagon; slope 1, positive inside
  double mostInverse;    ///< upper bound of 1/z in the octagon
  double sortInverse;    ///< the same; surfaces that coincide have that of their plane
  double area;           ///< in half-beamwidths squared; AreaUnknown if it crosses the rim
};

/// Sets up the triangles of one beam after the other. One per thread; the scene must outlive it.
class BeamTriangles
{
public:
  /// @param most triangles that are set up; of a beam that more enter only the numbers are kept
  explicit BeamTriangles(
    const SceneTriangles& scene, std::size_t most = std::numeric_limits<std::size_t>::max())
    : Scene(scene)
    , Most(most)
  {
  }

  void begin(const BeamFrame& frame);

  /// Add triangles, in any order, each once. All that may enter the cone must be added.
  void add(const std::uint32_t* triangles, std::size_t count);

  /// After the last triangle. @return number of triangles that enter, if not more than `most`
  std::size_t finish();

  /// Append the numbers of all that enter, if there are more than `most`, and of some that do not.
  void appendNumbers(std::vector<std::uint32_t>& numbers) const;

  /// Join halves, and sort surfaces, nearest first; after the last triangle. @return them
  const std::vector<const BeamSurface*>& sort();
  const std::vector<const BeamSurface*>& nearest() const { return this->Nearest; }

  /// Corners of a triangle, from the apex.
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
  std::vector<std::uint32_t> Waiting; ///< not yet set up
  std::vector<BeamSurface> Surfaces;  ///< the first `Count`
  std::size_t Count = 0;
  std::vector<const BeamSurface*> Nearest;
  std::vector<std::uint8_t> Joints; ///< findJoint() of the triangles of the tree
  std::vector<std::uint64_t> Keys;
  std::vector<std::uint32_t> ByTriangle;
};
}

#endif
