// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Candidates.h
 * @brief First step of tracing a block: finds the triangles that the cone of each beam may meet.
 *
 * All surfaces that a beam can meet lie in the beam's cone. The cone is convex, so surfaces of the
 * second reflection and surfaces that hide other surfaces lie in the cone, too. Neighbouring beams
 * of one apex descend the tree together (BeamGroup.h). From the entry points of a group, each beam
 * descends by itself, down to the leaves. Triangles of movers that the beam may meet are then
 * appended. The descents end at a range, beyond which nothing matters.
 *
 * Source: paper, Sec. 3.2, where the list is called S_potential.
 * Differs: the paper descends for each beam from the root.
 * Valid: each list holds every triangle that a ray of the beam may hit in the range. The list may
 * hold other triangles, too, but no triangle twice. Which of the triangles that enter the beam are
 * in the list does not depend on the tree.
 * Test: TestBeamGroup.cxx, TestScan.cxx.
 */
#ifndef avianlidar_Candidates_h
#define avianlidar_Candidates_h

#include "BeamGroup.h"
#include "SceneTriangles.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Finds the candidates of the beams of a block, one beam after the other, without allocation for
/// each beam. Each thread needs its own object.
class BeamCandidates
{
public:
  /// Begin a block. The caller must keep scene and frames until the last beam of the block.
  /// @param count number of beams; 1 if movers are placed
  /// @param together false: each beam descends by itself from the root
  void begin(
    const SceneTriangles& scene, const BeamFrame* frames, std::size_t count, bool together);

  /// Go on to the next beam whose cone may meet a triangle. The order of beams is not fixed.
  /// @return false after the last beam
  bool next();

  // The current beam.
  std::size_t beam() const { return this->Beam; } ///< number of the beam in the block
  /// The triangles that the cone may meet within a range, m; may be empty. Triangles without a
  /// point in the range are left out.
  const std::vector<std::uint32_t>& collect(double range);
  /// Upper bound of the ranges of the scene, m.
  double farthest() const;
  /// Number of nodes visited so far, with the beam's share of the nodes that its group visited.
  std::uint64_t nodesVisited() const { return this->NodesVisited; }

private:
  const SceneTriangles* Scene = nullptr;
  const CollisionTree* Tree = nullptr;
  const BeamFrame* Frames = nullptr;
  BeamGroups Groups;
  std::size_t Beam = 0;
  const EntryPoints* Entries = nullptr; ///< entry points of the beam; null: the root
  std::vector<std::uint32_t> Triangles;
  std::uint64_t NodesVisited = 0;
};
}

#endif
