// SPDX-License-Identifier: BSD-3-Clause
#include "BeamVolumeTest.h"

#include "BeamCone.h"
#include "TriangleTest.h"

#include <algorithm>
#include <limits>

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

template <class Box>
bool BeamVolumeTest::meetsBox(const Box& volume, double& nearest) const
{
  const Vec3 fromApex = volume.center - this->Apex;
  const double margin =
    2.0 * HitMargin * (sumOfMagnitudes(fromApex) + sumOfMagnitudes(volume.half));
  const Vec3 half = volume.half + Vec3(margin);
  const Vec3 center = volume.along(fromApex);
  const Vec3 axis = volume.along(this->Axis);
  const Vec3 outside = glm::max(glm::abs(center) - half, Vec3(0.0));
  nearest = asLowerBound(std::sqrt(glm::dot(outside, outside)));
  return !this->separated(axis, center, half) && this->projectionsMeet(axis, center, half);
}

bool BeamVolumeTest::meets(const AlignedBox& volume, double& nearest) const
{
  return this->meetsBox(volume, nearest);
}

bool BeamVolumeTest::meets(const OBB& volume, double& nearest) const
{
  return this->meetsBox(volume, nearest);
}

bool BeamVolumeTest::meets(const BoundingSphere& volume, double& nearest) const
{
  const Vec3 center = volume.center - this->Apex;
  const double distance = std::sqrt(glm::dot(center, center));
  const double radius = volume.radius + 2.0 * HitMargin * (sumOfMagnitudes(center) + volume.radius);
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

namespace
{
Vec3 inverseOf(const Vec3& v)
{
  constexpr double Smallest = 1e-100; // in place of 0, by which nothing can be divided
  const auto inverse = [](double x) { return 1.0 / (std::fabs(x) < Smallest ? Smallest : x); };
  return { inverse(v.x), inverse(v.y), inverse(v.z) };
}
}

double sizeFrom(const Vec3& apex, const OBB& volume)
{
  return sumOfMagnitudes(volume.center - apex) + sumOfMagnitudes(volume.half);
}

double sizeFrom(const Vec3& apex, const BoundingSphere& volume)
{
  return sumOfMagnitudes(volume.center - apex) + volume.radius;
}

RayVolumeTest::RayVolumeTest(
  const Vec3& apex, const Vec3& origin, const Vec3& direction, double angularMargin, double size)
  : Apex(apex)
  , Origin(origin)
  , Direction(direction)
  , Inverse(inverseOf(direction))
  , Margin((3.0 * HitMargin + angularMargin) * (size + sumOfMagnitudes(origin)))
{
}

/// @param center,half centre, relative to the ray's origin, and half extents of a box, m, in the
/// frame of the box @param inverse inverse direction in this frame
bool RayVolumeTest::meetsSlabs(
  const Vec3& center, const Vec3& half, const Vec3& inverse, double& nearest)
{
  const Vec3 middle = center * inverse;
  const Vec3 reach = half * glm::abs(inverse);
  const Vec3 from = middle - reach;
  const Vec3 to = middle + reach;
  const double entry = std::max(std::max(from.x, from.y), std::max(from.z, 0.0));
  nearest = asLowerBound(entry);
  return entry <= std::min(std::min(to.x, to.y), to.z);
}

bool RayVolumeTest::meets(const AlignedBox& volume, double& nearest) const
{
  return meetsSlabs(
    volume.center - this->Apex - this->Origin, volume.half + this->Margin, this->Inverse, nearest);
}

bool RayVolumeTest::meets(const OBB& volume, double& nearest) const
{
  return meetsSlabs(volume.along(volume.center - this->Apex - this->Origin),
    volume.half + this->Margin, inverseOf(volume.along(this->Direction)), nearest);
}

bool RayVolumeTest::meets(const BoundingSphere& volume, double& nearest) const
{
  const Vec3 center = volume.center - this->Apex - this->Origin;
  const double radius = volume.radius + this->Margin;
  const double z = glm::dot(center, this->Direction);
  const Vec3 radial = center - z * this->Direction;
  const double half2 = radius * radius - glm::dot(radial, radial); // of the chord, squared
  if (half2 < 0.0 || z + radius < 0.0)
  {
    return false;
  }
  const double half = std::sqrt(half2);
  nearest = asLowerBound(std::max(0.0, z - half));
  return z + half >= 0.0;
}
}
