// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BoundingVolume.h
 * @brief The three bounding volumes: AABB, OBB and sphere, with fit and, for boxes, area.
 *
 * A volume of nothing is empty: it contains no point and has no area. An AABB of nothing is neutral
 * in a merge.
 *
 * Source: paper, Sec. 3.1; for spheres Badoiu and Clarkson, "Smaller core-sets for balls", SODA
 * 2003.
 * Differs: of Badoiu and Clarkson's method a few steps are made; see fitToTriangles().
 * Valid: coordinates up to MaximumCoordinate in magnitude. Fitting and merging are conservative:
 * contains() holds for every corner that went in, rounding included.
 * Test: TestBoundingVolume.cxx.
 */
#ifndef avianlidar_BoundingVolume_h
#define avianlidar_BoundingVolume_h

#include "TriangleMesh.h"
#include "Vector.h"

#include <array>
#include <cstdint>
#include <limits>

namespace avianlidar
{
/// Larger coordinates (m) are refused: products of three of them must stay finite.
constexpr double MaximumCoordinate = 1e30;

/// Axis-aligned bounding box, exact.
struct AABB
{
  Vec3 lower{ std::numeric_limits<double>::infinity() };
  Vec3 upper{ -std::numeric_limits<double>::infinity() };
  bool empty() const { return this->lower.x > this->upper.x; }
  /// Coordinates that are not numbers are left out.
  void extend(const Vec3& p)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->lower[axis] = p[axis] < this->lower[axis] ? p[axis] : this->lower[axis];
      this->upper[axis] = p[axis] > this->upper[axis] ? p[axis] : this->upper[axis];
    }
  }
  Vec3 center() const { return 0.5 * this->lower + 0.5 * this->upper; }
};

/// Oriented bounding box: |axes[i] . (p - center)| <= half[i].
struct OBB
{
  Vec3 center{ 0.0 };
  std::array<Vec3, 3> axes{ Vec3(1.0, 0.0, 0.0), Vec3(0.0, 1.0, 0.0),
    Vec3(0.0, 0.0, 1.0) }; ///< orthonormal
  Vec3 half{ -1.0 };
  bool empty() const { return this->half.x < 0.0; }
};

/// Bounding sphere: |p - center| <= radius.
struct BoundingSphere
{
  Vec3 center{ 0.0 };
  double radius = -1.0;
  bool empty() const { return this->radius < 0.0; }
};

bool contains(const AABB& volume, const Vec3& point);
bool contains(const OBB& volume, const Vec3& point);
bool contains(const BoundingSphere& volume, const Vec3& point);

/// Surface area, m^2, as the surface area heuristic takes it. 0 if empty.
inline double surfaceArea(const AABB& volume)
{
  if (volume.empty())
  {
    return 0.0;
  }
  const Vec3 e = volume.upper - volume.lower;
  return 2.0 * (e.x * e.y + e.y * e.z + e.z * e.x);
}
double surfaceArea(const OBB& volume);

/// A box that holds both.
inline AABB merge(const AABB& a, const AABB& b)
{
  AABB box = a;
  for (int axis = 0; axis < 3; ++axis)
  {
    box.lower[axis] = b.lower[axis] < a.lower[axis] ? b.lower[axis] : a.lower[axis];
    box.upper[axis] = b.upper[axis] > a.upper[axis] ? b.upper[axis] : a.upper[axis];
  }
  return box;
}

/// A volume around the corners of the triangles whose numbers are listed. The AABB is the smallest;
/// the OBB takes the principal axes of the corners or the coordinate axes, whichever box has the
/// smaller surface; the sphere is within some per cent of the smallest (Badoiu and Clarkson,
/// "Smaller core-sets for balls", SODA 2003, a few steps).
template <class Volume>
Volume fitToTriangles(const TriangleMesh& mesh, const std::uint32_t* triangles, std::size_t count);

/// Sum of the products of two components over vectors: xx, xy, xz, yy, yz, zz.
struct SecondMoments
{
  std::array<double, 6> sums{};
  void add(const Vec3& d)
  {
    this->sums[0] += d.x * d.x;
    this->sums[1] += d.x * d.y;
    this->sums[2] += d.x * d.z;
    this->sums[3] += d.y * d.y;
    this->sums[4] += d.y * d.z;
    this->sums[5] += d.z * d.z;
  }
};

/// Eigenvectors (orthonormal, right-handed, of decreasing eigenvalue) of a symmetric matrix given
/// by its upper half xx, xy, xz, yy, yz, zz; cyclic Jacobi. The coordinate axes if the matrix is
/// zero or not finite.
std::array<Vec3, 3> principalAxes(const std::array<double, 6>& covariance);
}

#endif
