// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BoundingVolume.h
 * @brief The paper's bounding volumes, boxes and spheres, and their fit to triangles.
 *
 * An empty volume contains no point and has no area.
 *
 * Source: paper, Sec. 3.1; for spheres Badoiu and Clarkson, "Smaller core-sets for balls", SODA
 * 2003.
 * Differs: a few steps of Badoiu and Clarkson's method come within some per cent of the smallest
 * sphere.
 * Valid: coordinates up to MaximumCoordinate in magnitude. A fitted volume holds every corner of
 * its triangles, rounding included.
 * Test: TestBoundingVolume.cxx.
 */
#ifndef avianlidar_BoundingVolume_h
#define avianlidar_BoundingVolume_h

#include "TriangleMesh.h"

#include <glm/mat3x3.hpp>

#include <cstdint>

namespace avianlidar
{
/// Box along orthonormal axes: |axes[i] . (p - center)| <= half[i].
struct OBB
{
  Vec3 center{ 0.0 };
  glm::dmat3 axes{ 1.0 }; ///< unit vectors in columns
  Vec3 half{ -1.0 };

  bool empty() const { return this->half.x < 0.0; }
  /// Components of a vector along the axes.
  Vec3 along(const Vec3& v) const { return v * this->axes; }
};

/// Box along the coordinate axes.
struct AlignedBox
{
  Vec3 center{ 0.0 };
  Vec3 half{ -1.0 };

  bool empty() const { return this->half.x < 0.0; }
  static const Vec3& along(const Vec3& v) { return v; }
  operator OBB() const { return { this->center, glm::dmat3(1.0), this->half }; }
};

/// Bounding sphere: |p - center| <= radius.
struct BoundingSphere
{
  Vec3 center{ 0.0 };
  double radius = -1.0;
  bool empty() const { return this->radius < 0.0; }
};

/// Surface area, m2; 0 if empty.
double surfaceArea(const OBB& volume);

/// Some triangles of a mesh, given by their numbers.
struct TriangleList
{
  const TriangleMesh& mesh;
  const std::uint32_t* numbers;
  std::size_t count;
};

/// Smallest box along the coordinate axes.
AlignedBox alignedBox(const TriangleList& triangles);
/// Smallest box along the principal axes of the corners or along the coordinate axes, whichever has
/// the smaller surface.
OBB orientedBox(const TriangleList& triangles);
BoundingSphere boundingSphere(const TriangleList& triangles);
}

#endif
