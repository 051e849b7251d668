// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BoundingVolume.h
 * @brief Bounding volumes beside AABB.h: OBB and sphere; of all three fit and, for boxes, area.
 *
 * A volume of nothing is empty: it contains no point and has no area.
 *
 * Source: paper, Sec. 3.1; for spheres Badoiu and Clarkson, "Smaller core-sets for balls", SODA
 * 2003.
 * Differs: of Badoiu and Clarkson's method a few steps are made; see fitToTriangles().
 * Valid: coordinates up to MaximumCoordinate in magnitude. Fitting is conservative:
 * contains() holds for every corner that went in, rounding included.
 * Test: TestBoundingVolume.cxx.
 */
#ifndef avianlidar_BoundingVolume_h
#define avianlidar_BoundingVolume_h

#include "AABB.h"
#include "TriangleMesh.h"

#include <array>
#include <cstdint>

namespace avianlidar
{
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

/// A volume around the corners of the triangles whose numbers are listed. The AABB is the smallest;
/// the OBB takes the principal axes of the corners or the coordinate axes, whichever box has the
/// smaller surface; the sphere is within some per cent of the smallest (Badoiu and Clarkson,
/// "Smaller core-sets for balls", SODA 2003, a few steps).
template <class Volume>
Volume fitToTriangles(const TriangleMesh& mesh, const std::uint32_t* triangles, std::size_t count);
}

#endif
