// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file CollisionTreeBuilder.h
 * @brief Builds the collision detection tree layer by layer (paper, Algorithm 1).
 */
#ifndef avianlidar_CollisionTreeBuilder_h
#define avianlidar_CollisionTreeBuilder_h

#include "CollisionTree.h"

#include <functional>

namespace avianlidar
{
/// Called now and then with the fraction done on the calling thread; returning false stops the
/// work.
using KeepGoing = std::function<bool(double fraction)>;

/// Build a tree over all triangles of `mesh` (degenerate ones included: they are never hit but keep
/// their number).
/// @return null if `keepGoing` said stop. Throws std::invalid_argument naming the option if it is
/// out of range, or the triangle whose corner is missing or not finite. Deterministic.
std::shared_ptr<const CollisionTree> buildCollisionTree(std::shared_ptr<const TriangleMesh> mesh,
  const TreeOptions& options, const KeepGoing& keepGoing = {});
}

#endif
