// SPDX-License-Identifier: BSD-3-Clause
#include "CollisionTree.h"

namespace avianlidar
{
TrianglePlane planeOf(
  const CollisionTree& tree, std::uint32_t triangle, const Corners& corners, const Vec3& apex)
{
  const std::uint32_t owner = tree.planeOwner(triangle);
  return owner == triangle ? planeOf(corners)
                           : planeOf(corners, planeOf(cornersFrom(*tree.mesh, owner, apex)));
}
}
