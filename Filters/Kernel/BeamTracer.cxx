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

/// A cone down the tree, folded or not.
template <class Visitor>
std::uint64_t descendCone(
  const CollisionTree& tree, const BeamVolumeTest& probe, Visitor& visitor, TraversalStack& stack)
{
  WideCone cone;
  if (!tree.wide.nodes.empty() && cone.set(tree.wide, probe))
  {
    return descendWide(tree, cone, visitor, stack);
  }
  return std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, stack); },
    tree.volumes());
}

/// One ray down the tree. `origin` is relative to the apex.
template <class Visitor>
std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
  const Vec3& direction, double angularMargin, Visitor& visitor, TraversalStack& stack)
{
  WideRay ray;
  if (!tree.wide.nodes.empty() &&
    ray.set(tree.wide, apex, origin, direction, angularMargin + 2.0 * HitMargin))
  {
    return descendWide(tree, ray, visitor, stack);
  }
  const RayVolumeTest probe(apex, origin, direction, angularMargin);
  return std::visit([&](const auto& volumes)
    { return descend(tree, volumes, probe, visitor, stack); },
    tree.volumes());
}

/// Costs in ns as measured on one machine; they choose the strategy, never the result.
constexpr double CostOfRay = 1000.0;
constexpr double CostOfBundle = 20000.0;

/// Fewer rays than that go down one by one.
constexpr std::size_t FewestRaysInBatch = 6;

/// The rays of one beam by one of three strategies: all at once, in bundles of neighbouring rays,
/// or one by one. Hits already in the lanes stand when a strategy gives up, and only speed up what
/// follows.
template <typename Real>
class BeamSearch
{
public:
  BeamSearch(const CollisionTree& tree, const BeamFrame& frame, std::size_t count,
    const BeamTracer::RaySource& source, TraceWorkspace& work, TraceCounters& counters)
    : Tree(tree)
    , Frame(frame)
    , Map(frame)
    , Count(count)
    , Source(source)
    , Work(work)
    , Counters(counters)
  {
  }

  /// One descent for the whole beam, unless triangles are so fine that bundles are cheaper.
  void traceBatch()
  {
    RayBundle beam;
    beam.end = (this->Count + Group - 1) / Group * Group;
    beam.axis = this->Frame.axis;
    beam.sine = this->Frame.sinHalf;
    beam.cosine = this->Frame.cosHalf;
    const double budget = std::min(CostOfBundle * static_cast<double>(beam.end / Group),
      CostOfRay * static_cast<double>(this->Count));
    this->Work.cone.clear();
    const bool finished = this->traceBundle(beam, BeamVolumeTest(this->Frame), budget, true);
    if (!finished)
    {
      this->traceBundles();
    }
  }

  void traceEach(std::size_t begin, std::size_t end)
  {
    RayLanes<Real>& rays = this->Work.template rays<Real>(this->Frame, this->Source);
    BeamRayVisitor<Real> visitor(*this->Tree.mesh, this->Frame, this->Map);
    for (std::size_t i = begin; i < std::min(end, rays.count); ++i)
    {
      Hit hit{ static_cast<std::uint32_t>(rays.triangle[i]), rays.range[i] };
      const Vec3 direction(rays.dx[i], rays.dy[i], rays.dz[i]);
      visitor.setRay(rays.x[i], rays.y[i], direction, hit);
      this->Counters.nodesVisited += descendRay(this->Tree, this->Frame.origin, Vec3(0.0),
        direction, HitMarginBeam * this->Frame.tanHalf, visitor, this->Work.stack);
      rays.triangle[i] = hit.triangle;
      rays.range[i] = hit.range;
    }
  }

private:
  static constexpr std::size_t Group = RayLanes<Real>::Group;

  /// False if the budget did not last.
  bool traceBundle(RayBundle bundle, const BeamVolumeTest& cone, double budget, bool whole)
  {
    bundle.angularMargin = beamRayMargin(this->Frame);
    BatchVisitor<Real> visitor(*this->Tree.mesh, this->Frame, this->Map, this->Source, bundle,
      this->Count, budget, this->Work);
    this->Counters.nodesVisited += descendCone(this->Tree, cone, visitor, this->Work.stack);
    visitor.flush();
    this->Work.coneKnown = this->Work.coneKnown || (whole && visitor.sawAll());
    this->Counters.candidates = std::max(this->Counters.candidates, visitor.candidates());
    return !visitor.exhausted();
  }

  /// Consecutive rays are neighbours in the strata; where they are not, one ray at a time is no
  /// worse.
  void traceBundles()
  {
    RayLanes<Real>& rays = this->Work.template rays<Real>(this->Frame, this->Source);
    for (std::size_t begin = 0; begin < rays.count; begin += Group)
    {
      const std::size_t end = std::min(begin + Group, rays.count);
      double halfAngle = 0.0;
      RayBundle bundle;
      bundle.begin = begin;
      bundle.end = begin + Group;
      bundle.axis = this->axisOf(begin, end, halfAngle);
      bundle.sine = std::sin(halfAngle);
      bundle.cosine = std::cos(halfAngle);
      const bool neighbours = halfAngle < 0.75 * this->Frame.halfBeamwidth && end - begin > 1;
      if (!neighbours ||
        !this->traceBundle(bundle, BeamVolumeTest(this->Frame, bundle.axis, halfAngle),
          CostOfRay * static_cast<double>(end - begin), false))
      {
        this->traceEach(begin, end);
      }
    }
  }

  /// Axis and half-angle of a cone that holds rays [begin, end).
  Vec3 axisOf(std::size_t begin, std::size_t end, double& halfAngle) const
  {
    const BeamRays& drawn = this->Source();
    double lowX = 1.0, highX = -1.0, lowY = 1.0, highY = -1.0;
    for (std::size_t i = begin; i < end; ++i)
    {
      lowX = std::min(lowX, drawn.x[i]);
      highX = std::max(highX, drawn.x[i]);
      lowY = std::min(lowY, drawn.y[i]);
      highY = std::max(highY, drawn.y[i]);
    }
    const double x = 0.5 * (lowX + highX);
    const double y = 0.5 * (lowY + highY);
    double farthest = 0.0;
    for (std::size_t i = begin; i < end; ++i)
    {
      farthest = std::max(farthest, std::hypot(drawn.x[i] - x, drawn.y[i] - y));
    }
    // Points of a plane at distance 1 that are s apart are seen at most asin(s) apart.
    const double apart = std::min(1.0, farthest * this->Frame.tanHalf * (1.0 + 1e-9));
    halfAngle = apart < 0.5 ? std::asin(apart) : 2.0;
    return unitDirection(this->Frame.direction(x, y));
  }

  const CollisionTree& Tree;
  const BeamFrame& Frame;
  BeamPlaneMap Map;
  std::size_t Count;
  const BeamTracer::RaySource& Source;
  TraceWorkspace& Work;
  TraceCounters& Counters;
};

template <typename Real>
void traceRays(const CollisionTree& tree, const BeamFrame& frame, std::size_t count,
  const BeamTracer::RaySource& source, bool batch, TraceWorkspace& work, std::vector<Hit>& hits,
  TraceCounters& counters)
{
  work.raysKnown = false;
  BeamSearch<Real> search(tree, frame, count, source, work, counters);
  if (batch && count >= FewestRaysInBatch)
  {
    search.traceBatch();
  }
  else
  {
    search.traceEach(0, count);
  }
  if (work.raysKnown)
  {
    const RayLanes<Real>& rays = work.lanes<Real>();
    for (std::size_t i = 0; i < rays.count; ++i)
    {
      hits[i] = { static_cast<std::uint32_t>(rays.triangle[i]), rays.range[i] };
    }
  }
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
  this->trace(
    rays.size(), [&rays]() -> const BeamRays& { return rays; }, batch, hits);
}

void BeamTracer::trace(
  std::size_t count, const RaySource& source, bool batch, std::vector<Hit>& hits)
{
  hits.assign(count, Hit());
  this->Counters.raysTraced += count;
  if (this->Tree.nodes.empty() || count == 0)
  {
    return;
  }
  if (this->Arithmetic == Precision::Single)
  {
    traceRays<float>(
      this->Tree, this->Frame, count, source, batch, *this->Work, hits, this->Counters);
  }
  else
  {
    traceRays<double>(
      this->Tree, this->Frame, count, source, batch, *this->Work, hits, this->Counters);
  }
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
