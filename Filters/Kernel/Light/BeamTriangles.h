// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTriangles.h
 * @brief The triangles that enter a beam's disc, set up in the beam's plane, nearest first.
 *
 * In the beam's plane (BeamFrame.h) the cone is the unit disc, a triangle the intersection of the
 * half-planes of its edge functions (TriangleTest.h), and 1/z of its plane an affine function, z
 * the distance along the axis. Triangles are set up eight at a time, in SIMD lanes. Two triangles
 * with consecutive numbers that form a convex quadrilateral in one plane, but for the rounding of
 * scene coordinates, are one surface.
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
#include "CollisionTree.h"
#include "ExactTriangles.h"
#include "TriangleTest.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
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

/// A triangle, or a quadrilateral of two, that enters the disc.
struct BeamSurface
{
  std::uint32_t triangle;
  std::uint32_t other;  ///< the other half; NoTriangle: there is none
  std::uint32_t number; ///< of the triangle, before it was sorted
  int count = 0;        ///< of `lines`
  PlaneLine lines[4];   ///< sides that meet the octagon; slope 1, positive inside
  PlaneLine diagonal;   ///< negative on the other half
  PlaneLine inverse;    ///< 1/z, 1/m
  double mostInverse;   ///< upper bound of 1/z in the octagon
  double height;        ///< distance of the plane from the apex, m
  double leastInverse;  ///< lower bound of 1/z, 1/m: no corner is farther
  double area;          ///< in half-beamwidths squared, also of what lies outside the disc
};

/// Sets up the triangles of one beam after the other. One per thread; the tree must outlive it.
class BeamTriangles
{
public:
  explicit BeamTriangles(const CollisionTree& tree)
    : Mesh(tree.mesh.get())
  {
  }

  /// Go on to the triangles of another tree.
  void follow(const CollisionTree& tree)
  {
    this->Mesh = tree.mesh.get();
    this->Triangles.forget();
  }

  void begin(const BeamFrame& frame);

  /// Add triangles, in any order, each once. @return number of those that enter, but for the last
  /// few, which are not looked at before sort()
  std::size_t add(const std::uint32_t* triangles, std::size_t count);

  /// Look at the last. @return number of triangles that enter
  std::size_t finish();

  /// Join halves, and sort surfaces, nearest first. @return them
  const std::vector<BeamSurface>& sort();
  const std::vector<BeamSurface>& surfaces() const { return this->Surfaces; }

  /// Corners and plane of a triangle. Valid until the next call.
  const ExactTriangle& triangle(std::uint32_t number) { return this->Triangles[number]; }

private:
  void setUp(const std::uint32_t* triangles, std::size_t count);
  bool join(BeamSurface& one, const BeamSurface& two);

  const TriangleMesh* Mesh;
  BeamFrame Frame;
  ExactTriangles<1024> Triangles;
  std::vector<std::uint32_t> Waiting; ///< not yet set up
  std::vector<BeamSurface> Surfaces, Ordered;
  std::vector<std::uint8_t> Crosses; ///< of each triangle: bit k, side k meets the octagon
  std::vector<std::pair<double, std::uint32_t>> Order;
};
}

#endif
