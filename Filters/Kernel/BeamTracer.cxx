// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTracer.h"

#include "BeamVolumeTest.h"
#include "TraceVisitors.h"
#include "Traversal.h"
#include "TriangleTest.h"

#include <algorithm>
#include <variant>

namespace avianlidar
{
struct BeamTracer::Workspace : TraceWorkspace
{
};

namespace
{
/// Sets of at most this many triangles are searched one by one, larger ones through the tree.
constexpr std::size_t SmallSet = 16;

template <class Probe, class Visitor>
std::uint64_t descendAny(
  const CollisionTree& tree, const Probe& probe, Visitor& visitor, TraversalStack& stack)
{
  return std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, stack); },
    tree.volumes);
}

template <typename Real>
std::uint64_t traceEach(const CollisionTree& tree, const BeamFrame& frame, const BeamRays& rays,
  TraceWorkspace& work, std::vector<Hit>& hits)
{
  const BeamPlaneMap map(frame);
  BeamRayVisitor<Real> visitor(*tree.mesh, frame, map);
  const RayArrays<Real>& arrays = work.rays<Real>();
  const std::vector<Vec3>& directions = work.unitDirections(frame, rays);
  std::uint64_t visited = 0;
  for (std::size_t i = 0; i < rays.size(); ++i)
  {
    visitor.setRay(arrays.x[i], arrays.y[i], directions[i], hits[i]);
    const RayVolumeTest probe(
      frame.origin, Vec3(0.0), directions[i], HitMarginBeam * frame.tanHalf);
    visited += descendAny(tree, probe, visitor, work.stack);
  }
  return visited;
}

template <typename Real>
void traceRays(const CollisionTree& tree, const BeamFrame& frame, const BeamRays& rays, bool batch,
  TraceWorkspace& work, std::vector<Hit>& hits, TraceCounters& counters)
{
  work.setRays<Real>(rays);
  if (batch)
  {
    BatchVisitor<Real> visitor(*tree.mesh, frame, rays, work, hits);
    counters.nodesVisited += descendAny(tree, BeamVolumeTest(frame), visitor, work.stack);
    counters.candidates = std::max(counters.candidates, visitor.candidates());
    if (!visitor.exhausted())
    {
      return;
    }
    // Triangles finer than the spacing of the rays: from here on one ray at a time is cheaper. The
    // hits found so far stand, and only speed up what follows.
  }
  counters.nodesVisited += traceEach<Real>(tree, frame, rays, work, hits);
}
}

BeamTracer::BeamTracer(const CollisionTree& tree, Precision precision)
  : Tree(tree)
  , Arithmetic(precision)
  , Work(std::make_unique<Workspace>())
{
}

BeamTracer::~BeamTracer() = default;

void BeamTracer::setBeam(const BeamFrame& frame)
{
  this->Frame = frame;
  this->Counters = {};
  this->Work->coneKnown = false;
}

void BeamTracer::trace(const BeamRays& rays, bool batch, std::vector<Hit>& hits)
{
  hits.assign(rays.size(), Hit());
  this->Counters.raysTraced += rays.size();
  if (this->Tree.nodes.empty() || rays.size() == 0)
  {
    return;
  }
  if (this->Arithmetic == Precision::Single)
  {
    traceRays<float>(this->Tree, this->Frame, rays, batch, *this->Work, hits, this->Counters);
  }
  else
  {
    traceRays<double>(this->Tree, this->Frame, rays, batch, *this->Work, hits, this->Counters);
  }
}

Hit BeamTracer::traceFromApex(const Vec3& direction, bool coneOnly)
{
  return this->traceFrom(Vec3(0.0), direction, 0.0, NoTriangle, coneOnly);
}

Hit BeamTracer::traceFrom(const Vec3& origin, const Vec3& direction, double minimumRange,
  std::uint32_t ignore, bool coneOnly)
{
  const Vec3 d = unitDirection(direction);
  // From the apex the ranges must have the bits that trace() gives them.
  const double margin = origin == Vec3(0.0) ? beamRayMargin(this->Frame) : 0.0;
  FreeRayVisitor visitor(*this->Tree.mesh, this->Frame.origin, origin, d, margin);
  visitor.minimum = minimumRange;
  visitor.ignore1 = ignore;
  this->search(visitor, origin, d, margin, coneOnly);
  return visitor.nearest;
}

bool BeamTracer::occluded(const Vec3& from, const Vec3& to, double margin, std::uint32_t ignore1,
  std::uint32_t ignore2, bool coneOnly)
{
  const Vec3 between = to - from;
  const double length = safeLength(between);
  if (!(length > 2.0 * margin))
  {
    return false;
  }
  const Vec3 d = unitDirection(between);
  FreeRayVisitor visitor(*this->Tree.mesh, this->Frame.origin, from, d, 0.0);
  visitor.minimum = margin;
  visitor.maximum = length - margin;
  visitor.ignore1 = ignore1;
  visitor.ignore2 = ignore2;
  visitor.anyHit = true;
  this->search(visitor, from, d, 0.0, coneOnly);
  return visitor.nearest.valid();
}

template <class Visitor>
void BeamTracer::search(
  Visitor& visitor, const Vec3& origin, const Vec3& d, double margin, bool coneOnly)
{
  ++this->Counters.raysTraced;
  if (this->Tree.nodes.empty())
  {
    return;
  }
  if (coneOnly)
  {
    const std::vector<std::uint32_t>& set = this->coneTriangles();
    if (set.size() <= SmallSet)
    {
      visitor.leaf(set.data(), static_cast<std::uint32_t>(set.size()));
      return;
    }
  }
  const RayVolumeTest probe(this->Frame.origin, origin, d, margin);
  this->Counters.nodesVisited += descendAny(this->Tree, probe, visitor, this->Work->stack);
}

const std::vector<std::uint32_t>& BeamTracer::coneTriangles()
{
  Workspace& work = *this->Work;
  if (!work.coneKnown)
  {
    work.cone.clear();
    if (!this->Tree.nodes.empty())
    {
      ConeVisitor visitor(work.cone);
      this->Counters.nodesVisited +=
        descendAny(this->Tree, BeamVolumeTest(this->Frame), visitor, work.stack);
    }
    this->Counters.candidates =
      std::max<std::uint64_t>(this->Counters.candidates, work.cone.size());
    work.coneKnown = true;
  }
  return work.cone;
}

LocalTriangle localTriangle(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin)
{
  const Corners corners = cornersFrom(mesh, triangle, origin);
  const TrianglePlane plane = planeOf(corners);
  const double away = plane.height > 0.0 ? -1.0 : 1.0;
  LocalTriangle local{ corners.a, corners.b, corners.c, Vec3(0.0) };
  if (plane.normal != Vec3(0.0))
  {
    local.normal = away * unitDirection(plane.normal);
  }
  return local;
}

double rangeOnTriangle(
  const TriangleMesh& mesh, std::uint32_t triangle, const BeamFrame& frame, double x, double y)
{
  const Corners corners = cornersFrom(mesh, triangle, frame.origin);
  const TrianglePlane plane = planeOf(corners);
  const Vec3 d = unitDirection(frame.direction(x, y));
  const double range = rangeOf(corners, plane, d, beamRayMargin(frame));
  return range > 0.0 ? range : plane.height / glm::dot(plane.normal, d);
}
}
