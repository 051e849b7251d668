// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamGroup.h
 * @brief Up to sixteen neighbouring beams of one apex descend the wide tree together. The descent
 * ends at boxes, called entry points, from which packets of rays descend further (RayPacket.h).
 *
 * Eight boxes are tested against the planes about the group. Each box that is left is then tested
 * against sixteen cones (BoxTests.h). The descent ends at a box that is a leaf, at a box whose half
 * diagonal is at most sixteen half-beamwidths, and at a box that at most three beams meet. A beam
 * without entry points hits no triangle, so the beam's rays are not drawn. If entry points were
 * smaller, lists of entry points would be long where all beams hit triangles. If entry points were
 * larger, every packet would descend the upper levels of the tree.
 *
 * Source: batch collision detection (paper, Sec. 3.2); Z-order curve: Morton, "A Computer Oriented
 * Geodetic Data Base and a New Technique in File Sequencing", 1966.
 * Differs: the paper descends once for the rays of a beam, down to the triangles, as
 * findPotential() does. A group descends once for the rays of sixteen beams, and only down to entry
 * points.
 * Valid: conservative: every triangle that a ray hits lies in the entry points of the ray's beam. A
 * group whose beams lie too far apart (ConeLanes::setFrustum()) is halved.
 * Test: TestBeamGroup.cxx, TestBeamTracer.cxx.
 */
#ifndef avianlidar_BeamGroup_h
#define avianlidar_BeamGroup_h

#include "BoxTests.h"
#include "CollisionTree.h"
#include "Traversal.h"
#include "WideTree.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// True if two beams have equal apexes and equal widths, so that the beams may descend together.
inline bool areTogether(const BeamFrame& one, const BeamFrame& two)
{
  return one.origin == two.origin && one.halfBeamwidth == two.halfBeamwidth;
}

/// Order beams, given by number, so that consecutive beams are neighbours: along a Z-order curve
/// over the two coordinates in which the beams' axes differ most. `keys` is workspace.
void orderBeams(
  const BeamFrame* frames, std::vector<std::uint32_t>& beams, std::vector<std::uint64_t>& keys);

/// Workspace kept between groups, so that no group allocates.
struct GroupWorkspace
{
  ConeLanes cones;
  EntryPoints entryPoints[ConeLanes::Width];
  TraversalStack stack;
};

/// Find the entry points of the beams in `work.cones`.
/// @return number of boxes tested; -1 if the beams lie too far apart
std::int64_t findEntryPoints(const WideTree& tree, const Vec3& apex, GroupWorkspace& work);

/// Result of the descent of one cone.
struct PotentialTriangles
{
  std::uint64_t nodesVisited = 0;
  std::size_t count = 0; ///< number of triangles; above `most` the search was stopped
};

/// The triangles that the cone of one beam may meet (S_potential of the paper, Sec. 3.2), as entry
/// points. @param most number of triangles beyond which the search stops
PotentialTriangles findPotential(const CollisionTree& tree, const BeamFrame& frame,
  std::size_t most, EntryPoints& entryPoints, TraversalStack& stack);
}

#endif
