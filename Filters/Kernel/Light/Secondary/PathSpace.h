// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathSpace.h
 * @brief Lists the triangles that paths on from the hits of a beam may meet, so that most paths
 * need no descent of the tree.
 *
 * The mirror paths of all rays on one surface fill a box before its plane and inside the cone; the
 * connections of two surfaces fill the box around their hits. One descent of the tree for the box
 * around all paths of a beam finds the triangles that reach into it and the cone
 * (PathCandidates.h). Those wholly behind the plane of a surface are excluded for all its paths at
 * once; before most facades none is left. Codes of the paths' ends exclude most of the others
 * (SegmentCulling.h). What is left, mostly what a path hits, is tested exactly, at a tenth of the
 * cost of a descent for each path.
 *
 * Source: none.
 * Valid: conservative: a triangle that is not listed would not have been met. The lists depend on
 * the scene alone, not on the tree. A descent that examines too many triangles is given up, as for
 * ground seen at grazing incidence; only whether that happens depends on the tree.
 * Test: TestPathSpace.cxx.
 */
#ifndef avianlidar_PathSpace_h
#define avianlidar_PathSpace_h

#include "BeamSamples.h"
#include "CollisionTree.h"
#include "PathCandidates.h"
#include "SecondaryTrace.h"
#include "SegmentCulling.h"
#include "Traversal.h"

#include <vector>

namespace avianlidar
{
/// Upper bound of the distance, m, for which a path from `point`, at `range`, stays inside the
/// cone; infinity for directions within the cone's own, or nearly. All relative to the apex.
double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction);

/// Candidates of one beam after the other. Reusable without allocation; one per thread.
class PathSpace
{
public:
  /// The triangles that a path may meet. Valid until the next call.
  using Candidates = std::vector<std::uint32_t>;

  /// Begin a beam.
  void beginBeam() { this->Gathered = false; }

  /// Find the triangles before the surfaces of the geometry, for ofMirror().
  void lookBefore(const CollisionTree& tree, const BeamFrame& frame, const BeamSamples& hits,
    const SampleGeometry& geometry);
  /// Triangles that the mirror path of a hit may meet inside the cone; null if not known.
  const Candidates* ofMirror(std::size_t hit);
  /// True if the mirror path of a hit is known to meet nothing.
  bool isKnownFree(std::size_t hit) const { return this->Mirrors[hit] == Knowledge::Free; }

  /// Find the triangles between the hits of connections, for ofConnection().
  void lookBetween(const CollisionTree& tree, const BeamFrame& frame, const BeamSamples& hits,
    const SampleGeometry& geometry, const SecondaryConnections& connections);
  /// Triangles that may stand between the hits of a connection; null if not known.
  const Candidates* ofConnection(std::size_t connection);

private:
  /// Height above a surface below which no path meets anything, m, and the box of its paths
  /// relative to the apex.
  struct Reach
  {
    double least;
    AABB box;
  };
  enum class Knowledge : std::uint8_t
  {
    Nothing,   ///< descend the tree
    Free,      ///< it meets nothing
    Candidates ///< use the culling
  };
  void beginLook(const BeamSamples& hits, const SampleGeometry& geometry, const BeamFrame& frame);
  void look(const CollisionTree& tree, const AABB& box, std::size_t paths);
  void closeOutOfReach();
  void beginCodes(std::size_t points);
  const std::uint8_t* codeOf(std::size_t point, const std::uint8_t* closed);
  const Candidates& meeting(std::size_t point1, std::size_t point2, const std::uint8_t* closed1,
    const std::uint8_t* closed2);
  const std::uint8_t* closedOf(std::uint32_t surface) const
  {
    return this->Closed.data() + surface * this->Stride;
  }

  const BeamSamples* Hits = nullptr;
  const SampleGeometry* Geometry = nullptr;
  const SecondaryConnections* Connections = nullptr;
  const BeamFrame* Frame = nullptr;
  bool Known = false;
  bool Gathered = false; ///< Near holds all that reaches into the next
  AABB GatheredBox;
  bool Culled = false;        ///< the culling is that of Near
  std::vector<Reach> Reaches; ///< by surface
  PathCandidates Near;
  SegmentCulling Culling;
  std::size_t Stride = 0;
  std::vector<std::uint8_t> Closed; ///< by surface: of each candidate, whether it is out of reach
  std::vector<char> Open;           ///< by surface: any candidate is within reach
  std::vector<std::uint8_t> Codes;  ///< by point: hits, then ends of mirror paths
  std::vector<char> Coded;          ///< by point
  std::vector<SegmentCulling::Point> Points; ///< as far as they are coded
  std::vector<std::uint8_t> Missed;          ///< by candidate
  std::vector<Knowledge> Mirrors;            ///< by hit
  std::vector<double> EndX, EndY, EndZ;      ///< of mirror paths relative to the apex, m
  Candidates Found;
  TraversalStack Stack;
};
}

#endif
