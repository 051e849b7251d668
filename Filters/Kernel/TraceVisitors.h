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

/// Rays of one beam in the precision of the edge tests.
template <typename Real>
struct RayArrays
{
  std::vector<Real> x;
  std::vector<Real> y;
  std::vector<Real> slack;
};

/// What one thread keeps between beams, so that no ray allocates.
struct TraceWorkspace
{
  TraversalStack stack;
  RayArrays<float> single;
  RayArrays<double> precise;
  std::vector<Vec3> directions;
  bool directionsKnown = false;
  std::vector<std::uint32_t> cone;
  bool coneKnown = false;

  template <typename Real>
  RayArrays<Real>& rays()
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

  template <typename Real>
  void setRays(const BeamRays& beamRays)
  {
    RayArrays<Real>& own = this->rays<Real>();
    own.x.assign(beamRays.x.begin(), beamRays.x.end());
    own.y.assign(beamRays.y.begin(), beamRays.y.end());
    own.slack.resize(beamRays.size());
    this->directionsKnown = false;
  }

  /// Found at first need: most beams of an airport meet nothing.
  const std::vector<Vec3>& unitDirections(const BeamFrame& frame, const BeamRays& rays)
  {
    if (!this->directionsKnown)
    {
      this->directions.resize(rays.size());
      for (std::size_t i = 0; i < rays.size(); ++i)
      {
        this->directions[i] = unitDirection(frame.direction(rays.x[i], rays.y[i]));
      }
      this->directionsKnown = true;
    }
    return this->directions;
  }
};

/// Batch collision detection: every triangle of a leaf against all rays of the beam.
template <typename Real>
class BatchVisitor
{
public:
  BatchVisitor(const TriangleMesh& mesh, const BeamFrame& frame, const BeamRays& rays,
    TraceWorkspace& work, std::vector<Hit>& hits)
    : Mesh(mesh)
    , Frame(frame)
    , Rays(rays)
    , Work(work)
    , Arrays(work.rays<Real>())
    , Map(frame)
    , Hits(hits)
    , RaysWithoutHit(rays.size())
    , Budget(CostOfRay * static_cast<double>(rays.size()))
  {
  }

  double limit() const { return this->FarthestHit; }
  bool exhausted() const { return this->Budget < 0.0; }
  std::uint64_t candidates() const { return this->Candidates; }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    bool changed = false;
    for (std::uint32_t i = 0; i < count; ++i)
    {
      changed = this->testTriangle(triangles[i]) || changed;
    }
    this->Candidates += count;
    if (changed && this->RaysWithoutHit == 0)
    {
      this->FarthestHit = 0.0;
      for (const Hit& hit : this->Hits)
      {
        this->FarthestHit = std::max(this->FarthestHit, hit.range);
      }
    }
    return !this->exhausted();
  }

private:
  // Costs in ns as measured on one machine; they choose the strategy, never the result.
  static constexpr double CostOfRay = 1500.0;
  static constexpr double CostOfSetup = 80.0;
  static constexpr double CostOfPair = 1.5;

  bool testTriangle(std::uint32_t triangle)
  {
    const Corners corners = cornersFrom(this->Mesh, triangle, this->Frame.origin);
    BeamTriangle<Real> edges;
    this->Budget -= CostOfSetup;
    if (!edges.set(this->Map, corners) || edges.missesCone())
    {
      return false;
    }
    const std::size_t n = this->Rays.size();
    this->Budget -= CostOfPair * static_cast<double>(n);
    const BeamEdge<Real> e0 = edges.edges[0];
    const BeamEdge<Real> e1 = edges.edges[1];
    const BeamEdge<Real> e2 = edges.edges[2];
    const Real* x = this->Arrays.x.data();
    const Real* y = this->Arrays.y.data();
    Real* slack = this->Arrays.slack.data();
#pragma omp simd
    for (std::size_t i = 0; i < n; ++i)
    {
      const Real s0 = e0.slack(x[i], y[i]);
      const Real s1 = e1.slack(x[i], y[i]);
      const Real s2 = e2.slack(x[i], y[i]);
      const Real s01 = s0 < s1 ? s0 : s1;
      slack[i] = s01 < s2 ? s01 : s2;
    }
    return this->takeAccepted(triangle, corners);
  }

  bool takeAccepted(std::uint32_t triangle, const Corners& corners)
  {
    const Real* slack = this->Arrays.slack.data();
    const std::size_t n = this->Rays.size();
    std::size_t i = 0;
    while (i < n && !(slack[i] >= Real(0)))
    {
      ++i;
    }
    if (i == n)
    {
      return false;
    }
    const TrianglePlane plane = planeOf(corners);
    const std::vector<Vec3>& directions = this->Work.unitDirections(this->Frame, this->Rays);
    const double margin = beamRayMargin(this->Frame);
    bool changed = false;
    for (; i < n; ++i)
    {
      if (slack[i] >= Real(0))
      {
        const double range = rangeOf(corners, plane, directions[i], margin);
        if (range > 0.0)
        {
          this->RaysWithoutHit -= this->Hits[i].valid() ? 0 : 1;
          keepNearest(this->Hits[i], range, triangle);
          changed = true;
        }
      }
    }
    return changed;
  }

  const TriangleMesh& Mesh;
  const BeamFrame& Frame;
  const BeamRays& Rays;
  TraceWorkspace& Work;
  RayArrays<Real>& Arrays;
  BeamPlaneMap Map;
  std::vector<Hit>& Hits;
  std::size_t RaysWithoutHit;
  std::uint64_t Candidates = 0;
  double Budget;
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
