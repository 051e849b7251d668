// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamGroup.h
 * @brief Neighbouring beams of one apex go down the wide tree together.
 *
 * The beams of a scan overlap or nearly touch: what one meets, its neighbours meet too, and most
 * meet nothing. A group of up to sixteen goes down once. Eight boxes are tested against the pyramid
 * about the group, sixteen cones against each box that is left; where a box is a leaf, is small
 * beside the beams (sixteen half-beamwidths), or is met by three beams at most, the descent ends,
 * and the box becomes a root for the rays of the beams that meet it (RayPacket.h). A beam without
 * entry points hits nothing, and its rays are never drawn.
 *
 * Cost: one test of eight boxes a node, and one of sixteen cones for every box that is met, instead
 * of a descent for each of the group's packets. Entry points that are much smaller make long lists
 * where all beams hit; much larger ones leave upper levels to every packet.
 */
#ifndef avianlidar_BeamGroup_h
#define avianlidar_BeamGroup_h

#include "BeamPyramid.h"
#include "CollisionTree.h"
#include "EntryPoints.h"
#include "Traversal.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Order beams, given by their numbers, so that any consecutive ones are neighbours: along a
/// Z-order curve (Morton, "A Computer Oriented Geodetic Data Base and a New Technique in File
/// Sequencing", 1966) over the two coordinates in which their axes differ most. `keys` is
/// workspace.
void orderBeams(
  const BeamFrame* frames, std::vector<std::uint32_t>& beams, std::vector<std::uint64_t>& keys);

/// Kept between groups, so that none allocates.
struct GroupWorkspace
{
  ConeLanes cones;
  EntryPoints entryPoints[ConeLanes::Width];
  TraversalStack stack;
};

/// Find the entry points of the beams in `work.cones`.
/// @return number of boxes tested against the group; -1 if there is no pyramid about it
std::int64_t findEntryPoints(const WideTree& tree, const Vec3& apex, GroupWorkspace& work);

/// What a descent of one cone has found.
struct PotentialTriangles
{
  std::uint64_t nodesVisited = 0;
  std::size_t count = 0; ///< triangles; more than asked for: given up
};

/// The triangles that the cone of one beam may meet (S_potential of the paper, Sec. 3.2), as entry
/// points.
/// @param most beyond so many the search is given up
PotentialTriangles findPotential(const CollisionTree& tree, const BeamFrame& frame,
  std::size_t most, EntryPoints& entryPoints, TraversalStack& stack);
}

#endif
