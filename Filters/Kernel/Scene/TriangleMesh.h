// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TriangleMesh.h
 * @brief Geometry of the scene: an indexed set of triangles in scene coordinates (double, m).
 *
 * Source: none.
 * Valid: at most 2^31 - 1 triangles with coordinates of at most 1e30 m (checked when a tree is
 * built).
 * Test: TestTriangleMesh.cxx (checksum), TestWatertight.cxx (shared edges).
 */
#ifndef avianlidar_TriangleMesh_h
#define avianlidar_TriangleMesh_h

#include "Hash.h"
#include "Vector.h"

#include <array>
#include <cstdint>
#include <vector>

namespace avianlidar
{
constexpr std::uint32_t NoTriangle = 0xffffffffu;

/// Triangles that share an edge must share the bits of its end points for the surface to be
/// watertight.
struct TriangleMesh
{
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::size_t size() const { return this->triangles.size(); }
  const Vec3& corner(std::uint32_t triangle, int c) const
  {
    return this->points[this->triangles[triangle][c]];
  }

  /// Hash (XXH3, 64 bits) of points and triangles. Equal content has equal hashes on all machines
  /// of the same byte order.
  std::uint64_t checksum() const
  {
    static_assert(sizeof(Vec3) == 3 * sizeof(double), "points must be packed to be hashed");
    static_assert(sizeof(this->triangles[0]) == 3 * sizeof(std::uint32_t),
      "triangles must be packed to be hashed");
    // The first hash seeds the second hash, so the result changes if bytes move between arrays.
    const std::uint64_t ofPoints =
      hashOf(this->points.data(), this->points.size() * sizeof(Vec3), this->points.size());
    return hashOf(
      this->triangles.data(), this->triangles.size() * sizeof(this->triangles[0]), ofPoints);
  }
};
}

#endif
