// SPDX-License-Identifier: BSD-3-Clause
#include "BeamTracer.h"

#include "BeamVolumeTest.h"
#include "BlockTrace.h"
#include "Descents.h"
#include "TraceVisitors.h"
#include "TriangleTest.h"

#include <algorithm>

namespace avianlidar
{
struct BeamTracer::Workspace
{
  TraversalStack stack;
  BlockWorkspace block;
  std::vector<std::uint32_t> cone; ///< S_potential of the current beam
  bool coneKnown = false;
};

namespace
{
/// Sets of at most this many triangles are searched one by one, larger ones through the tree.
constexpr std::size_t SmallSet = 16;
}

std::size_t beamsPerBlock(int raysPerBeam)
{
  constexpr int FewRays = 16;
  constexpr int RaysOfBlock = 12800;
  return static_cast<std::size_t>(
    std::clamp(RaysOfBlock / raysPerBeam, 1, raysPerBeam < FewRays ? 1024 : 128));
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

void BeamTracer::trace(const BeamRays& rays, TraceMode mode, std::vector<Hit>& hits)
{
  const auto count = static_cast<std::uint32_t>(rays.size());
  const BeamBlock block{ &this->Frame, 1, &count,
    [&rays](std::size_t) -> const BeamRays& { return rays; } };
  const BlockHits& found = this->traceBlock(block, mode);
  if (found.hits[0])
  {
    hits.assign(found.hits[0], found.hits[0] + count);
  }
  else
  {
    hits.assign(count, Hit());
  }
  const TraceCounters& now = found.counters[0];
  this->Counters.nodesVisited += now.nodesVisited;
  this->Counters.raysTraced += now.raysTraced;
  this->Counters.candidates = std::max(this->Counters.candidates, now.candidates);
}

const BlockHits& BeamTracer::traceBlock(const BeamBlock& block, TraceMode mode)
{
  BlockRaysWorkspace& work = this->Work->block.rays;
  work.found.hits.assign(block.size, nullptr);
  work.found.counters.assign(block.size, TraceCounters());
  std::size_t rays = 0;
  for (std::size_t b = 0; b < block.size; ++b)
  {
    work.found.counters[b].raysTraced = block.rays[b];
    rays += block.rays[b];
  }
  work.hits.resize(std::max(work.hits.size(), rays));
  work.used = 0;
  if (this->Tree.nodes.empty())
  {
    return work.found;
  }
  if (this->Arithmetic == Precision::Single)
  {
    avianlidar::traceBlock<float>(this->Tree, block, mode, this->Work->block);
  }
  else
  {
    avianlidar::traceBlock<double>(this->Tree, block, mode, this->Work->block);
  }
  return work.found;
}

Hit BeamTracer::traceFromApex(const Vec3& direction, bool coneOnly)
{
  return this->traceFrom(Vec3(0.0), direction, 0.0, NoTriangle, coneOnly);
}

Hit BeamTracer::traceFrom(const Vec3& origin, const Vec3& direction, double minimumRange,
  std::uint32_t ignore, bool coneOnly, double maximumRange)
{
  const Vec3 d = unitDirection(direction);
  // From the apex the ranges must have the bits that trace() gives them.
  const double margin = origin == Vec3(0.0) ? beamRayMargin(this->Frame) : 0.0;
  FreeRayVisitor visitor(*this->Tree.mesh, this->Frame.origin, origin, d, margin);
  visitor.minimum = minimumRange;
  visitor.maximum = maximumRange;
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
  const std::vector<std::uint32_t>& set = this->Work->cone;
  if (coneOnly && this->Work->coneKnown && set.size() <= SmallSet)
  {
    visitor.leaf(set.data(), static_cast<std::uint32_t>(set.size()));
    return;
  }
  this->Counters.nodesVisited +=
    descendRay(this->Tree, this->Frame.origin, origin, d, margin, visitor, this->Work->stack);
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
        descendCone(this->Tree, BeamVolumeTest(this->Frame), visitor, work.stack);
    }
    this->Counters.candidates =
      std::max<std::uint64_t>(this->Counters.candidates, work.cone.size());
    work.coneKnown = true;
  }
  return work.cone;
}

SeenTriangle seeTriangle(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin)
{
  SeenTriangle seen;
  seen.corners = cornersFrom(mesh, triangle, origin);
  seen.plane = planeOf(seen.corners);
  if (seen.plane.normal != Vec3(0.0))
  {
    seen.normal = (seen.plane.height > 0.0 ? -1.0 : 1.0) * unitDirection(seen.plane.normal);
  }
  return seen;
}

LocalTriangle localTriangle(const TriangleMesh& mesh, std::uint32_t triangle, const Vec3& origin)
{
  const SeenTriangle seen = seeTriangle(mesh, triangle, origin);
  return { seen.corners.a, seen.corners.b, seen.corners.c, seen.normal };
}

double rangeOnTriangle(const SeenTriangle& triangle, const BeamFrame& frame, const Vec3& d)
{
  const double range = rangeOf(triangle.corners, triangle.plane, d, beamRayMargin(frame));
  return range > 0.0 ? range : triangle.plane.height / glm::dot(triangle.plane.normal, d);
}

double rangeOnTriangle(
  const TriangleMesh& mesh, std::uint32_t triangle, const BeamFrame& frame, double x, double y)
{
  return rangeOnTriangle(
    seeTriangle(mesh, triangle, frame.origin), frame, unitDirection(frame.direction(x, y)));
}
}
