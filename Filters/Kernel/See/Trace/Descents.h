// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Descents.h
 * @brief Descents of the tree for a cone or a single ray, and the visitors that test a single ray
 * in the leaves.
 *
 * Source: paper, Sec. 3.2 and 3.3.
 * Differs: acceptance and range come from TriangleTest.h, which names the differences.
 * Valid: as TriangleTest.h.
 * Test: TestBeamTracer.cxx, TestGeometryProperties.cxx.
 */
#ifndef avianlidar_Descents_h
#define avianlidar_Descents_h

#include "BeamTracer.h"
#include "SceneTriangles.h"
#include "Traversal.h"
#include "TriangleTest.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
/// Adapts a visitor that has the members of TreeLeaves to the interface of TreeLeaves.
template <class Visitor>
class LeavesOf final : public TreeLeaves
{
public:
  explicit LeavesOf(Visitor& visitor)
    : Seen(visitor)
  {
  }
  double limit() const override { return this->Seen.limit(); }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count) override
  {
    return this->Seen.leaf(triangles, count);
  }

private:
  Visitor& Seen;
};

/// Descend a nonempty tree with a beam's cone. @param entryPoints nodes from which the descent
/// begins; null: the root; ignored in trees of other volumes @return number of nodes visited
template <class Visitor>
std::uint64_t descendCone(const CollisionTree& tree, const BeamFrame& frame, Visitor& visitor,
  TraversalStack& stack, const EntryPoints* entryPoints = nullptr)
{
  if (tree.other)
  {
    LeavesOf<Visitor> leaves(visitor);
    return tree.other->descendCone(tree, frame, leaves, stack);
  }
  return descendWide(tree, WideCone(tree.wide, frame), visitor, stack, entryPoints);
}

/// Descend a nonempty tree with one ray. @param origin origin relative to the apex, m
/// @return number of nodes visited
template <class Visitor>
std::uint64_t descendRay(const CollisionTree& tree, const Vec3& apex, const Vec3& origin,
  const Vec3& direction, double angularMargin, Visitor& visitor, TraversalStack& stack)
{
  if (tree.other)
  {
    LeavesOf<Visitor> leaves(visitor);
    return tree.other->descendRay(tree, apex, origin, direction, angularMargin, leaves, stack);
  }
  const WideRay ray(tree.wide, apex, origin, direction, angularMargin + 2.0 * HitMargin);
  return descendWide(tree, ray, visitor, stack);
}

/// Passes the leaves of the movers' tree to a visitor, with triangles numbered as in the scan.
template <class Visitor>
class MovedLeaves
{
public:
  MovedLeaves(const SceneTriangles& scene, Visitor& visitor)
    : Moved(scene.moved())
    , Seen(visitor)
  {
  }
  double limit() const { return this->Seen.limit(); }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    return std::all_of(triangles, triangles + count,
      [this](std::uint32_t place) { return this->Seen.leaf(&this->Moved[place], 1); });
  }

private:
  const std::vector<std::uint32_t>& Moved;
  Visitor& Seen;
};

/// Test one ray against the movers that are placed. @return number of nodes visited
template <class Visitor>
std::uint64_t visitMoved(const SceneTriangles& scene, const Vec3& apex, const Vec3& origin,
  const Vec3& direction, double angularMargin, Visitor& visitor, TraversalStack& stack)
{
  if (scene.movedTree())
  {
    MovedLeaves<Visitor> leaves(scene, visitor);
    return descendRay(*scene.movedTree(), apex, origin, direction, angularMargin, leaves, stack);
  }
  visitor.leaf(scene.moved().data(), static_cast<std::uint32_t>(scene.moved().size()));
  return 0;
}

/// Replace `hit` if the triangle is nearer, or equally near and of lower number.
inline void keepNearest(Hit& hit, double range, std::uint32_t triangle)
{
  if (range < hit.range || (range == hit.range && triangle < hit.triangle))
  {
    hit.range = range;
    hit.triangle = triangle;
  }
}

/// Range up to which volumes are visited once a hit is found. If a triangle takes the plane of
/// another triangle, a hit may lie nearer than the volumes of the hit triangle. Across the plane,
/// the difference is the distance that rounding puts between the two triangles. Along the ray, the
/// difference is larger than across the plane. For rays within 4 degrees of a plane, the range may
/// be too small.
inline double limitOf(const CollisionTree& tree, double range)
{
  constexpr double alongRay = 16.0;
  return range + alongRay * tree.planeDepth;
}

/// Finds the nearest hit of one ray of a beam.
class BeamRayVisitor
{
public:
  BeamRayVisitor(const SceneTriangles& scene, const BeamFrame& frame, const BeamPlaneMap& map)
    : Scene(scene)
    , Frame(frame)
    , Map(map)
    , Margin(beamRayMargin(frame))
  {
  }

  void setRay(double x, double y, const Vec3& direction, Hit& hit)
  {
    this->X = x;
    this->Y = y;
    this->Direction = direction;
    this->Nearest = &hit;
  }

  double limit() const { return limitOf(this->Scene.tree(), this->Nearest->range); }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    for (std::uint32_t i = 0; i < count; ++i)
    {
      const Vec3& apex = this->Frame.origin;
      const Corners corners = this->Scene.cornersFrom(triangles[i], apex);
      if (beamRayAccepted(this->Map, corners, this->X, this->Y))
      {
        const TrianglePlane plane = this->Scene.planeOf(triangles[i], corners, apex);
        const double range = rangeOf(corners, plane, this->Direction, this->Margin);
        if (range > 0.0)
        {
          keepNearest(*this->Nearest, range, triangles[i]);
        }
      }
    }
    return true;
  }

private:
  const SceneTriangles& Scene;
  const BeamFrame& Frame;
  const BeamPlaneMap& Map;
  double Margin;
  double X = 0.0;
  double Y = 0.0;
  Vec3 Direction{ 0.0 };
  Hit* Nearest = nullptr;
};

/// Finds, for a ray from any point, the nearest hit between two ranges, or any hit between the two
/// ranges.
class FreeRayVisitor
{
public:
  FreeRayVisitor(const SceneTriangles& scene, const Vec3& apex, const Vec3& origin,
    const Vec3& direction, double angularMargin)
    : Scene(scene)
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

  double limit() const
  {
    return std::min(this->maximum, limitOf(this->Scene.tree(), this->nearest.range));
  }

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
    const Corners corners = this->cornersOf(triangle);
    if (rayAccepted(corners, this->Direction))
    {
      const std::uint32_t owner = this->Scene.planeOwner(triangle);
      const TrianglePlane plane =
        owner == triangle ? planeOf(corners) : planeOf(corners, planeOf(this->cornersOf(owner)));
      const double range = rangeOf(corners, plane, this->Direction, this->Margin);
      if (range > this->minimum && range < this->maximum)
      {
        keepNearest(this->nearest, range, triangle);
      }
    }
  }

  /// Corners relative to the ray's origin, m.
  Corners cornersOf(std::uint32_t triangle) const
  {
    Corners corners = this->Scene.cornersFrom(triangle, this->Apex);
    corners.a -= this->Origin;
    corners.b -= this->Origin;
    corners.c -= this->Origin;
    return corners;
  }

  const SceneTriangles& Scene;
  Vec3 Apex;
  Vec3 Origin;
  Vec3 Direction;
  double Margin;
};
}

#endif
