// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamGroup.h
 * @brief Neighbouring beams of one apex go down the folded tree together.
 *
 * The beams of a scan overlap or nearly touch: what one meets, its neighbours meet too, and most
 * meet nothing. A group of up to sixteen goes down once. Eight boxes are tested against the pyramid
 * about the group, sixteen cones against each box that is left; where a box is a leaf, is small
 * beside the beams (sixteen half-beamwidths), or is met by three beams at most, the descent ends,
 * and the box becomes a root for the rays of the beams that meet it (RayPacket.h). A beam without
 * roots hits nothing, and its rays are never drawn.
 *
 * Cost: one test of eight boxes a node, and one of sixteen cones for every box that is met, instead
 * of a descent for each of the group's packets. Roots that are much smaller make long lists where
 * all beams hit; much larger ones leave upper levels to every packet.
 */
#ifndef avianlidar_BeamGroup_h
#define avianlidar_BeamGroup_h

#include "BeamPyramid.h"

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

/// Where the rays of one beam begin: boxes eight at a time, front to back but for overlaps.
struct BeamRoots
{
  std::vector<WideNode> nodes;
  std::vector<float> nearest; ///< lower bound of the ranges in each node, m

  void clear();
  void add(const WideNode& node, int lane, float distance);
  /// A leaf whose volume is not known as a box.
  void addLeaf(std::uint32_t first, std::uint32_t count);

private:
  int nextLane(float distance);

  int Filled = WideNode::Width; ///< lanes of the last node
};

/// Kept between groups, so that none allocates.
struct GroupWorkspace
{
  struct Entry
  {
    std::uint32_t node; ///< parent
    std::uint32_t lane;
    std::uint32_t beams; ///< one bit each
    float nearest;
    bool root; ///< the descent ends here
  };
  ConeLanes cones;
  BeamRoots roots[ConeLanes::Width];
  std::vector<Entry> stack;
};

/// Find the roots of the beams in `work.cones`.
/// @return number of boxes tested against the group; -1 if there is no pyramid about it
std::int64_t findRoots(const WideTree& tree, const Vec3& apex, GroupWorkspace& work);
}

#endif
