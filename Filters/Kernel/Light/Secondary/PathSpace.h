// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PathSpace.h
 * @brief What paths on from the hits of a beam may meet.
 *
 * Most facades have nothing before them within the cone: the mirror paths of all rays that hit one
 * fill a small space, bounded by the cone, before its plane. Likewise the connections of two walls
 * of a corner fill the space between them. One descent of the tree for the box around the paths of
 * a beam finds the triangles that reach into it and the cone. Those that lie wholly behind the
 * planes of a surface are told from those before it, for all its paths at once, and of the rest
 * most by codes of the paths' ends (SegmentCulling.h). What is left, mostly what a path hits, is
 * tested exactly: that costs a tenth of a descent for each path. Where a descent looks at too many
 * triangles, as in a space as long as the ground seen at grazing angle, it is given up.
 *
 * The lists err on the side of more: what is not in them no path would have met. Their triangles
 * depend on the scene alone, not on the tree; only whether a space is given up as too full does.
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
/// How far a path from `point` inside the cone, at `range`, stays in it, m, rather too long than
/// too short; infinity for directions within the cone's own, or nearly. All relative to the apex.
double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction);

/// Reusable without allocation; one per thread.
class PathSpace
{
public:
  /// The triangles that a path may meet. Stands until the next question.
  using Candidates = std::vector<std::uint32_t>;

  /// Begin a beam: what was gathered for the last one is not used again.
  void beginBeam() { this->Gathered = false; }

  /// Look before the surfaces of the geometry: call ofMirror() afterwards.
  void lookBefore(const CollisionTree& tree, const BeamFrame& frame, const BeamSamples& hits,
    const SampleGeometry& geometry);
  /// What the mirror path of a hit may meet while it is in the cone; null if that is not known.
  const Candidates* ofMirror(std::size_t hit);
  /// The same without a list: true if it is known to meet nothing; false says nothing.
  bool isKnownFree(std::size_t hit) const { return this->Mirrors[hit] == Knowledge::Free; }

  /// Look between the hits of connections: call ofConnection() afterwards.
  void lookBetween(const CollisionTree& tree, const BeamFrame& frame, const BeamSamples& hits,
    const SampleGeometry& geometry, const SecondaryConnections& connections);
  /// What may stand between the hits of a connection; null if that is not known.
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
    Nothing,   ///< descend
    Free,      ///< it meets nothing
    Candidates ///< ask the culling
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
