// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTracer.h"

#include "BeamRayTracer.h"
#include "Descents.h"
#include "TriangleTest.h"

#include <algorithm>

namespace avianlidar
{
struct BeamTracer::Workspace
{
  TraversalStack stack;
  BeamRayWorkspace rays;
};

void addCounters(const TraceCounters& more, TraceCounters& sum)
{
  sum.nodesVisited += more.nodesVisited;
  sum.raysTraced += more.raysTraced;
  sum.candidates = std::max(sum.candidates, more.candidates);
}

std::size_t beamsPerBlock(int raysPerBeam)
{
  constexpr int FewRays = 16;
  constexpr int RaysOfBlock = 12800;
  return static_cast<std::size_t>(
    std::clamp(RaysOfBlock / raysPerBeam, 1, raysPerBeam < FewRays ? 1024 : 128));
}

BeamTracer::BeamTracer(const SceneTriangles& scene)
  : Scene(scene)
  , Work(std::make_unique<Workspace>())
{
}

BeamTracer::~BeamTracer() = default;

void BeamTracer::setBeam(const BeamFrame& frame)
{
  this->Frame = frame;
  this->Counters = {};
}

const TracedHits& BeamTracer::traceBeams(const TracedBeams& beams, TraceMode mode)
{
  BeamRayWorkspace& work = this->Work->rays;
  work.found.triangles.assign(beams.size, nullptr);
  work.found.counters.assign(beams.size, TraceCounters());
  for (TraceCounters& counters : work.found.counters)
  {
    counters.raysTraced = beams.rays;
  }
  work.triangles.resize(std::max(work.triangles.size(), beams.size * beams.rays));
  work.used = 0;
  if (!this->Scene.tree().empty() && beams.size > 0)
  {
    BeamRayTracer(this->Scene, beams, work).trace(mode);
  }
  if (!this->Scene.moved().empty() && beams.size > 0)
  {
    this->traceMoved(beams);
  }
  return work.found;
}

/// Find the rays of the single beam that hit movers before anything else.
void BeamTracer::traceMoved(const TracedBeams& beams)
{
  BeamRayWorkspace& work = this->Work->rays;
  const BeamFrame& frame = beams.frames[0];
  const BeamRays& rays = beams.raysOf(0);
  const BeamPlaneMap map(frame);
  BeamRayVisitor visitor(this->Scene, frame, map);
  std::uint32_t* const triangles = work.triangles.data();
  if (!work.found.triangles[0])
  {
    std::fill(triangles, triangles + rays.size(), NoTriangle);
  }
  bool any = false;
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    const Vec3 direction = unitDirection(frame.direction(rays.x[i], rays.y[i]));
    Hit hit;
    if (triangles[i] != NoTriangle)
    {
      hit = { triangles[i],
        rangeOnTriangle(seeTriangle(this->Scene, triangles[i], frame.origin), frame, direction) };
    }
    visitor.setRay(rays.x[i], rays.y[i], direction, hit);
    work.found.counters[0].nodesVisited += visitMoved(this->Scene, frame.origin, Vec3(0.0),
      direction, HitMarginBeam * frame.tanHalf, visitor, this->Work->stack);
    triangles[i] = hit.triangle;
    any = any || hit.valid();
  }
  work.found.triangles[0] = any ? triangles : nullptr;
  work.found.counters[0].candidates += this->Scene.moved().size();
}

Hit BeamTracer::traceFromApex(const Vec3& direction)
{
  return this->traceFrom(Vec3(0.0), direction, 0.0, NoTriangle);
}

Hit BeamTracer::traceFrom(const Vec3& origin, const Vec3& direction, double minimumRange,
  std::uint32_t ignore, double maximumRange)
{
  const Vec3 d = unitDirection(direction);
  // From the apex, the ranges must equal, bit for bit, the ranges of the beam's rays.
  const double margin = origin == Vec3(0.0) ? beamRayMargin(this->Frame) : 0.0;
  FreeRayVisitor visitor(this->Scene, this->Frame.origin, origin, d, margin);
  visitor.minimum = minimumRange;
  visitor.maximum = maximumRange;
  visitor.ignore1 = ignore;
  this->search(visitor, origin, d, margin);
  return visitor.nearest;
}

bool BeamTracer::occluded(
  const Vec3& from, const Vec3& to, double margin, std::uint32_t ignore1, std::uint32_t ignore2)
{
  const Vec3 between = to - from;
  const double length = safeLength(between);
  if (!(length > 2.0 * margin))
  {
    return false;
  }
  const Vec3 d = unitDirection(between);
  FreeRayVisitor visitor(this->Scene, this->Frame.origin, from, d, 0.0);
  visitor.minimum = margin;
  visitor.maximum = length - margin;
  visitor.ignore1 = ignore1;
  visitor.ignore2 = ignore2;
  visitor.anyHit = true;
  this->search(visitor, from, d, 0.0);
  return visitor.nearest.valid();
}

template <class Visitor>
void BeamTracer::search(Visitor& visitor, const Vec3& origin, const Vec3& d, double margin)
{
  ++this->Counters.raysTraced;
  const CollisionTree& tree = this->Scene.tree();
  if (!tree.empty())
  {
    this->Counters.nodesVisited +=
      descendRay(tree, this->Frame.origin, origin, d, margin, visitor, this->Work->stack);
  }
  this->Counters.nodesVisited +=
    visitMoved(this->Scene, this->Frame.origin, origin, d, margin, visitor, this->Work->stack);
}

SeenTriangle seeTriangle(const SceneTriangles& scene, std::uint32_t triangle, const Vec3& origin)
{
  SeenTriangle seen;
  seen.corners = scene.cornersFrom(triangle, origin);
  seen.plane = scene.planeOf(triangle, seen.corners, origin);
  if (seen.plane.normal != Vec3(0.0))
  {
    seen.normal = (seen.plane.height > 0.0 ? -1.0 : 1.0) * unitDirection(seen.plane.normal);
    const Vec3 onPlane = scene.corner(scene.planeOwner(triangle), 0) - origin;
    seen.height = -glm::dot(seen.normal, onPlane);
  }
  return seen;
}

double rangeOnTriangle(const SeenTriangle& triangle, const BeamFrame& frame, const Vec3& d)
{
  const double range = rangeOf(triangle.corners, triangle.plane, d, beamRayMargin(frame));
  return range > 0.0 ? range : triangle.plane.height / glm::dot(triangle.plane.normal, d);
}
}
