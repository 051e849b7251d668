// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TraceVisitors.h
 * @brief What BeamTracer does in the leaves of the tree: visitors for descend() (Traversal.h), and
 * their workspace.
 *
 * Acceptance and range of a (ray, triangle) pair come from TriangleTest.h in all of them.
 */
#ifndef avianlidar_TraceVisitors_h
#define avianlidar_TraceVisitors_h

#include "BeamTracer.h"
#include "Traversal.h"
#include "TriangleLanes.h"
#include "TriangleTest.h"

#include <algorithm>
#include <type_traits>
#include <vector>

namespace avianlidar
{
inline void keepNearest(Hit& hit, double range, std::uint32_t triangle)
{
  if (range < hit.range || (range == hit.range && triangle < hit.triangle))
  {
    hit.range = range;
    hit.triangle = triangle;
  }
}

/// What one thread keeps between beams, so that no ray allocates.
struct TraceWorkspace
{
  TraversalStack stack;
  RayLanes<float> single;
  RayLanes<double> precise;
  bool raysKnown = false;
  std::vector<std::uint32_t> cone;
  bool coneKnown = false;

  template <typename Real>
  RayLanes<Real>& lanes()
  {
    if constexpr (std::is_same_v<Real, float>)
    {
      return this->single;
    }
    else
    {
      return this->precise;
    }
  }

  /// The rays in lanes, at first need: most beams of an airport meet nothing.
  template <typename Real>
  RayLanes<Real>& rays(const BeamFrame& frame, const BeamTracer::RaySource& source)
  {
    RayLanes<Real>& own = this->lanes<Real>();
    if (!this->raysKnown)
    {
      const BeamRays& drawn = source();
      own.set(frame, drawn.x.data(), drawn.y.data(), drawn.size());
      this->raysKnown = true;
    }
    return own;
  }
};

/// Batch collision detection: every triangle of a leaf against all rays of a bundle, eight
/// triangles prepared at a time. The bundle is the beam, or some neighbouring rays of it.
template <typename Real>
class BatchVisitor
{
public:
  /// @param budget ns that the bundle may cost before another strategy is cheaper
  BatchVisitor(const TriangleMesh& mesh, const BeamFrame& frame, const BeamPlaneMap& map,
    const BeamTracer::RaySource& source, const RayBundle& bundle, std::size_t count, double budget,
    TraceWorkspace& work)
    : Mesh(mesh)
    , Frame(frame)
    , Map(map)
    , Source(source)
    , Bundle(bundle)
    , Work(work)
    , Budget(budget)
    , RaysWithoutHit(std::min(bundle.end, count) - bundle.begin)
  {
  }

  double limit() const { return this->FarthestHit; }
  bool exhausted() const { return this->Budget < 0.0; }
  std::uint64_t candidates() const { return this->Candidates; }
  /// True if no node was left out because of hits or costs: what was gathered is S_potential.
  bool sawAll() const
  {
    return this->FarthestHit == std::numeric_limits<double>::infinity() && !this->exhausted();
  }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    this->Candidates += count;
    this->Work.cone.insert(this->Work.cone.end(), triangles, triangles + count);
    for (std::uint32_t i = 0; i < count; ++i)
    {
      this->Lanes.put(
        this->Filled++, triangles[i], cornersFrom(this->Mesh, triangles[i], this->Frame.origin));
      if (this->Filled == TriangleLanes<Real>::Width)
      {
        this->flush();
      }
    }
    return !this->exhausted();
  }

  /// Test what still waits in the lanes.
  void flush()
  {
    if (this->Filled == 0)
    {
      return;
    }
    for (int lane = this->Filled; lane < TriangleLanes<Real>::Width; ++lane)
    {
      this->Lanes.put(lane, NoTriangle, Corners{ Vec3(0.0), Vec3(0.0), Vec3(0.0) });
    }
    this->Lanes.prepare(this->Map);
    this->Budget -= CostOfPreparing;
    bool changed = false;
    for (int lane = 0; lane < this->Filled; ++lane)
    {
      if (this->Lanes.candidate[lane])
      {
        this->testLane(lane, changed);
      }
    }
    this->Filled = 0;
    if (changed && this->RaysWithoutHit == 0)
    {
      this->FarthestHit =
        this->Work.template lanes<Real>().farthest(this->Bundle.begin, this->Bundle.end);
    }
  }

private:
  // Costs in ns as measured on one machine; they choose the strategy, never the result.
  static constexpr double CostOfPreparing = 80.0;
  static constexpr double CostOfTest = 20.0;
  static constexpr double CostOfPair = 0.5;
  static constexpr double CostOfRange = 2.0;

  void testLane(int lane, bool& changed)
  {
    RayLanes<Real>& rays = this->Work.template rays<Real>(this->Frame, this->Source);
    const double size = static_cast<double>(this->Bundle.end - this->Bundle.begin);
    this->Budget -= CostOfTest + CostOfPair * size;
    if (testRays(this->Lanes, lane, rays, this->Bundle.begin, this->Bundle.end))
    {
      this->Budget -= CostOfTest + CostOfRange * size;
      this->RaysWithoutHit -=
        takeRanges(this->Lanes.corners(lane), this->Lanes.id[lane], this->Bundle, rays, changed);
    }
  }

  const TriangleMesh& Mesh;
  const BeamFrame& Frame;
  const BeamPlaneMap& Map;
  const BeamTracer::RaySource& Source;
  RayBundle Bundle;
  TraceWorkspace& Work;
  TriangleLanes<Real> Lanes;
  int Filled = 0;
  double Budget;
  std::size_t RaysWithoutHit;
  std::uint64_t Candidates = 0;
  double FarthestHit = std::numeric_limits<double>::infinity();
};

/// One ray of a beam down the tree.
template <typename Real>
class BeamRayVisitor
{
public:
  BeamRayVisitor(const TriangleMesh& mesh, const BeamFrame& frame, const BeamPlaneMap& map)
    : Mesh(mesh)
    , Frame(frame)
    , Map(map)
    , Margin(beamRayMargin(frame))
  {
  }

  void setRay(Real x, Real y, const Vec3& direction, Hit& hit)
  {
    this->X = x;
    this->Y = y;
    this->Direction = direction;
    this->Nearest = &hit;
  }

  double limit() const { return this->Nearest->range; }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    for (std::uint32_t i = 0; i < count; ++i)
    {
      const Corners corners = cornersFrom(this->Mesh, triangles[i], this->Frame.origin);
      if (beamRayAccepted<Real>(this->Map, corners, this->X, this->Y))
      {
        const double range = rangeOf(corners, planeOf(corners), this->Direction, this->Margin);
        if (range > 0.0)
        {
          keepNearest(*this->Nearest, range, triangles[i]);
        }
      }
    }
    return true;
  }

private:
  const TriangleMesh& Mesh;
  const BeamFrame& Frame;
  const BeamPlaneMap& Map;
  double Margin;
  Real X = 0;
  Real Y = 0;
  Vec3 Direction{ 0.0 };
  Hit* Nearest = nullptr;
};

/// S_potential of the cone.
class ConeVisitor
{
public:
  explicit ConeVisitor(std::vector<std::uint32_t>& triangles)
    : Triangles(triangles)
  {
  }
  double limit() const { return std::numeric_limits<double>::infinity(); }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    this->Triangles.insert(this->Triangles.end(), triangles, triangles + count);
    return true;
  }

private:
  std::vector<std::uint32_t>& Triangles;
};

/// A ray from any point, in double precision: its nearest hit between two ranges, or whether there
/// is one.
class FreeRayVisitor
{
public:
  FreeRayVisitor(const TriangleMesh& mesh, const Vec3& apex, const Vec3& origin,
    const Vec3& direction, double angularMargin)
    : Mesh(mesh)
    , Apex(apex)
    , Origin(origin)
    , Direction(direction)
    , Margin(angularMargin)
  {
  }

  double minimum = 0.0;
  double maximum = std::numeric_limits<double>::infinity();
  std::uint32_t ignore1 = NoTriangle;
  std::uint32_t ignore2 = NoTriangle;
  bool anyHit = false;
  Hit nearest;

  double limit() const { return std::min(this->maximum, this->nearest.range); }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    for (std::uint32_t i = 0; i < count; ++i)
    {
      this->test(triangles[i]);
      if (this->anyHit && this->nearest.valid())
      {
        return false;
      }
    }
    return true;
  }

private:
  void test(std::uint32_t triangle)
  {
    if (triangle == this->ignore1 || triangle == this->ignore2)
    {
      return;
    }
    Corners corners = cornersFrom(this->Mesh, triangle, this->Apex);
    corners.a -= this->Origin;
    corners.b -= this->Origin;
    corners.c -= this->Origin;
    if (rayAccepted(corners, this->Direction))
    {
      const double range = rangeOf(corners, planeOf(corners), this->Direction, this->Margin);
      if (range > this->minimum && range < this->maximum)
      {
        keepNearest(this->nearest, range, triangle);
      }
    }
  }

  const TriangleMesh& Mesh;
  Vec3 Apex;
  Vec3 Origin;
  Vec3 Direction;
  double Margin;
};
}

#endif
