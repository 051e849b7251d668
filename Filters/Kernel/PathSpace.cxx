// SPDX-License-Identifier: BSD-3-Clause
#include "PathSpace.h"

#include "SecondaryReflection.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
/// With fewer hits a surface, a descent for each path is as cheap.
constexpr std::size_t FewHits = 3;

/// A box against eight boxes of the folded tree.
struct WideBox
{
  float x, y, z; ///< centre relative to the reference, m
  float halfX, halfY, halfZ;

  void distances(const WideNode& node, float* nearest) const
  {
    const WideBox b = *this;
    for (int i = 0; i < WideNode::Width; ++i)
    {
      const bool meets = (std::fabs(node.x[i] - b.x) <= node.halfX[i] + b.halfX) &
        (std::fabs(node.y[i] - b.y) <= node.halfY[i] + b.halfY) &
        (std::fabs(node.z[i] - b.z) <= node.halfZ[i] + b.halfZ);
      nearest[i] = meets ? 0.0f : std::numeric_limits<float>::infinity();
    }
  }
};

/// Ends the descent at the first triangle that may be met.
class OccupantVisitor
{
public:
  /// @param least height above the surface, m, below which no path can meet anything
  /// @param farthest hit of the beam, m @param margin of every test, m
  OccupantVisitor(const TriangleMesh& mesh, const Vec3& apex, const AABB& box,
    const HitGeometry::Surface& surface, double least, double farthest, double margin)
    : Mesh(mesh)
    , Apex(apex)
    , Center(box.center())
    , Half(0.5 * (box.upper - box.lower) + Vec3(margin))
    , Surface(surface)
    , Least(least)
    , Farthest(farthest)
  {
  }

  bool found = false;

  double limit() const { return std::numeric_limits<double>::infinity(); }

  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    this->found = std::any_of(
      triangles, triangles + count, [this](std::uint32_t t) { return this->mayBeMet(t); });
    return !this->found;
  }

private:
  bool mayBeMet(std::uint32_t triangle) const
  {
    if (triangle == this->Surface.triangle)
    {
      return false;
    }
    const Corners t = cornersFrom(this->Mesh, triangle, this->Apex);
    const Vec3 size = glm::max(glm::max(glm::abs(t.a), glm::abs(t.b)), glm::abs(t.c));
    const double reach = std::max({ size.x, size.y, size.z }) + this->Farthest;
    // TriangleTest.h: a hit lies off its triangle by no more than HitMargin times this.
    const double height = this->Least - 4.0 * HitMargin * reach;
    const auto above = [this](const Vec3& v)
    { return glm::dot(this->Surface.normal, v) + this->Surface.height; };
    if (above(t.a) < height && above(t.b) < height && above(t.c) < height)
    {
      return false;
    }
    const Vec3 lower = glm::min(glm::min(t.a, t.b), t.c) - this->Center;
    const Vec3 upper = glm::max(glm::max(t.a, t.b), t.c) - this->Center;
    if (glm::any(glm::greaterThan(lower, this->Half)) ||
      glm::any(glm::lessThan(upper, -this->Half)))
    {
      return false;
    }
    const Vec3 normal = glm::cross(t.b - t.a, t.c - t.a);
    const double off = std::fabs(glm::dot(normal, t.a - this->Center));
    return off <= glm::dot(glm::abs(normal), this->Half) * (1.0 + 1e-9);
  }

  const TriangleMesh& Mesh;
  Vec3 Apex;
  Vec3 Center;
  Vec3 Half;
  const HitGeometry::Surface& Surface;
  double Least;
  double Farthest;
};
}

double distanceInCone(
  const BeamFrame& frame, const Vec3& point, double range, const Vec3& direction)
{
  // p . p cos^2 - (p . axis)^2 = 0 on the cone, a quadratic in the length s.
  const double cos2 = frame.cosHalf * frame.cosHalf;
  const double along = glm::dot(point, frame.axis);
  const double turn = glm::dot(direction, frame.axis);
  const double a = cos2 - turn * turn;
  const double b = cos2 * glm::dot(point, direction) - along * turn;
  const double c = std::min(0.0, cos2 * range * range - along * along);
  if (!(a > 1e-9))
  {
    return std::numeric_limits<double>::infinity(); // within the cone of directions, or nearly
  }
  const double reach = (std::sqrt(std::max(0.0, b * b - a * c)) - b) / a;
  return reach * (1.0 + 1e-6) + 1e-6 * range;
}

const std::vector<char>& PathSpace::look(const CollisionTree& tree, const BeamFrame& frame,
  const PrimaryHits& hits, const HitGeometry& geometry)
{
  const std::size_t surfaces = geometry.surfaces.size();
  this->Occupied.assign(surfaces, 1);
  const Vec3 offset = frame.origin - tree.wide.reference;
  float widening = 0.0f;
  if (tree.wide.nodes.empty() || hits.size() < FewHits * surfaces ||
    !wideningFor(tree.wide, offset, widening))
  {
    return this->Occupied;
  }
  this->Boxes.assign(surfaces, AABB{});
  this->LeastHeights.assign(surfaces, std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < hits.size(); ++i)
  {
    const std::uint32_t s = geometry.surface[i];
    const Vec3 direction = geometry.direction(i);
    const Vec3 mirror = mirrorDirection(direction, geometry.surfaces[s].normal);
    const Vec3 point = hits.range[i] * direction;
    AABB& box = this->Boxes[s];
    box.extend(point);
    box.extend(point + distanceInCone(frame, point, hits.range[i], mirror) * mirror);
    // Half the height at which a path of this hit is first looked at.
    this->LeastHeights[s] =
      std::min(this->LeastHeights[s], 0.5 * surfaceMargin(hits.range[i]) * hits.cosine[i]);
  }
  for (std::size_t s = 0; s < surfaces; ++s)
  {
    const AABB& box = this->Boxes[s];
    if (!isFinite(box.lower) || !isFinite(box.upper))
    {
      continue;
    }
    const Vec3 center = box.center() + offset;
    const Vec3 half =
      0.5 * (box.upper - box.lower) * (1.0 + double{ WideRounding }) + Vec3(2.0 * widening);
    const WideBox query{ static_cast<float>(center.x), static_cast<float>(center.y),
      static_cast<float>(center.z), static_cast<float>(half.x), static_cast<float>(half.y),
      static_cast<float>(half.z) };
    OccupantVisitor visitor(*tree.mesh, frame.origin, box, geometry.surfaces[s],
      this->LeastHeights[s], hits.farthest, widening);
    descendWide(tree, query, visitor, this->Stack);
    this->Occupied[s] = visitor.found;
  }
  return this->Occupied;
}
}
