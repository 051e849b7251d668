// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathSpace.h
 * @brief Where there is nothing that paths on from the hits of a beam could meet.
 *
 * Most facades have nothing before them within the cone: the mirror paths of all rays that hit one
 * fill a small space, bounded by the cone, before its plane. Likewise the connections of two walls
 * of a corner fill the space between them. One descent of the tree for the box around the spaces of
 * a beam finds the triangles that reach into one of them, into the cone and before its planes; if
 * that meets too many, each space has a descent of its own. Usually there are
 * none, and all paths are done; a few are tested against every path, which costs less than a
 * descent for each. The lists err on the side of more: what is not in them no path would have met.
 * Their triangles depend on the scene alone, not on the tree; only whether a space is given up as
 * too full does.
 */
#ifndef avianlidar_PathSpace_h
#define avianlidar_PathSpace_h

#include "CollisionTree.h"
#include "PrimaryHits.h"
#include "SecondaryLinks.h"
#include "Traversal.h"

#include <vector>

namespace avianlidar
{
/// How far a path from `point` inside the cone, at `range`, stays in it, m, rather too long than
/// too short; infinity for directions within the cone's own, or nearly. All relative to the apex.
double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction);

/// The triangles that paths of one kind may meet.
struct Occupants
{
  static constexpr int Most = 6; ///< for more a descent for each path is faster
  int count = 0;                 ///< Most + 1: too many to list
  std::uint32_t triangles[Most];
  bool areListed() const { return this->count <= Most; }
};

/// Reusable without allocation; one per thread.
class PathSpace
{
public:
  /// For each surface of the geometry, what mirror paths of its hits may meet.
  const std::vector<Occupants>& beforeSurfaces(const CollisionTree& tree, const BeamFrame& frame,
    const PrimaryHits& hits, const HitGeometry& geometry);

  /// What may stand between the hits of links: call ofLink() afterwards.
  void betweenSurfaces(const CollisionTree& tree, const BeamFrame& frame, const PrimaryHits& hits,
    const HitGeometry& geometry, const SecondaryLinks& links);
  const Occupants& ofLink(std::size_t link) const
  {
    return this->Pairs[this->PairOfLink[link]].occupants;
  }

private:
  /// A surface that bounds a space, and the height above it below which no path meets anything, m.
  struct Floor
  {
    std::uint32_t surface;
    double least;
  };
  struct Pair
  {
    Floor floors[2]; ///< the lower surface number first
    Occupants occupants;
  };
  class Search;
  std::uint32_t pairOf(std::uint32_t surface1, std::uint32_t surface2);

  std::vector<AABB> Boxes; ///< of the surfaces' paths or hits, relative to the apex
  std::vector<Floor> Floors;
  std::vector<Pair> Pairs;
  std::uint32_t LastPair = 0; ///< looked for last: most links join the surfaces of the one before
  std::vector<std::uint32_t> PairOfLink;
  std::vector<Occupants> Found;
  TraversalStack Stack;
};
}

#endif
