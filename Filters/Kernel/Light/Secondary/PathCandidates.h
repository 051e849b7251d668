// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathCandidates.h
 * @brief The triangles near the paths of a beam, found by one descent of the tree and stored for
 * SIMD loops; those out of reach of all paths of a surface are excluded together.
 *
 * The descent costs as much as one for a single path, and about a thirtieth of that for each
 * triangle, half of it waiting for corners. Excluding a triangle for a surface costs a fifteenth of
 * finding it.
 *
 * Source: none.
 * Valid: conservative: no triangle that a path meets is left out, as long as no more than `most`
 * had to be examined; find() fails otherwise.
 * Test: TestPathSpace.cxx.
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
/// Candidates of one box after the other. Reusable without allocation; one per thread.
class PathCandidates
{
public:
  /// Find the triangles that reach into the box (relative to the apex, m) and into the pyramid
  /// about the cone. @param farthest distance of the farthest start of a path, m @return false if
  /// more than `most` had to be examined
  bool find(const CollisionTree& tree, const BeamFrame& frame, double farthest, const AABB& box,
    std::size_t most, TraversalStack& stack);

  std::size_t size() const { return this->Count; }
  std::uint32_t triangle(std::size_t candidate) const { return this->Triangles[candidate]; }

  /// Bytes of a row with one byte per candidate: a multiple of SegmentCulling::Lanes.
  std::size_t stride() const
  {
    return (this->Count + SegmentCulling::Lanes - 1) / SegmentCulling::Lanes *
      SegmentCulling::Lanes;
  }

  /// Corners relative to the apex, m.
  SegmentCulling::Corners lanes() const;

  /// Mark the candidates that paths before a surface cannot meet: those wholly below the height
  /// `least`, m, along the normal, those outside the box, and the triangle `own`. @param closed
  /// out: stride() bytes, 0xff for these and beyond size(), else 0
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
