// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamGroup.h
 * @brief Up to sixteen neighbouring beams of one apex descend the wide tree together. The descent
 * ends at boxes, called entry points, from which single beams (Candidates.h) or packets of rays
 * (RayPacket.h) descend further.
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

/// Neighbouring beams of one apex that share entry points.
struct BeamCluster
{
  const std::uint32_t* beams = nullptr; ///< numbers of the beams
  std::size_t count = 0;
  const EntryPoints* entries = nullptr; ///< entry points; null: the whole tree
  std::uint64_t nodesVisited = 0;       ///< number of nodes visited for each beam
};

/// How beams are grouped.
struct GroupRule
{
  std::size_t beamsOfCluster = 1;
  bool sorts = true;      ///< whether neighbours are found; otherwise they follow each other
  bool together = true;   ///< whether groups descend; otherwise no cluster has entry points
  bool evenAlone = false; ///< whether a group of one cluster descends
};

/// Divides beams into groups, and descends with one group after the other. Each thread needs its
/// own object.
class BeamGroups
{
public:
  /// Begin with beams. The caller must keep tree and frames until the last cluster.
  void begin(
    const CollisionTree& tree, const BeamFrame* frames, std::size_t count, const GroupRule& rule);

  /// The next cluster, valid until the next call. Its entry points may be none: then its beams meet
  /// no triangle. The order of clusters is not fixed. @return false after the last cluster
  bool next(BeamCluster& cluster);

  TraversalStack& stack() { return this->Work.stack; }

private:
  /// Neighbouring beams, given by places in Order.
  struct Group
  {
    std::size_t first, count;
  };
  bool descend();

  const CollisionTree* Tree = nullptr;
  const BeamFrame* Frames = nullptr;
  GroupRule Rule;
  std::vector<std::uint32_t> Order; ///< numbers of the beams, neighbours together
  std::vector<Group> Groups;        ///< groups that have not descended yet, the next group last
  Group Now{ 0, 0 };                ///< rest of the group that descended last
  std::size_t Member = 0;           ///< next cluster of this group
  bool HasEntries = false;          ///< whether the clusters of this group have entry points
  std::uint64_t Share = 0;          ///< number of nodes visited for each beam of this group
  GroupWorkspace Work;
  std::vector<std::uint32_t> Stretch; ///< beams of one apex and width
  std::vector<std::uint64_t> Keys;
};

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
