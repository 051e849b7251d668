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
/// Height above a layer's top, in units of its softness, above which its density counts as 0.
constexpr double NothingLeft = 60.0;

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

/// Ranges t between which the coordinate p + t d lies between `low` and `high`.
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
    // A level ray at the top lies in the dense part.
    const auto above = climb == 0.0 && height <= layer.top
      ? std::pair(1.0, 0.0)
      : between(height, climb, layer.top, Infinity);
    double begin = std::max(0.0, above.first);
    if (climb < 0.0)
    {
      begin = std::max(begin, above.second + NothingLeft * layer.softness / climb);
    }
    const double density = std::exp(-(height + begin * climb - layer.top) / layer.softness);
    addPart(begin, above.second, density, climb / layer.softness, far, parts);
  }
}

/// Components of a vector in units of the half axes of a box or an ellipsoid.
Vec3 byHalfAxes(const MediumVolume& volume, const Vec3& v)
{
  const auto by = [&](const Vec3& axis) { return glm::dot(v, axis) / glm::dot(axis, axis); };
  return { by(volume.halfAxes[0]), by(volume.halfAxes[1]), by(volume.halfAxes[2]) };
}

/// Ranges between which a ray lies in a box. @param p, d origin and direction in half axes
std::pair<double, double> insideBox(const Vec3& p, const Vec3& d)
{
  std::pair<double, double> all(-Infinity, Infinity);
  for (int i = 0; i < 3; ++i)
  {
    const auto inside = between(p[i], d[i], -1.0, 1.0);
    all = { std::max(all.first, inside.first), std::min(all.second, inside.second) };
  }
  return all;
}

/// Ranges between which a ray lies in an ellipsoid. @param p, d as for a box
std::pair<double, double> insideEllipsoid(const Vec3& p, const Vec3& d)
{
  // Ranges are counted from the point nearest to the centre, so that a far origin costs no digits.
  const double square = glm::dot(d, d);
  const double middle = -glm::dot(p, d) / square;
  const Vec3 nearest = p + middle * d;
  const double root = 1.0 - glm::dot(nearest, nearest);
  const double half = root > 0.0 ? std::sqrt(root / square) : 0.0;
  return { middle - half, middle + half };
}

/// True if a ray hits a triangle away from its sides. @param corners relative to the ray's origin
bool isAmid(const Corners& corners, const Vec3& direction)
{
  const double a = glm::dot(direction, glm::cross(corners.b, corners.c));
  const double b = glm::dot(direction, glm::cross(corners.c, corners.a));
  const double c = glm::dot(direction, glm::cross(corners.a, corners.b));
  constexpr double margin = 1e-9; // share of the triangle, above rounding and too small to matter
  const double least = margin * std::fabs(a + b + c);
  return std::fabs(a) > least && std::fabs(b) > least && std::fabs(c) > least;
}

/// Collects all hits of a ray.
struct HitList
{
  const TriangleMesh& mesh;
  const Vec3 origin;
  const Vec3 direction;
  std::vector<MediumCrosser::Hit>& hits;

  double limit() const { return Infinity; }
  bool leaf(const std::uint32_t* triangles, std::uint32_t count)
  {
    for (std::uint32_t i = 0; i < count; ++i)
    {
      const Corners corners = cornersFrom(this->mesh, triangles[i], this->origin);
      const TrianglePlane plane = planeOf(corners);
      const double range =
        rayAccepted(corners, this->direction) ? rangeOf(corners, plane, this->direction, 0.0) : 0.0;
      if (range > 0.0)
      {
        this->hits.push_back({ range, glm::dot(plane.normal, this->direction) < 0.0 ? 1 : -1,
          isAmid(corners, this->direction) });
      }
    }
    return true;
  }
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
  HitList list{ *tree.mesh, origin, direction, this->Hits };
  descendWide(
    tree, WideRay(tree.wide, origin, Vec3(0.0), direction, 2.0 * HitMargin), list, this->Stack);
  std::sort(this->Hits.begin(), this->Hits.end(),
    [](const Hit& a, const Hit& b)
    { return std::tie(a.range, a.entered) < std::tie(b.range, b.entered); });
  // Two hits on a side that two triangles share count once. Two hits amid triangles count twice.
  const auto isSame = [](const Hit& a, const Hit& b)
  {
    return a.entered == b.entered && b.range - a.range <= 1e-9 * b.range && !(a.isAmid && b.isAmid);
  };
  this->Hits.erase(std::unique(this->Hits.begin(), this->Hits.end(), isSame), this->Hits.end());
  int shells = 0; // number of shells about the origin
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
  const Vec3 from = origin - volume.centreAt(seconds);
  const auto add = [&](const std::pair<double, double>& inside)
  { addPart(inside.first, inside.second, 1.0, 0.0, far, parts); };
  switch (volume.shape)
  {
    case MediumShape::Everywhere:
      add({ 0.0, far });
      break;
    case MediumShape::Layer:
      crossLayer(volume, from, direction, far, parts);
      break;
    case MediumShape::Box:
      add(insideBox(byHalfAxes(volume, from), byHalfAxes(volume, direction)));
      break;
    case MediumShape::Ellipsoid:
      add(insideEllipsoid(byHalfAxes(volume, from), byHalfAxes(volume, direction)));
      break;
    case MediumShape::Surface:
      this->findInSurface(volume, origin - seconds * volume.velocity, direction, far, parts);
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
  const Vec3 to = volume.centreAt(seconds) - frame.origin;
  const double range = safeLength(to);
  if (range <= radius)
  {
    return true;
  }
  if (range - radius > far)
  {
    return false;
  }
  // Cosine of the half-beamwidth plus half the angle at which the ball appears.
  const double sine = radius / range;
  const double least = frame.cosHalf * std::sqrt(1.0 - sine * sine) - frame.sinHalf * sine;
  return glm::dot(frame.axis, to) >= (least - 1e-9) * range;
}

bool isWiderThan(const MediumVolume& volume, const BeamFrame& frame, double far, double seconds)
{
  const double range =
    std::min(far, safeLength(volume.centreAt(seconds) - frame.origin) + volume.radius());
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
  // The tangent is used because the sine would be too small by an eighth of the half-beamwidth
  // cubed.
  const double low = height + far * std::min(0.0, climb - frame.tanHalf);
  const double high = height + far * std::max(0.0, climb + frame.tanHalf);
  const bool isInside = low > volume.bottom && high < volume.top;
  const bool isOutside = high < volume.bottom || low > volume.top + NothingLeft * volume.softness;
  return !isInside && !isOutside;
}
}
