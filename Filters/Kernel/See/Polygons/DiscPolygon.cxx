// SPDX-License-Identifier: BSD-3-Clause
#include "DiscPolygon.h"

#include "LaneMath.h"
#include "Multiversion.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
double half(double p)
{
  return std::sqrt(std::max(0.0, (1.0 - p) * (1.0 + p)));
}

/// Append p of the points where a side crosses the unit circle.
void addCrossings(const PlanePoint& a, const PlanePoint& b, double* places, int& count)
{
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double length2 = dx * dx + dy * dy;
  if (!(length2 > 0.0))
  {
    return;
  }
  const double cross = (a.x * b.y - a.y * b.x);
  const double beside = length2 - cross * cross; // (1 - distance^2) length^2
  if (!(beside > 0.0))
  {
    return;
  }
  const double middle = -(a.x * dx + a.y * dy);
  const double reach = std::sqrt(beside);
  for (const double t : { (middle - reach) / length2, (middle + reach) / length2 })
  {
    if (t > 0.0 && t < 1.0)
    {
      places[count++] = std::clamp(a.x + t * dx, -1.0, 1.0);
    }
  }
}
}

double DiscPolygon::Bound::at(double p) const
{
  return this->arc ? this->b * half(p) : this->a + this->b * p;
}

void DiscPolygon::set(const PlaneRing& ring, const PlanePoint& along)
{
  this->Count = 0;
  const double slope = std::hypot(along.x, along.y);
  const double c = slope > 0.0 ? along.x / slope : 1.0;
  const double s = slope > 0.0 ? along.y / slope : 0.0;
  PlaneRing turned;
  bool inside = true;
  double places[MostStrips + 1];
  int count = 0;
  for (int i = 0; i < ring.size; ++i)
  {
    const PlanePoint& v = ring.corners[i];
    turned.add({ c * v.x + s * v.y, c * v.y - s * v.x });
    inside = inside && v.x * v.x + v.y * v.y <= 1.0;
    places[count++] = std::clamp(turned.corners[i].x, -1.0, 1.0);
  }
  for (int i = 0; i < ring.size && !inside; ++i)
  {
    addCrossings(turned.corners[i], turned.corners[(i + 1) % ring.size], places, count);
  }
  if (!inside)
  {
    places[count++] = -1.0;
    places[count++] = 1.0;
  }
  std::sort(places, places + count);
  for (int k = 1; k < count; ++k)
  {
    Strip strip{ places[k - 1], places[k], {}, {} };
    const double middle = 0.5 * (strip.from + strip.to);
    if (!(strip.from < middle && middle < strip.to))
    {
      continue;
    }
    bool met = false;
    double top = 0.0;
    double bottom = 0.0;
    for (int i = 0; i < turned.size; ++i)
    {
      const PlanePoint& a = turned.corners[i];
      const PlanePoint& b = turned.corners[(i + 1) % turned.size];
      if (!(std::min(a.x, b.x) < middle && middle < std::max(a.x, b.x)))
      {
        continue;
      }
      const double slant = (b.y - a.y) / (b.x - a.x);
      const double q = a.y + slant * (middle - a.x);
      const Bound bound{ false, a.y - slant * a.x, slant };
      if (!met || q > top)
      {
        top = q;
        strip.upper = bound;
      }
      if (!met || q < bottom)
      {
        bottom = q;
        strip.lower = bound;
      }
      met = true;
    }
    const double rim = half(middle);
    if (!met || (!inside && (bottom >= rim || top <= -rim)))
    {
      continue;
    }
    if (!inside && top > rim)
    {
      strip.upper = { true, 0.0, 1.0 };
    }
    if (!inside && bottom < -rim)
    {
      strip.lower = { true, 0.0, -1.0 };
    }
    this->Strips[this->Count++] = strip;
  }
}

namespace
{
/// Moments of some parts.
struct MomentLanes
{
  double *area, *p, *pp, *qq, *qqqq;
};

/// Add the moments below the line q = a + b p, between each place and the next place.
AVIANLIDAR_MULTIVERSION void addLine(
  const double* places, std::size_t parts, double a, double b, double sign, const MomentLanes& into)
{
  const MomentLanes m = into;
#pragma omp simd
  for (std::size_t i = 0; i < parts; ++i)
  {
    const double middle = 0.5 * (places[i] + places[i + 1]);
    const double h = 0.5 * (places[i + 1] - places[i]);
    const double q = a + b * middle;
    const double q2 = q * q;
    const double d2 = h * h * b * b;
    const double zero = sign * 2.0 * h * q;
    const double one = sign * (2.0 / 3.0) * h * h * h * b;
    const double two = zero * h * h * (1.0 / 3.0);
    m.area[i] += zero;
    m.p[i] += one + middle * zero;
    m.pp[i] += two + middle * (2.0 * one + middle * zero);
    m.qq[i] += zero * (q2 + d2) * (1.0 / 3.0);
    m.qqqq[i] += zero * (q2 * q2 + d2 * ((10.0 / 3.0) * q2 + d2)) * (1.0 / 5.0);
  }
}

/// Primitives of s, p s, p^2 s, s^3 and s^5, s = sqrt(1 - p^2), one after the other.
AVIANLIDAR_MULTIVERSION void primitivesOf(const double* places, std::size_t count, double* to)
{
#pragma omp simd
  for (std::size_t i = 0; i < count; ++i)
  {
    const double p = places[i];
    const double square = (1.0 - p) * (1.0 + p);
    const double q = std::sqrt(square > 0.0 ? square : 0.0);
    const double angle = std::copysign(lanes::asin(std::fabs(p)), p);
    const double pq = p * q;
    const double p2 = p * p;
    to[i] = 0.5 * (pq + angle);
    to[count + i] = -q * q * q * (1.0 / 3.0);
    to[2 * count + i] = 0.125 * (angle - pq * (1.0 - 2.0 * p2));
    to[3 * count + i] = 0.125 * (pq * (5.0 - 2.0 * p2) + 3.0 * angle);
    to[4 * count + i] = (pq * (33.0 - p2 * (26.0 - 8.0 * p2)) + 15.0 * angle) * (1.0 / 48.0);
  }
}

/// Add the moments below the arc.
AVIANLIDAR_MULTIVERSION void addArc(
  const double* primitives, std::size_t parts, double sign, const MomentLanes& into)
{
  const MomentLanes m = into;
  const std::size_t count = parts + 1;
  const double* const zero = primitives;
  const double* const one = primitives + count;
  const double* const two = primitives + 2 * count;
  const double* const cube = primitives + 3 * count;
  const double* const fifth = primitives + 4 * count;
#pragma omp simd
  for (std::size_t i = 0; i < parts; ++i)
  {
    m.area[i] += sign * (zero[i + 1] - zero[i]);
    m.p[i] += sign * (one[i + 1] - one[i]);
    m.pp[i] += sign * (two[i + 1] - two[i]);
    m.qq[i] += sign * (cube[i + 1] - cube[i]) * (1.0 / 3.0);
    m.qqqq[i] += sign * (fifth[i + 1] - fifth[i]) * (1.0 / 5.0);
  }
}
}

void DiscPolygon::measure(const std::vector<double>& borders, PartMoments& moments)
{
  const std::size_t parts = borders.size() - 1;
  moments.reset(parts);
  std::size_t first = 0;
  for (int k = 0; k < this->Count; ++k)
  {
    const Strip& strip = this->Strips[k];
    while (first < parts && borders[first + 1] <= strip.from)
    {
      ++first;
    }
    std::size_t last = first;
    this->Places.assign(1, std::max(borders[first], strip.from));
    while (last < parts && borders[last] < strip.to)
    {
      this->Places.push_back(std::min(borders[++last], strip.to));
    }
    this->addStrip(strip, first, last - first, moments);
  }
}

void DiscPolygon::addStrip(
  const Strip& strip, std::size_t first, std::size_t parts, PartMoments& moments)
{
  const MomentLanes into{ moments.area.data() + first, moments.p.data() + first,
    moments.pp.data() + first, moments.qq.data() + first, moments.qqqq.data() + first };
  if (strip.upper.arc || strip.lower.arc)
  {
    this->Arcs.resize(5 * (parts + 1));
    primitivesOf(this->Places.data(), parts + 1, this->Arcs.data());
  }
  for (const auto& [bound, sign] :
    { std::pair<const Bound*, double>{ &strip.upper, 1.0 }, { &strip.lower, -1.0 } })
  {
    bound->arc ? addArc(this->Arcs.data(), parts, sign * bound->b, into)
               : addLine(this->Places.data(), parts, bound->a, bound->b, sign, into);
  }
}

DiscPolygon::Chord DiscPolygon::chordAt(double p) const
{
  int k = 0;
  while (k + 1 < this->Count && this->Strips[k].to < p)
  {
    ++k;
  }
  const Strip& strip = this->Strips[k];
  const double inside = std::clamp(p, strip.from, strip.to);
  return { strip.lower.at(inside), strip.upper.at(inside) };
}

namespace
{
double cross(const PlanePoint& p, const PlanePoint& q)
{
  return p.x * q.y - p.y * q.x;
}

/// Signed area of the disc's sector between the directions of two points.
double sectorOf(const PlanePoint& p, const PlanePoint& q)
{
  return 0.5 * std::atan2(cross(p, q), p.x * q.x + p.y * q.y);
}

/// Signed area of a triangle's part in the disc. One corner is the centre.
double wedgeInDisc(const PlanePoint& p, const PlanePoint& q)
{
  const PlanePoint d{ q.x - p.x, q.y - p.y };
  const double length2 = d.x * d.x + d.y * d.y;
  const double beside = length2 - cross(p, q) * cross(p, q); // (1 - distance^2) length^2
  if (!(beside > 0.0))
  {
    return sectorOf(p, q);
  }
  const double middle = -(p.x * d.x + p.y * d.y);
  const double reach = std::sqrt(beside);
  const double from = std::max(0.0, (middle - reach) / length2);
  const double to = std::min(1.0, (middle + reach) / length2);
  if (!(from < to))
  {
    return sectorOf(p, q);
  }
  const PlanePoint in{ p.x + from * d.x, p.y + from * d.y };
  const PlanePoint out{ p.x + to * d.x, p.y + to * d.y };
  return 0.5 * cross(in, out) + (from > 0.0 ? sectorOf(p, in) : 0.0) +
    (to < 1.0 ? sectorOf(out, q) : 0.0);
}
}

double areaInDisc(const PlaneRing& ring)
{
  double area = 0.0;
  for (int i = 0; i < ring.size; ++i)
  {
    area += wedgeInDisc(ring.corners[i], ring.corners[i + 1 == ring.size ? 0 : i + 1]);
  }
  return std::fabs(area);
}
}
