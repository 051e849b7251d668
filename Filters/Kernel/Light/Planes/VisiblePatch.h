// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VisiblePatch.h
 * @brief Finds the triangles that fill the whole cone of a beam, if they are connected, lie in a
 * few planes, and nothing stands before them.
 *
 * The beam is a disc in its own plane (BeamFrame.h), a triangle there the intersection of three
 * half-planes, its edge functions (TriangleTest.h). The search begins at the triangle that a point
 * of the disc sees first. Every side that enters the disc must be shared, both end points equal to
 * the bit, with exactly one triangle on its other side, and so on, also over the edge where two
 * planes meet. Triangles so joined without a side left over cover every point of the disc equally
 * often (a covering of a disc has no other choice), and once, as one of them alone covers the point
 * where the search began. All other triangles that enter the disc must lie behind all of their
 * planes, by more than rounding. Wherever a comparison is closer than rounding there is no patch,
 * and the beam is sampled.
 *
 * A plane returns no light of a beam to itself, nor do planes of which one lies behind the other:
 * such a beam has direct echoes alone.
 *
 * Source: none.
 * Valid: at most MostPatchTriangles triangles and MostPatchPlanes planes. The rim of the disc,
 * rimOf() half-beamwidths wide, is not considered; it holds less than 1e-9 of the beam's energy
 * (4e-6 at theta0.5 = 1e-9 rad). So the result depends on the beam and the triangles that enter the
 * rest of the disc alone.
 * Test: TestPlaneIntegrationEdges.cxx, TestSeveralPlanes.cxx, TestPlaneSurfaces.cxx.
 */
#ifndef avianlidar_VisiblePatch_h
#define avianlidar_VisiblePatch_h

#include "BeamFrame.h"
#include "BeamTracer.h"
#include "PlaneDisc.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace avianlidar
{
/// A side shared by two triangles of a patch that enters the disc.
struct PatchSeam
{
  std::uint8_t one, two; ///< numbers of the triangles in the patch
  std::uint8_t side;     ///< of `one`: 0 ab, 1 bc, 2 ca
};

/// Planes and triangles that fill a beam. About 180 bytes and 13 a triangle.
struct VisiblePatch
{
  std::vector<PatchPlane> planes; ///< at least one
  double apart = 0.0;  ///< largest relative difference of ranges of triangles and their planes
  bool facing = false; ///< light may go from one plane to another: not for two reflections
  std::vector<std::uint32_t> triangles; ///< the first is of the first plane
  std::vector<std::uint8_t> planeOf;    ///< of each triangle
  std::vector<PatchSeam> seams;
  std::size_t bytes() const
  {
    return sizeof(VisiblePatch) + this->planes.capacity() * sizeof(PatchPlane) +
      this->triangles.capacity() * sizeof(std::uint32_t) + this->planeOf.capacity() +
      this->seams.capacity() * sizeof(PatchSeam);
  }
};

/// Beams that more triangles enter are sampled: one plane seldom fills them, and the time of the
/// search grows with the square of their number.
constexpr std::size_t MostPatchTriangles = 32;

/// Beams that meet more planes are sampled.
constexpr std::size_t MostPatchPlanes = 4;

/// Finds the patch of one beam after the other. Reusable without allocation; one per thread.
class PatchFinder
{
public:
  /// @param tree must outlive it
  explicit PatchFinder(const CollisionTree& tree)
    : Tree(tree)
    , Mesh(*tree.mesh)
  {
  }

  /// Begin a beam.
  void begin(const BeamFrame& frame);

  /// Add triangles, consecutive ones of the tree's order. All that may enter the cone must be
  /// added, once each, in any order. @return false if there is no patch, whatever else the beam
  /// meets
  bool add(const std::uint32_t* triangles, std::uint32_t count);

  /// Null if no planes fill the beam, or if that is not certain.
  std::unique_ptr<VisiblePatch> find();

private:
  /// A triangle that enters the disc.
  struct Candidate
  {
    std::uint32_t triangle;
    Corners corners;
    Vec3 places[3];     ///< corners by BeamFrame::toPlane()
    BeamEdge edges[3];  ///< ab, bc, ca
    bool cut[3];        ///< the line of the side crosses the disc
    bool enters[3];     ///< the side itself enters the disc
    int number;         ///< in the patch; NotInPatch
    std::uint8_t plane; ///< its plane, if it is in the patch
  };
  static constexpr int NotInPatch = -1;
  bool take(std::size_t position);
  void coverProbes(const BeamEdge* edges);
  void cull();
  bool enters(Candidate& candidate) const;
  bool isBeside(const Vec3* places) const;
  bool sideEnters(const Vec3& pa, const Vec3& pb, const BeamEdge& edge) const;
  Candidate* firstSeen(double x, double y);
  bool flood(Candidate& first);
  void join(Candidate& one, int side, Candidate& two);
  Candidate* across(const Candidate& from, int side);
  static double slackOf(const Candidate& candidate, double x, double y);
  bool fillsFrom(double x, double y);
  bool coversOnce(double x, double y) const;
  bool findPlane(Candidate& candidate);
  bool liesIn(const PatchPlane& plane, const PatchPlane& own);
  bool isFacing(std::size_t one, std::size_t two) const;
  bool liesBehind(const PatchPlane& plane, std::size_t other) const;
  bool liesBehind(const PatchPlane& plane, const Candidate& candidate) const;

  const CollisionTree& Tree;
  const TriangleMesh& Mesh;
  BeamFrame Frame;
  BeamPlaneMap Map{ BeamFrame() };
  Vec3 Across[2];      ///< e1 and e2 divided by tan(theta0.5)
  double Radius = 1.0; ///< of the disc without its rim
  bool Hopeless = false;
  unsigned Covered = 0; ///< probe points that some triangle covers, one bit each
  std::vector<Candidate> Candidates;
  std::size_t Kept = 0;          ///< first candidates, known to enter the disc
  std::vector<Candidate*> Patch; ///< in the order of the flood
  std::vector<PatchSeam> Seams;
  std::vector<PatchPlane> Planes;
  double Apart = 0.0; ///< see VisiblePatch
};

/// The plane of a triangle, relative to an apex.
PatchPlane patchPlane(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin);

/// Width of the rim of a beam that is not considered, in half-beamwidths.
double rimOf(const BeamFrame& frame);
}

#endif
