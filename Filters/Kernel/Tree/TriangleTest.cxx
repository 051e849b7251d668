// SPDX-License-Identifier: BSD-3-Clause
#include "TriangleTest.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// A corner seen along the ray, m: s along the longest projected side, r across, z along the ray.
struct SeenCorner
{
  double s, r, z;
};

/// The part of a triangle that lies beside the ray: |s| <= width(z).
class Strip
{
public:
  Strip(double width0, double angularMargin)
    : Width0(width0)
    , Angular(angularMargin)
  {
  }

  void add(const SeenCorner& i, const SeenCorner& j)
  {
    if ((i.z < 0.0 && j.z > 0.0) || (i.z > 0.0 && j.z < 0.0))
    {
      // The width has a kink where the ray begins.
      const double share = i.z / (i.z - j.z);
      const SeenCorner middle{ (1.0 - share) * i.s + share * j.s, (1.0 - share) * i.r + share * j.r,
        0.0 };
      this->addPart(i, middle);
      this->addPart(middle, j);
    }
    else
    {
      this->addPart(i, j);
    }
  }

  bool meetsRay() const { return this->LowerR <= 0.0 && this->UpperR >= 0.0; }
  double clamp(double range) const { return std::min(std::max(range, this->LowerZ), this->UpperZ); }

private:
  void addPart(const SeenCorner& i, const SeenCorner& j)
  {
    double from = 0.0;
    double to = 1.0;
    for (const double side : { -1.0, 1.0 })
    {
      const double fi = this->width(i.z) + side * i.s;
      const double fj = this->width(j.z) + side * j.s;
      if (fi < 0.0 && fj < 0.0)
      {
        return;
      }
      if (fi < 0.0)
      {
        from = std::max(from, fi / (fi - fj));
      }
      else if (fj < 0.0)
      {
        to = std::min(to, fi / (fi - fj));
      }
    }
    if (from <= to)
    {
      this->addPoint(i, j, from);
      this->addPoint(i, j, to);
    }
  }

  double width(double z) const { return this->Width0 + this->Angular * std::max(z, 0.0); }

  void addPoint(const SeenCorner& i, const SeenCorner& j, double share)
  {
    const double z = (1.0 - share) * i.z + share * j.z;
    const double r = (1.0 - share) * i.r + share * j.r;
    this->LowerZ = std::min(this->LowerZ, z);
    this->UpperZ = std::max(this->UpperZ, z);
    this->LowerR = std::min(this->LowerR, r - this->width(z));
    this->UpperR = std::max(this->UpperR, r + this->width(z));
  }

  double Width0;
  double Angular;
  double LowerZ = std::numeric_limits<double>::infinity();
  double UpperZ = -std::numeric_limits<double>::infinity();
  double LowerR = std::numeric_limits<double>::infinity();
  double UpperR = -std::numeric_limits<double>::infinity();
};

double largest(const Vec3& v)
{
  return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
}
}

// The range at the place where the ray passes a sliver. The edge functions alone and the plane
// alone do not give this place reliably.
double rangeOnSliver(const Corners& t, const Vec3& d, double planeRange, double angularMargin)
{
  const Vec3 corner[3] = { t.a, t.b, t.c };
  double z[3];
  Vec3 projected[3];
  for (int i = 0; i < 3; ++i)
  {
    z[i] = glm::dot(corner[i], d);
    projected[i] = corner[i] - z[i] * d;
  }
  Vec3 along(0.0);
  double longest = 0.0;
  for (int i = 0; i < 3; ++i)
  {
    const Vec3 side = projected[(i + 1) % 3] - projected[i];
    const double squared = glm::dot(side, side);
    if (squared > longest)
    {
      longest = squared;
      along = side;
    }
  }
  if (!(longest > 0.0))
  {
    return NoRange;
  }
  along /= std::sqrt(longest);
  const Vec3 across = glm::cross(d, along);
  SeenCorner seen[3];
  for (int i = 0; i < 3; ++i)
  {
    seen[i] = { glm::dot(projected[i], along), glm::dot(projected[i], across), z[i] };
  }
  const double size = std::max(largest(t.a), std::max(largest(t.b), largest(t.c)));
  Strip strip(64.0 * RoundOffDouble * size, angularMargin);
  strip.add(seen[0], seen[1]);
  strip.add(seen[1], seen[2]);
  strip.add(seen[2], seen[0]);
  const double range = strip.meetsRay() ? strip.clamp(planeRange) : NoRange;
  return range > 0.0 ? range : NoRange;
}

// Versions for several processors: where there is a fused multiply-add, std::fma() needs no call.
AVIANLIDAR_MULTIVERSION TrianglePlane planeOf(const Corners& t)
{
  const Vec3 ab = t.b - t.a;
  const Vec3 ac = t.c - t.a;
  const Vec3 bc = t.c - t.b;
  TrianglePlane plane;
  plane.normal = normalOf(t);
  plane.longestSquared = std::max(glm::dot(ab, ab), std::max(glm::dot(ac, ac), glm::dot(bc, bc)));
  plane.height = glm::dot(plane.normal, t.a);
  plane.leastSlope = largest(plane.normal) / 1073741824.0;
  const double farthestSquared =
    std::max(glm::dot(t.a, t.a), std::max(glm::dot(t.b, t.b), glm::dot(t.c, t.c)));
  plane.leastEdge = EdgeNoise * std::sqrt(plane.longestSquared * farthestSquared);
  plane.sides[0] = edgeVector(t.a, t.b);
  plane.sides[1] = edgeVector(t.b, t.c);
  plane.sides[2] = edgeVector(t.c, t.a);
  return plane;
}

TrianglePlane planeOf(const Corners& t, const TrianglePlane& owner)
{
  TrianglePlane plane = planeOf(t);
  // The triangle's own sides give the normal its sign.
  const double sign = glm::dot(plane.normal, owner.normal) < 0.0 ? -1.0 : 1.0;
  plane.normal = sign * owner.normal;
  plane.height = sign * owner.height;
  plane.longestSquared = owner.longestSquared;
  plane.leastSlope = owner.leastSlope;
  return plane;
}

PlaneView viewOfCone(const TrianglePlane& plane, const Vec3& axis, double sine, double cosine)
{
  // For every d within an angle t of the axis, v . d is within cos(t) v . axis -+ sin(t) |v|.
  constexpr double Margin = 1.0 + 1e-9;
  const double length = std::sqrt(glm::dot(plane.normal, plane.normal)) * Margin;
  const double onAxis = std::fabs(glm::dot(plane.normal, axis));
  const double least = (onAxis * cosine - length * sine) / Margin - 1e-14 * length;
  const double most = (onAxis + length * sine) * Margin + 1e-14 * length;
  if (least >= WellShaped * plane.longestSquared * Margin)
  {
    return PlaneView::WellShaped;
  }
  if (!(most * Margin < WellShaped * plane.longestSquared) || !(least > plane.leastSlope * Margin))
  {
    return PlaneView::Any;
  }
  const double sign = plane.height > 0.0 ? 1.0 : -1.0;
  for (const EdgeVector& side : plane.sides)
  {
    const double edge =
      sign * glm::dot(side.e, axis) * cosine - std::sqrt(glm::dot(side.e, side.e)) * sine * Margin;
    if (!(edge >= 2.0 * plane.leastEdge))
    {
      return PlaneView::Any;
    }
  }
  return PlaneView::Inside;
}

double rangeOf(const Corners& t, const TrianglePlane& plane, const Vec3& d, double angularMargin)
{
  const PlaneRange found = rangeOnPlane(t, plane, d.x, d.y, d.z);
  return found.kind == 0 ? NoRange
    : found.kind == 1    ? found.range
                         : rangeOnSliver(t, d, found.range, angularMargin);
}

Vec3 unitDirection(const Vec3& direction)
{
  Vec3 unit;
  unitDirectionOf(direction.x, direction.y, direction.z, unit.x, unit.y, unit.z);
  return unit;
}
}
