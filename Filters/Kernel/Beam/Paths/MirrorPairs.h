// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MirrorPairs.h
 * @brief Which surfaces of a beam face a triangle that mirror paths from them may end on. From the
 * others no path is traced.
 *
 * A triangle makes a pair with a surface if, as far as bounds can tell,
 *
 * 1. the beam's cone meets its plane before the plane of the surface, and the pyramid around the
 *    cone meets the triangle;
 * 2. a part of it lies before the plane of the surface;
 * 3. hits of the surface lie before the side of the triangle that faces the apex.
 *
 * One descent of the cone finds the triangles, as far as the cone lies before a surface. Without a
 * pair the bound of what comes back is 0, whatever the materials.
 *
 * Source: paper, Sec. 3.4, the beam constraint, for a surface at once.
 * Differs: the paper looks at each ray.
 * Valid: conservative: a path from a surface without pairs does not arrive. Surfaces that the
 * cone's edge grazes, and all of a beam that meets many triangles for each of its samples, count as
 * having pairs.
 * Test: TestMirrorPairs.cxx, TestSecondaryConstraints.cxx.
 */
#ifndef avianlidar_MirrorPairs_h
#define avianlidar_MirrorPairs_h

#include "AABB.h"
#include "SecondaryBeam.h"
#include "Traversal.h"
#include "TriangleTest.h"

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Finds the pairs of one beam after the other. Reusable without allocation; one per thread.
class MirrorPairs
{
public:
  /// Find the surfaces of the samples (SampleGeometry) that have pairs.
  void find(const SecondaryBeam& beam);

  /// True if a mirror path from the surface may arrive.
  bool any(std::uint32_t surface) const { return this->Starts[surface].paired; }

private:
  /// Where the mirror paths of a surface start.
  struct Start
  {
    Vec3 normal;     ///< of the plane, towards the apex
    double height;   ///< of the apex above the plane, m
    double farthest; ///< m, from the apex: all paths end nearer
    double least;    ///< m, above the plane: all paths end higher
    double off;      ///< m, largest distance of a hit from the plane
    AABB hits;       ///< relative to the apex
    bool paired;
  };
  class Search;
  double measure(const SecondaryBeam& beam);
  bool facing(const Start& start, const BeamFrame& frame, const Corners& corners,
    const TrianglePlane& plane, double reach) const;

  std::vector<Start> Starts;
  TraversalStack Stack;
};
}

#endif
