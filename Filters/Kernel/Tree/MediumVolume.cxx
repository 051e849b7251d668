// SPDX-License-Identifier: BSD-3-Clause
#include "MediumVolume.h"

#include "Traversal.h"
#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace avianlidar
{
namespace
{
Vec3 offsetOf(const MediumVolume& volume, double seconds)
{
  return seconds * volume.velocity;
}

void addPart(double begin, double end, double density, double fall, double far,
  std::vector<MediumCrossing>& parts)
{
  const double from = std::max(0.0, begin);
  const double to = std::min(end, far);
  if (from < to)
  {
    const double less = fall == 0.0 ? 1.0 : std::exp(-fall * (from - begin));
    parts.push_back({ from, to, density * less, fall });
  }
}

/// Ranges between which the coordinate p + t d lies between two values.
std::pair<double, double> between(double p, double d, double low, double high)
{
  if (d == 0.0)
  {
    return p >= low && p <= high ? std::pair(-Infinity, Infinity) : std::pair(1.0, 0.0);
  }
  const double one = (low - p) / d;
  const double two = (high - p) / d;
  return { std::min(one, two), std::max(one, two) };
}

void crossLayer(const MediumVolume& layer, const Vec3& from, const Vec3& direction, double far,
  std::vector<MediumCrossing>& parts)
{
  const double height = glm::dot(from, layer.up);
  const double climb = glm::dot(direction, layer.up);
  const auto dense = between(height, climb, layer.bottom, layer.top);
  addPart(dense.first, dense.second, 1.0, 0.0, far, parts);
  if (layer.softness > 0.0)
  {
    // A level ray at the top is in the dense part.
    const auto above = climb == 0.0 && height <= layer.top
      ? std::pair(1.0, 0.0)
      : between(height, climb, layer.top, Infinity);
    constexpr double nothingLeft = 60.0; // as an exponent: higher there is nothing
    double begin = std::max(0.0, above.first);
    if (climb < 0.0)
    {
      begin = std::max(begin, above.second + nothingLeft * layer.softness / climb);
    }
    const double density = std::exp(-(height + begin * climb - layer.top) / layer.softness);
    addPart(begin, above.second, density, climb / layer.softness, far, parts);
  }
}

void crossBox(const MediumVolume& box, const Vec3& from, const Vec3& direction, double far,
  std::vector<MediumCrossing>& parts)
{
  double begin = -Infinity;
  double end = Infinity;
  for (const Vec3& axis : box.halfAxes)
  {
    const double square = glm::dot(axis, axis);
    const auto inside =
      between(glm::dot(from, axis) / square, glm::dot(direction, axis) / square, -1.0, 1.0);
    begin = std::max(begin, inside.first);
    end = std::min(end, inside.second);
  }
  addPart(begin, end, 1.0, 0.0, far, parts);
}

void crossEllipsoid(const MediumVolume& ellipsoid, const Vec3& from, const Vec3& direction,
  double far, std::vector<MediumCrossing>& parts)
{
  Vec3 p(0.0);
  Vec3 d(0.0);
  for (int i = 0; i < 3; ++i)
  {
    const Vec3& axis = ellipsoid.halfAxes[static_cast<std::size_t>(i)];
    p[i] = glm::dot(from, axis) / glm::dot(axis, axis);
    d[i] = glm::dot(direction, axis) / glm::dot(axis, axis);
  }
  // From the point nearest to the centre: a far origin takes no digits.
  const double square = glm::dot(d, d);
  const double middle = -glm::dot(p, d) / square;
  const Vec3 nearest = p + middle * d;
  const double root = 1.0 - glm::dot(nearest, nearest);
  if (root > 0.0)
  {
    const double half = std::sqrt(root / square);
    addPart(middle - half, middle + half, 1.0, 0.0, far, parts);
  }
}

/// Whether a ray that hits a triangle passes its sides at a distance. @param direction unit vector
bool isAmid(const Corners& corners, const Vec3& direction)
{
  const double a = glm::dot(direction, glm::cross(corners.b, corners.c));
  const double b = glm::dot(direction, glm::cross(corners.c, corners.a));
  const double c = glm::dot(direction, glm::cross(corners.a, corners.b));
  constexpr double margin = 1e-9; // of the triangle: more than rounding, less than matters
  const double least = margin * std::fabs(a + b + c);
  return std::fabs(a) > least && std::fabs(b) > least && std::fabs(c) > least;
}

/// All hits of a ray.
class HitList
{
public:
  HitList(const TriangleMesh& mesh, const Vec3& origin, const Vec3& direction,
    std::vector<MediumCrosser::Hit>& hits)
    : Mesh(mesh)
    , Origin(origin)
    , Direction(direction)
    , Hits(hits)
  {
  }
  double limit() const { return Infinity; }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    for (std::uint32_t i = 0; i < count; ++i)
    {
      const Corners corners = cornersFrom(this->Mesh, triangles[i], this->Origin);
      if (rayAccepted(corners, this->Direction))
      {
        const TrianglePlane plane = planeOf(corners);
        const double range = rangeOf(corners, plane, this->Direction, 0.0);
        if (range > 0.0)
        {
          this->Hits.push_back({ range, glm::dot(plane.normal, this->Direction) < 0.0 ? 1 : -1,
            isAmid(corners, this->Direction) });
        }
      }
    }
    return true;
  }

private:
  const TriangleMesh& Mesh;
  const Vec3 Origin;
  const Vec3 Direction;
  std::vector<MediumCrosser::Hit>& Hits;
};
}

double MediumVolume::radius() const
{
  double square = 0.0;
  double most = 0.0;
  for (const Vec3& axis : this->halfAxes)
  {
    square += glm::dot(axis, axis);
    most = std::max(most, glm::dot(axis, axis));
  }
  return std::sqrt(this->shape == MediumShape::Ellipsoid ? most : square);
}

double MediumCrossing::upTo(double range) const
{
  const double length = std::min(range, this->end) - this->begin;
  if (!(length > 0.0))
  {
    return 0.0;
  }
  const double falls = this->fall * length;
  return this->density * length * (std::fabs(falls) < 1e-12 ? 1.0 : -std::expm1(-falls) / falls);
}

double MediumCrossing::densityAt(double range) const
{
  return range >= this->begin && range <= this->end
    ? this->density * std::exp(-this->fall * (range - this->begin))
    : 0.0;
}

std::string checkVolume(const MediumVolume& volume)
{
  const auto isFinite = [](const Vec3& v)
  { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
  if (!isFinite(volume.centre) || !isFinite(volume.velocity))
  {
    return "centre or velocity is not finite, expected m and m/s";
  }
  for (const Vec3& axis : volume.halfAxes)
  {
    const double length = glm::length(axis);
    if (!(length >= 1e-6 && length <= 1e7))
    {
      return valueError("half an axis", length, "1e-6 to 1e7 m");
    }
  }
  if (volume.shape == MediumShape::Layer && !(volume.top > volume.bottom && volume.top <= 1e7))
  {
    return valueError("top", volume.top, "above the bottom, at most 1e7 m");
  }
  if (!(volume.softness >= 0.0 && volume.softness <= 1e6))
  {
    return valueError("softness", volume.softness, "0 to 1e6 m");
  }
  return {};
}

void MediumCrosser::findInSurface(const MediumVolume& volume, const Vec3& origin,
  const Vec3& direction, double far, std::vector<MediumCrossing>& parts)
{
  const CollisionTree& tree = *volume.surface;
  this->Hits.clear();
  if (tree.empty())
  {
    return;
  }
  HitList list(*tree.mesh, origin, direction, this->Hits);
  descendWide(
    tree, WideRay(tree.wide, origin, Vec3(0.0), direction, 2.0 * HitMargin), list, this->Stack);
  std::sort(this->Hits.begin(), this->Hits.end(),
    [](const Hit& a, const Hit& b)
    { return std::tie(a.range, a.entered) < std::tie(b.range, b.entered); });
  // Hits on a side that two triangles share are one; those amid two triangles in one place are two.
  const auto isSame = [](const Hit& a, const Hit& b)
  {
    return a.entered == b.entered && b.range - a.range <= 1e-9 * b.range && !(a.isAmid && b.isAmid);
  };
  this->Hits.erase(std::unique(this->Hits.begin(), this->Hits.end(), isSame), this->Hits.end());
  int shells = 0; // that enclose the origin
  for (const Hit& hit : this->Hits)
  {
    shells -= hit.entered;
  }
  double begin = 0.0;
  for (const Hit& hit : this->Hits)
  {
    if (shells != 0)
    {
      addPart(begin, hit.range, 1.0, 0.0, far, parts);
    }
    shells += hit.entered;
    begin = hit.range;
  }
}

void MediumCrosser::find(const MediumVolume& volume, const Vec3& origin, const Vec3& direction,
  double far, double seconds, std::vector<MediumCrossing>& parts)
{
  const Vec3 from = origin - offsetOf(volume, seconds);
  switch (volume.shape)
  {
    case MediumShape::Everywhere:
      addPart(0.0, far, 1.0, 0.0, far, parts);
      break;
    case MediumShape::Layer:
      crossLayer(volume, from - volume.centre, direction, far, parts);
      break;
    case MediumShape::Box:
      crossBox(volume, from - volume.centre, direction, far, parts);
      break;
    case MediumShape::Ellipsoid:
      crossEllipsoid(volume, from - volume.centre, direction, far, parts);
      break;
    case MediumShape::Surface:
      this->findInSurface(volume, from, direction, far, parts);
      break;
  }
}

bool mayMeet(const MediumVolume& volume, const BeamFrame& frame, double far, double seconds)
{
  if (!volume.isBounded())
  {
    return true;
  }
  const double radius = volume.radius();
  const Vec3 to = volume.centre + offsetOf(volume, seconds) - frame.origin;
  const double range = safeLength(to);
  if (range <= radius)
  {
    return true;
  }
  if (range - radius > far)
  {
    return false;
  }
  // The cosine of the half-beamwidth and the half of the angle at which the ball appears.
  const double sine = radius / range;
  const double least = frame.cosHalf * std::sqrt(1.0 - sine * sine) - frame.sinHalf * sine;
  return glm::dot(frame.axis, to) >= (least - 1e-9) * range;
}

bool isWiderThan(const MediumVolume& volume, const BeamFrame& frame, double far)
{
  const double range = std::min(far, safeLength(volume.centre - frame.origin) + volume.radius());
  const auto isWide = [&](const Vec3& axis)
  { return safeLength(axis) > 2.0 * frame.tanHalf * range; };
  return volume.shape != MediumShape::Surface &&
    (!volume.isBounded() || std::all_of(volume.halfAxes.begin(), volume.halfAxes.end(), isWide));
}

bool mayMeetBorder(const MediumVolume& volume, const BeamFrame& frame, double far)
{
  if (volume.isBounded())
  {
    return mayMeet(volume, frame, far, 0.0);
  }
  if (volume.shape == MediumShape::Everywhere)
  {
    return false;
  }
  const double height = glm::dot(frame.origin - volume.centre, volume.up);
  const double climb = glm::dot(frame.axis, volume.up);
  const double low = height + far * std::min(0.0, climb - frame.sinHalf);
  const double high = height + far * std::max(0.0, climb + frame.sinHalf);
  constexpr double nothingLeft = 60.0; // as an exponent
  const bool isInside = low > volume.bottom && high < volume.top;
  const bool isOutside = high < volume.bottom || low > volume.top + nothingLeft * volume.softness;
  return !isInside && !isOutside;
}
}
