// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathCandidates.h
 * @brief Triangles near the paths of a beam, in lanes: found by one descent of the tree, and told
 * from the paths of a surface all at once.
 *
 * The descent costs what one for a single path does, and about a thirtieth of that for each
 * triangle, half of it waiting for corners. Telling a triangle from a surface costs a fifteenth of
 * what finding it did.
 */
#ifndef avianlidar_PathCandidates_h
#define avianlidar_PathCandidates_h

#include "BeamFrame.h"
#include "BoundingVolume.h"
#include "CollisionTree.h"
#include "SegmentCulling.h"
#include "Traversal.h"

#include <vector>

namespace avianlidar
{
/// Reusable without allocation; one per thread.
class PathCandidates
{
public:
  /// The triangles that reach into the box (relative to the apex, m) and into the pyramid around
  /// the cone. @param farthest m, the farthest beginning of a path @return false if more than
  /// `most` had to be looked at
  bool find(const CollisionTree& tree, const BeamFrame& frame, double farthest, const AABB& box,
    std::size_t most, TraversalStack& stack);

  std::size_t size() const { return this->Count; }
  std::uint32_t triangle(std::size_t candidate) const { return this->Triangles[candidate]; }

  /// Bytes of a row with one for each: a multiple of SegmentCulling::Lanes.
  std::size_t stride() const
  {
    return (this->Count + SegmentCulling::Lanes - 1) / SegmentCulling::Lanes *
      SegmentCulling::Lanes;
  }

  /// Relative to the apex.
  SegmentCulling::Corners lanes() const;

  /// 0xff for those that paths before a surface cannot meet: all of it is below the height `least`,
  /// m, along the normal, or outside of the box, or it is the triangle `own`; else 0. @param closed
  /// stride() bytes, those beyond size() become 0xff
  void close(std::uint32_t own, const Vec3& normal, double least, const AABB& box,
    std::uint8_t* closed) const;

private:
  class Search;
  void begin(std::size_t most);
  void add(std::uint32_t triangle, const Corners& corners);
  void measure(const BeamFrame& frame, const Vec3& boxLower, const Vec3& boxUpper, double farthest);

  double Farthest = 0.0; ///< m
  std::size_t Count = 0; ///< vectors are longer
  std::vector<std::uint32_t> Triangles;
  std::vector<double> CornerLanes[9]; ///< a, b, c, m
  std::vector<double> Lower[3];       ///< m
  std::vector<double> Upper[3];       ///< m
  std::vector<double> Reach;          ///< m, the farthest coordinate involved
  std::vector<double> Number;         ///< of the triangle, in a lane
  std::vector<double> Outside;        ///< m, how far it lies outside of box or cone
};
}

#endif
