// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file VisiblePatch.h
 * @brief Do a few planes fill a beam? The triangles that the whole cone of a beam sees, if they
 * hang together and there is nothing else to be seen in it.
 *
 * The beam is a disc in its own plane (BeamFrame.h), and a triangle there the meeting of three
 * half-planes, its edge functions (TriangleTest.h). Starting from the triangle that a point of the
 * disc sees first, every side that enters the disc must be shared, both end points to the bit, with
 * exactly one triangle on its other side, and so on, over the edge where two planes meet, too.
 * Triangles that are joined so without a side left over cover the disc, every point of it by as
 * many (a covering of a disc has no other choice); as one of them alone covers the point at which
 * the search began, they cover it once. All other triangles that enter the disc must lie behind all
 * of their planes, by more than rounding. Wherever something cannot be told from its opposite there
 * is no patch, and the beam is left to its rays.
 *
 * What happens within `rimOf()`, relative, of the disc's edge is left out of account: it holds less
 * than 1e-9 of the beam's energy (4e-6 at theta0.5 = 1e-9 rad). So the answer depends
 * on the beam and on the triangles that enter this disc, and not on which others are looked at.
 *
 * A plane sends nothing of a beam back to itself, nor do planes of which one lies behind the other:
 * such a beam has direct echoes alone.
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
/// A side that two triangles of a patch share, and that enters the disc.
struct PatchSeam
{
  std::uint8_t one, two; ///< their numbers in the patch
  std::uint8_t side;     ///< of `one`: 0 ab, 1 bc, 2 ca
};

/// What fills a beam. About 180 bytes and 13 a triangle.
struct VisiblePatch
{
  std::vector<PatchPlane> planes; ///< at least one
  double apart = 0.0;  ///< relative: ranges of triangles and of their planes differ by so much
  bool facing = false; ///< light of one plane may go to another: not for two reflections
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

/// Beams that more triangles enter are left to their rays: seldom does one plane fill them, and the
/// search takes time with the square of their number.
constexpr std::size_t MostPatchTriangles = 32;

/// And so are beams that see more planes.
constexpr std::size_t MostPatchPlanes = 4;

/// Reusable without allocation; one per thread.
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

  /// Look at triangles, consecutive ones of the tree's order: all that may enter the cone must be
  /// given, once each, in any order.
  /// @return false if the beam is left to its rays, whatever else it meets
  bool add(const std::uint32_t* triangles, std::uint32_t count);

  /// Null if no planes fill the beam, or if that is not certain.
  std::unique_ptr<VisiblePatch> find();

private:
  /// A triangle that enters the disc.
  struct Candidate
  {
    std::uint32_t triangle;
    Corners corners;
    Vec3 places[3];     ///< of the corners, see BeamFrame::toPlane()
    BeamEdge edges[3];  ///< ab, bc, ca
    bool cut[3];        ///< the line of the side crosses the disc
    bool enters[3];     ///< the side itself does
    int number;         ///< in the patch; NotInPatch
    std::uint8_t plane; ///< if it is in the patch
  };
  static constexpr int NotInPatch = -1;
  bool take(std::size_t position);
  void coverProbes(const BeamEdge* edges);
  void sift();
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
  Vec3 Across[2];      ///< e1 and e2 over tan(theta0.5)
  double Radius = 1.0; ///< of the disc without its rim
  bool Hopeless = false;
  unsigned Covered = 0; ///< probes that some triangle covers, one bit each
  std::vector<Candidate> Candidates;
  std::size_t Sifted = 0;        ///< of the candidates: they do enter
  std::vector<Candidate*> Patch; ///< in the order of the flood
  std::vector<PatchSeam> Seams;
  std::vector<PatchPlane> Planes;
  double Apart = 0.0; ///< see VisiblePatch
};

/// The plane of a triangle, seen from a point.
PatchPlane patchPlane(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin);

/// Width of the rim of a beam that is left out of account, in half-beamwidths.
double rimOf(const BeamFrame& frame);
}

#endif
