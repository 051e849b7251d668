// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file BeamTracer.h
 * @brief Finds the nearest hits of the rays of beams.
 *
 * Acceptance and range of a (ray, triangle) pair come from one function (TriangleTest.h). The hit
 * is the accepted triangle of least range. Among triangles at equal ranges, the hit is the triangle
 * with the lowest number. A hit is therefore bitwise identical for any tree and any TraceMode. All
 * geometry is moved to the beam's origin in double precision before anything is rounded.
 *
 * Source: paper, Sec. 3.2-3.4.
 * Differs: beams and rays descend in groups and packets (BeamGroup.h, RayPacket.h).
 * TraceMode::Beams is the paper's batch.
 * Valid: as TriangleTest.h. Moving a scene to UTM or ECEF coordinates changes ranges by at most a
 * micrometre, except at grazing incidence.
 * Test: TestBeamTracer.cxx, TestWatertight.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_BeamTracer_h
#define avianlidar_BeamTracer_h

#include "BeamFrame.h"
#include "DrawnRays.h"
#include "EchoSettings.h"
#include "SceneTriangles.h"
#include "TriangleTest.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace avianlidar
{
struct Hit
{
  std::uint32_t triangle = NoTriangle;
  double range = std::numeric_limits<double>::infinity(); ///< distance along the ray, m
  bool valid() const { return this->triangle != NoTriangle; }
};

/// Cost counters of one beam.
struct TraceCounters
{
  std::uint64_t nodesVisited = 0;
  /// Number of triangles tested, counted once per packet of rays; 0 if every ray descends by
  /// itself.
  std::uint64_t candidates = 0;
  std::uint64_t raysTraced = 0; ///< number of primary rays, mirror rays and visibility segments
};

/// Add costs of one beam to a sum of costs of this beam. The sum takes the larger value of
/// `candidates`.
void addCounters(const TraceCounters& more, TraceCounters& sum);

/// Beams that are traced together.
struct TracedBeams
{
  const BeamFrame* frames = nullptr;
  std::size_t size = 0;   ///< number of beams
  std::uint32_t rays = 0; ///< rays per beam, at least 1
  /// Rays of the beams. Rays are drawn only if a triangle may meet the beam.
  DrawnRays* drawn = nullptr;
  const std::size_t* numbers = nullptr; ///< numbers of the beams in `drawn`; null: 0, 1, ...
  bool inOrder = false; ///< whether packets take the rays in the order in which the rays come

  const BeamRays& raysOf(std::size_t beam) const
  {
    return this->drawn->of(this->numbers ? this->numbers[beam] : beam);
  }
};

/// Number of beams in a block, 1 to 1024: enough neighbours to be traced together, and few enough
/// for the block's rays and hits to fit into the cache. @param raysPerBeam at least 1
std::size_t beamsPerBlock(int raysPerBeam);

/// Triangles that the rays of some beams hit. Ranges are found where they are used (RaySamples.h).
struct TracedHits
{
  /// By beam: nearest triangle of each ray, or NoTriangle; null if no ray of the beam hits a
  /// triangle.
  std::vector<const std::uint32_t*> triangles;
  std::vector<TraceCounters> counters; ///< cost of each beam
};

/// Traces the rays of beams, and single rays of the current beam. Each thread needs its own object.
/// The scene must outlive the object.
class BeamTracer
{
public:
  explicit BeamTracer(const SceneTriangles& scene);
  ~BeamTracer();
  BeamTracer(const BeamTracer&) = delete;
  BeamTracer& operator=(const BeamTracer&) = delete;

  /// Begin a beam: set the frame, and set the counters to 0.
  void setBeam(const BeamFrame& frame);

  /// Find the nearest triangle of every ray of some beams. Neighbouring beams of one apex are
  /// traced together. Where movers are placed, there must be one beam. The current beam
  /// and the beam's counters do not change. The result is valid until the next call.
  const TracedHits& traceBeams(const TracedBeams& block, TraceMode mode);

  /// Nearest hit along `direction` (of any length above 0) from the apex of the current beam.
  Hit traceFromApex(const Vec3& direction);

  /// Nearest hit of the ray from `origin` (relative to the apex, m) along `direction` (of any
  /// length above 0) at ranges greater than `minimumRange`, ignoring the triangle `ignore`. Hits
  /// beyond `maximumRange` may be missed. Ranges are in metres along the normalised direction.
  Hit traceFrom(const Vec3& origin, const Vec3& direction, double minimumRange,
    std::uint32_t ignore, double maximumRange = std::numeric_limits<double>::infinity());

  /// True if a triangle other than `ignore1` and `ignore2` crosses the segment between the points
  /// (relative to the apex) at more than `margin` metres from either end.
  bool occluded(
    const Vec3& from, const Vec3& to, double margin, std::uint32_t ignore1, std::uint32_t ignore2);

  const TraceCounters& counters() const { return this->Counters; }

private:
  struct Workspace;
  template <class Visitor>
  void search(Visitor& visitor, const Vec3& origin, const Vec3& direction, double margin);

  void traceMoved(const TracedBeams& block);

  const SceneTriangles& Scene;
  BeamFrame Frame;
  TraceCounters Counters;
  std::unique_ptr<Workspace> Work;
};

/// A triangle relative to a beam's apex, prepared for the ranges of the beam's rays.
struct SeenTriangle
{
  Corners corners;     ///< corners relative to the apex, m
  TrianglePlane plane; ///< plane, shared by faces that coincide (CoincidentFaces.h)
  Vec3 normal{ 0.0 };  ///< unit normal towards the apex; 0 if degenerate
  double height = 0.0; ///< height of the apex above the plane, m
};
SeenTriangle seeTriangle(const SceneTriangles& scene, std::uint32_t triangle, const Vec3& origin);

/// Range, m, of the ray along the unit direction `d` on a triangle that the ray hits.
double rangeOnTriangle(const SeenTriangle& triangle, const BeamFrame& frame, const Vec3& d);
}

#endif
