// SPDX-License-Identifier: BSD-3-Clause
// Traces the rays of one beam, with their ranges, as the simulation traces blocks of beams.
#ifndef OneBeamTracer_h
#define OneBeamTracer_h

#include "BeamTracer.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Range on a triangle that the ray (x, y) hits, m; on the plane that faces share which coincide.
inline double rangeOnTriangle(
  const CollisionTree& tree, std::uint32_t triangle, const BeamFrame& frame, double x, double y)
{
  const SeenTriangle seen = seeTriangle(SceneTriangles(tree), triangle, frame.origin);
  return rangeOnTriangle(seen, frame, unitDirection(frame.direction(x, y)));
}

/// Hits of the rays of a beam. @param triangles that the rays hit; null: none hits anything
inline std::vector<Hit> hitsOf(const CollisionTree& tree, const BeamFrame& frame,
  const BeamRays& rays, const std::uint32_t* triangles)
{
  std::vector<Hit> hits(rays.size());
  for (std::size_t n = 0; triangles && n < hits.size(); ++n)
  {
    if (triangles[n] != NoTriangle)
    {
      hits[n] = { triangles[n], rangeOnTriangle(tree, triangles[n], frame, rays.x[n], rays.y[n]) };
    }
  }
  return hits;
}

/// A scene without movers, made before the tracer that needs it.
struct OwnScene
{
  SceneTriangles scene;
};

class OneBeamTracer
  : private OwnScene
  , public BeamTracer
{
public:
  explicit OneBeamTracer(const CollisionTree& tree)
    : OwnScene{ SceneTriangles(tree) }
    , BeamTracer(this->scene)
    , Descended(tree)
  {
  }

  /// Begin a beam: set the frame, and the counters to 0.
  void setBeam(const BeamFrame& frame)
  {
    BeamTracer::setBeam(frame);
    this->Frame = frame;
    this->OfRays = {};
  }

  /// Nearest hit of every ray.
  void trace(const BeamRays& rays, TraceMode mode, std::vector<Hit>& hits)
  {
    const auto count = static_cast<std::uint32_t>(rays.size());
    DrawnRays given(&rays);
    const TracedBeams block{ &this->Frame, 1, count, &given };
    const TracedHits& found = this->traceBeams(block, mode);
    hits = hitsOf(this->Descended, this->Frame, rays, found.triangles[0]);
    this->OfRays.nodesVisited += found.counters[0].nodesVisited;
    this->OfRays.raysTraced += found.counters[0].raysTraced;
    this->OfRays.candidates = std::max(this->OfRays.candidates, found.counters[0].candidates);
  }

  TraceCounters counters() const
  {
    TraceCounters sum = this->OfRays;
    sum.nodesVisited += BeamTracer::counters().nodesVisited;
    sum.raysTraced += BeamTracer::counters().raysTraced;
    return sum;
  }

private:
  const CollisionTree& Descended;
  BeamFrame Frame;
  TraceCounters OfRays;
};
}

#endif
