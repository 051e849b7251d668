// SPDX-License-Identifier: BSD-3-Clause
#include "BeamVolumeTest.h"

#include "TriangleTest.h"

#include <algorithm>
#include <limits>

namespace avianlidar
{
namespace
{
/// A box relative to the apex, in coordinates of its own, widened by the margin of TriangleTest.h.
struct LocalBox
{
  Vec3 center;
  Vec3 half;
};

double sumOfMagnitudes(const Vec3& v)
{
  return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

LocalBox localBox(const AABB& volume, const Vec3& apex)
{
  const Vec3 lower = volume.lower - apex;
  const Vec3 upper = volume.upper - apex;
  const double margin = HitMargin * (sumOfMagnitudes(lower) + sumOfMagnitudes(upper));
  return { 0.5 * (lower + upper), 0.5 * (upper - lower) + Vec3(margin) };
}

Vec3 inAxes(const OBB& volume, const Vec3& v)
{
  return { glm::dot(volume.axes[0], v), glm::dot(volume.axes[1], v), glm::dot(volume.axes[2], v) };
}

LocalBox localBox(const OBB& volume, const Vec3& apex)
{
  const Vec3 center = volume.center - apex;
  const double margin = 2.0 * HitMargin * (sumOfMagnitudes(center) + sumOfMagnitudes(volume.half));
  return { inAxes(volume, center), volume.half + Vec3(margin) };
}

/// Distance from the coordinates' origin to a box.
double distanceTo(const LocalBox& box)
{
  const Vec3 outside = glm::max(glm::abs(box.center) - box.half, Vec3(0.0));
  return std::sqrt(glm::dot(outside, outside));
}

/// Lower bound of ranges from a distance: the last margin, for the rounding of the distance itself.
double asLowerBound(double distance)
{
  return distance * (1.0 - HitMargin);
}

/// Entry of a ray into a box widened by `margin`, or false.
bool slabs(
  const LocalBox& box, const Vec3& origin, const Vec3& inverse, double margin, double& nearest)
{
  const Vec3 half = box.half + Vec3(margin);
  const Vec3 center = box.center - origin;
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis)
  {
    const double middle = center[axis] * inverse[axis];
    const double width = std::fabs(half[axis] * inverse[axis]);
    from = std::max(from, middle - width);
    to = std::min(to, middle + width);
  }
  nearest = asLowerBound(from);
  return from <= to;
}

/// 1 / d with components so small that it would overflow replaced; a box's margin is far greater
/// than the difference.
double safeInverse(double d)
{
  constexpr double Smallest = 1e-150;
  return 1.0 / (std::fabs(d) < Smallest ? std::copysign(Smallest, d) : d);
}

/// True if a rectangle about (x, y) may meet a projection of the cone.
bool meetsWedge(const ConeWedge& wedge, double x, double y, double halfX, double halfY)
{
  if (wedge.wholePlane)
  {
    return true;
  }
  // All corners to the left of the left edge, or to the right of the right one (paper, Fig. 7:
  // cross products).
  const double left = wedge.leftX * y - wedge.leftY * x;
  const double right = wedge.rightX * y - wedge.rightY * x;
  if (left > std::fabs(wedge.leftX) * halfY + std::fabs(wedge.leftY) * halfX ||
    -right > std::fabs(wedge.rightX) * halfY + std::fabs(wedge.rightY) * halfX)
  {
    return false;
  }
  // The sides of the rectangle.
  const double mostX = std::max(wedge.leftX, wedge.rightX);
  const double leastX = std::min(wedge.leftX, wedge.rightX);
  const double mostY = std::max(wedge.leftY, wedge.rightY);
  const double leastY = std::min(wedge.leftY, wedge.rightY);
  return !(x > halfX && mostX <= 0.0) && !(x < -halfX && leastX >= 0.0) &&
    !(y > halfY && mostY <= 0.0) && !(y < -halfY && leastY >= 0.0);
}
}

bool BeamVolumeTest::separated(const Vec3& axis, const Vec3& center, const Vec3& half) const
{
  const double z = glm::dot(center, axis);
  const double reach = glm::dot(glm::abs(axis), half);
  if (z + reach < 0.0)
  {
    return true;
  }
  // Tangent plane of the cone on the side of the centre: the cone lies where normal . p <= 0, for
  // any `radial` across the axis. Of a centre on the axis the difference below is nothing but
  // round-off, which may point along the axis: so a second step makes it perpendicular, and a
  // centre inside the cone needs no plane at all.
  Vec3 radial = center - z * axis;
  radial -= glm::dot(radial, axis) * axis;
  const double distance = std::sqrt(glm::dot(radial, radial));
  if (!(distance * this->Cone.cosine > z * this->Cone.sine))
  {
    return false;
  }
  const Vec3 normal = (this->Cone.cosine / distance) * radial - this->Cone.sine * axis;
  return glm::dot(normal, center) > glm::dot(glm::abs(normal), half);
}

bool BeamVolumeTest::projectionsMeet(const Vec3& axis, const Vec3& center, const Vec3& half) const
{
  return meetsWedge(
           ConeWedge(this->Cone.sine, axis.y, axis.z), center.y, center.z, half.y, half.z) &&
    meetsWedge(ConeWedge(this->Cone.sine, axis.z, axis.x), center.z, center.x, half.z, half.x) &&
    meetsWedge(ConeWedge(this->Cone.sine, axis.x, axis.y), center.x, center.y, half.x, half.y);
}

bool BeamVolumeTest::meets(const AABB& volume, double& nearest) const
{
  const LocalBox box = localBox(volume, this->Cone.apex);
  const Vec3& c = box.center;
  const Vec3& h = box.half;
  if (this->separated(this->Cone.axis, c, h) ||
    !meetsWedge(this->Cone.wedges[0], c.y, c.z, h.y, h.z) ||
    !meetsWedge(this->Cone.wedges[1], c.z, c.x, h.z, h.x) ||
    !meetsWedge(this->Cone.wedges[2], c.x, c.y, h.x, h.y))
  {
    return false;
  }
  nearest = asLowerBound(distanceTo(box));
  return true;
}

bool BeamVolumeTest::meets(const OBB& volume, double& nearest) const
{
  const LocalBox box = localBox(volume, this->Cone.apex);
  const Vec3 axis = inAxes(volume, this->Cone.axis);
  if (this->separated(axis, box.center, box.half) ||
    !this->projectionsMeet(axis, box.center, box.half))
  {
    return false;
  }
  nearest = asLowerBound(distanceTo(box));
  return true;
}

bool BeamVolumeTest::meets(const BoundingSphere& volume, double& nearest) const
{
  const Vec3 center = volume.center - this->Cone.apex;
  const double distance = std::sqrt(glm::dot(center, center));
  const double radius = volume.radius + 2.0 * HitMargin * (distance + volume.radius);
  const double z = glm::dot(center, this->Cone.axis);
  const Vec3 radial = center - z * this->Cone.axis;
  const double q = std::sqrt(glm::dot(radial, radial));
  nearest = asLowerBound(std::max(0.0, distance - radius));
  if (z * this->Cone.cosine + q * this->Cone.sine < 0.0)
  {
    return distance <= radius; // the apex is the cone's nearest point
  }
  return q * this->Cone.cosine - z * this->Cone.sine <= radius;
}

RayVolumeTest::RayVolumeTest(
  const Vec3& apex, const Vec3& origin, const Vec3& direction, double angularMargin)
  : Apex(apex)
  , Origin(origin)
  , Direction(direction)
  , Inverse(safeInverse(direction.x), safeInverse(direction.y), safeInverse(direction.z))
  , Angular(angularMargin + HitMargin)
{
}

bool RayVolumeTest::meets(const AABB& volume, double& nearest) const
{
  const LocalBox box = localBox(volume, this->Apex);
  const double farthest = sumOfMagnitudes(box.center - this->Origin) + sumOfMagnitudes(box.half);
  return slabs(box, this->Origin, this->Inverse, this->Angular * farthest, nearest);
}

bool RayVolumeTest::meets(const OBB& volume, double& nearest) const
{
  const LocalBox box = localBox(volume, this->Apex);
  const Vec3 origin = inAxes(volume, this->Origin);
  const Vec3 d = inAxes(volume, this->Direction);
  const Vec3 inverse(safeInverse(d.x), safeInverse(d.y), safeInverse(d.z));
  const double farthest = sumOfMagnitudes(box.center - origin) + sumOfMagnitudes(box.half);
  return slabs(
    box, origin, inverse, this->Angular * farthest + HitMargin * sumOfMagnitudes(origin), nearest);
}

bool RayVolumeTest::meets(const BoundingSphere& volume, double& nearest) const
{
  const Vec3 fromApex = volume.center - this->Apex;
  const Vec3 center = fromApex - this->Origin;
  const double along = glm::dot(center, this->Direction);
  const Vec3 radial = center - along * this->Direction;
  const double farthest = sumOfMagnitudes(center) + volume.radius;
  const double radius = volume.radius + this->Angular * farthest +
    2.0 * HitMargin * (sumOfMagnitudes(fromApex) + sumOfMagnitudes(this->Origin) + volume.radius);
  const double squared = radius * radius - glm::dot(radial, radial);
  if (squared < 0.0)
  {
    return false;
  }
  const double half = std::sqrt(squared);
  nearest = asLowerBound(std::max(0.0, along - half));
  return along + half >= 0.0;
}
}
