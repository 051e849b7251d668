// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MirrorPairs.h
 * @brief Finds the surfaces of a beam from which mirror paths may arrive. No path is traced from
 * the other surfaces.
 *
 * A triangle makes a pair with a surface if bounds do not exclude that
 *
 * 1. the beam's cone meets the triangle's plane in front of the plane of the surface, and the
 *    pyramid around the cone meets the triangle;
 * 2. a part of the triangle lies in front of the plane of the surface;
 * 3. hits of the surface lie in front of the side of the triangle that faces the apex.
 *
 * One descent of the cone, up to the farthest surface, finds the triangles. Paths from a surface
 * without a pair return no light, whatever the materials are.
 *
 * Source: paper, Sec. 3.4, the beam constraint, applied to whole surfaces.
 * Differs: the paper tests each ray.
 * Valid: conservative: no path from a surface without pairs arrives. A surface that the cone's edge
 * grazes counts as having a pair. In a beam that meets more than two triangles per sample, all
 * surfaces count as having pairs.
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
/// Finds the pairs of one beam after the other, without allocation for each beam. Each thread needs
/// its own object.
class MirrorPairs
{
public:
  /// Find the surfaces of the samples (SampleGeometry) that have pairs.
  void find(const SecondaryBeam& beam);

  /// True if a mirror path from the surface may arrive.
  bool any(std::uint32_t surface) const { return this->Starts[surface].paired; }

private:
  /// Start of the mirror paths of a surface.
  struct Start
  {
    Vec3 normal;     ///< unit normal of the plane, towards the apex
    double height;   ///< height of the apex above the plane, m
    double farthest; ///< bound of the distance from the apex at which paths end, m
    double least;    ///< lower bound of the height above the plane at which paths end, m
    double off;      ///< largest distance of a hit from the plane, m
    AABB hits;       ///< box around the hits, relative to the apex, m
    bool paired;     ///< true once a path may arrive
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
