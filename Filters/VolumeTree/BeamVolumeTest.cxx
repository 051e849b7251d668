// SPDX-License-Identifier: BSD-3-Clause
#include "BeamVolumeTest.h"

#include "BeamCone.h"
#include "TriangleTest.h"

#include <algorithm>

namespace avianlidar
{
namespace
{
double sumOfMagnitudes(const Vec3& v)
{
  return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

/// Lower bound of ranges from a distance, m: the margin covers the rounding of the distance itself.
double asLowerBound(double distance)
{
  return distance * (1.0 - HitMargin);
}

/// True if a rectangle about (x, y) may meet a projection of the cone.
bool meetsWedge(const ConeWedge& wedge, double x, double y, double halfX, double halfY)
{
  if (wedge.wholePlane)
  {
    return true;
  }
  // All corners lie left of the left edge or right of the right edge (paper, Fig. 7).
  const double left = wedge.leftX * y - wedge.leftY * x;
  const double right = wedge.rightX * y - wedge.rightY * x;
  if (left > std::fabs(wedge.leftX) * halfY + std::fabs(wedge.leftY) * halfX ||
    -right > std::fabs(wedge.rightX) * halfY + std::fabs(wedge.rightY) * halfX)
  {
    return false;
  }
  // The whole wedge lies beyond a side of the rectangle.
  const double mostX = std::max(wedge.leftX, wedge.rightX);
  const double leastX = std::min(wedge.leftX, wedge.rightX);
  const double mostY = std::max(wedge.leftY, wedge.rightY);
  const double leastY = std::min(wedge.leftY, wedge.rightY);
  return !(x > halfX && mostX <= 0.0) && !(x < -halfX && leastX >= 0.0) &&
    !(y > halfY && mostY <= 0.0) && !(y < -halfY && leastY >= 0.0);
}
}

BeamVolumeTest::BeamVolumeTest(const BeamFrame& frame)
  : Apex(frame.origin)
  , Axis(frame.axis)
{
  const BeamCone cone(frame);
  this->Sine = cone.sine;
  this->Cosine = cone.cosine;
}

BeamVolumeTest::BeamVolumeTest(
  const Vec3& apex, const Vec3& origin, const Vec3& direction, double angularMargin)
  : Apex(apex)
  , Origin(origin)
  , Axis(direction)
  , Sine(std::sin(angularMargin + HitMargin))
  , Cosine(std::cos(angularMargin + HitMargin))
{
}

bool BeamVolumeTest::separated(const Vec3& axis, const Vec3& center, const Vec3& half) const
{
  const double z = glm::dot(center, axis);
  const double reach = glm::dot(glm::abs(axis), half);
  if (z + reach < 0.0)
  {
    return true;
  }
  // Tangent plane of the cone on the side of the centre: normal . p <= 0 for every p in the cone,
  // for any unit vector `radial` across the axis. If the centre lies on the axis, the difference
  // below is round-off alone and may point along the axis. A second step therefore makes the
  // difference perpendicular to the axis. A centre inside the cone needs no plane.
  Vec3 radial = center - z * axis;
  radial -= glm::dot(radial, axis) * axis;
  const double distance = std::sqrt(glm::dot(radial, radial));
  if (!(distance * this->Cosine > z * this->Sine))
  {
    return false;
  }
  const Vec3 normal = (this->Cosine / distance) * radial - this->Sine * axis;
  return glm::dot(normal, center) > glm::dot(glm::abs(normal), half);
}

bool BeamVolumeTest::projectionsMeet(const Vec3& axis, const Vec3& center, const Vec3& half) const
{
  return meetsWedge(ConeWedge(this->Sine, axis.y, axis.z), center.y, center.z, half.y, half.z) &&
    meetsWedge(ConeWedge(this->Sine, axis.z, axis.x), center.z, center.x, half.z, half.x) &&
    meetsWedge(ConeWedge(this->Sine, axis.x, axis.y), center.x, center.y, half.x, half.y);
}

bool BeamVolumeTest::meets(const OBB& volume, double& nearest) const
{
  const Vec3 fromApex = volume.center - this->Apex;
  const double margin = 2.0 * HitMargin *
    (sumOfMagnitudes(fromApex) + sumOfMagnitudes(this->Origin) + sumOfMagnitudes(volume.half));
  const Vec3 half = volume.half + Vec3(margin);
  const Vec3 center = volume.along(fromApex - this->Origin);
  const Vec3 axis = volume.along(this->Axis);
  const Vec3 outside = glm::max(glm::abs(center) - half, Vec3(0.0));
  nearest = asLowerBound(std::sqrt(glm::dot(outside, outside)));
  return !this->separated(axis, center, half) && this->projectionsMeet(axis, center, half);
}

bool BeamVolumeTest::meets(const BoundingSphere& volume, double& nearest) const
{
  const Vec3 fromApex = volume.center - this->Apex;
  const Vec3 center = fromApex - this->Origin;
  const double distance = std::sqrt(glm::dot(center, center));
  const double radius = volume.radius +
    2.0 * HitMargin * (sumOfMagnitudes(fromApex) + sumOfMagnitudes(this->Origin) + volume.radius);
  const double z = glm::dot(center, this->Axis);
  const Vec3 radial = center - z * this->Axis;
  const double q = std::sqrt(glm::dot(radial, radial));
  nearest = asLowerBound(std::max(0.0, distance - radius));
  if (z * this->Cosine + q * this->Sine < 0.0)
  {
    return distance <= radius; // the apex is the cone's nearest point
  }
  return q * this->Cosine - z * this->Sine <= radius;
}
}
