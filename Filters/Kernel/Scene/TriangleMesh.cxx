// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleMesh.h"

#include "Hash.h"

namespace avianlidar
{
std::uint64_t TriangleMesh::checksum() const
{
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "points must be packed to be hashed");
  static_assert(sizeof(this->triangles[0]) == 3 * sizeof(std::uint32_t),
    "triangles must be packed to be hashed");
  // The second hash is seeded with the first, so that bytes cannot move from one array to the other
  // unnoticed.
  const std::uint64_t ofPoints =
    hashOf(this->points.data(), this->points.size() * sizeof(Vec3), this->points.size());
  return hashOf(
    this->triangles.data(), this->triangles.size() * sizeof(this->triangles[0]), ofPoints);
}
}
