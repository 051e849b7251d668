// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathSpace.h
 * @brief Which surfaces of a beam have anything before them that a mirror path inside the cone
 * could meet.
 *
 * Most facades have not: the mirror paths of all rays that hit one fill a small space, bounded by
 * the cone, before its plane. One descent of the tree for the box around that space, ended by the
 * first triangle that reaches into it and before the plane, spares a descent for every ray. The
 * answer errs on the side of yes: paths that are not traced would have met nothing.
 */
#ifndef avianlidar_PathSpace_h
#define avianlidar_PathSpace_h

#include "CollisionTree.h"
#include "PrimaryHits.h"
#include "Traversal.h"

#include <vector>

namespace avianlidar
{
/// How far a path from `point` inside the cone, at `range`, stays in it, m, rather too long than
/// too short; infinity for directions within the cone's own, or nearly. All relative to the apex.
double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction);

/// Reusable without allocation; one per thread.
class PathSpace
{
public:
  /// For each surface of the geometry, whether mirror paths of its hits may meet anything.
  const std::vector<char>& look(const CollisionTree& tree, const BeamFrame& frame,
    const PrimaryHits& hits, const HitGeometry& geometry);

private:
  std::vector<AABB> Boxes; ///< of the surfaces' mirror paths, relative to the apex
  std::vector<double> LeastHeights;
  std::vector<char> Occupied;
  TraversalStack Stack;
};
}

#endif
