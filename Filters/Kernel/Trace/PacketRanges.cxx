// SPDX-License-Identifier: BSD-3-Clause
#include "PacketRanges.h"

#include "Descents.h"
#include "RangeLanes.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
RayBits PacketRanges::compare(RayBits rays, std::uint32_t triangle)
{
  constexpr int Few = 4;
  RayBits hits = 0;
  for (int begin = 0; begin < this->Packet.count; begin += PacketGroup)
  {
    const auto group = static_cast<std::uint32_t>(rays >> begin & 0xffffu);
    if (__builtin_popcount(group) > Few && this->ofOneBeam(begin))
    {
      hits |= RayBits{ this->compareGroup(begin, group, triangle) } << begin;
      continue;
    }
    for (std::uint32_t rest = group; rest != 0; rest &= rest - 1)
    {
      const int ray = begin + __builtin_ctz(rest);
      hits |= RayBits{ this->compareRay(ray, triangle) } << ray;
    }
  }
  return hits;
}

/// True if sixteen rays belong to one beam; the rays of a beam follow each other.
bool PacketRanges::ofOneBeam(int begin) const
{
  const int last = std::min(begin + PacketGroup, this->Packet.count) - 1;
  return &this->Packet.frameOf(begin) == &this->Packet.frameOf(last);
}

/// Sixteen rays of one beam at a time.
std::uint32_t PacketRanges::compareGroup(int begin, std::uint32_t rays, std::uint32_t triangle)
{
  alignas(64) double dx[PacketGroup], dy[PacketGroup], dz[PacketGroup];
  alignas(64) double range[PacketGroup], known[PacketGroup];
  int kind[PacketGroup], knownKind[PacketGroup];
  const auto rangesOn = [&](std::uint32_t number, double* ranges, int* kinds)
  {
    const ExactTriangle& t = this->State.exact[number];
    planeRanges(PlaneView::Any, t.corners, t.plane, dx, dy, dz, ranges, kinds, PacketGroup);
  };
  unitDirections(this->Packet.frameOf(begin), this->Packet.x + begin, this->Packet.y + begin, dx,
    dy, dz, PacketGroup);
  rangesOn(triangle, range, kind);
  std::uint32_t hits = 0;
  std::uint32_t before = NoTriangle;
  for (std::uint32_t rest = rays; rest != 0; rest &= rest - 1)
  {
    const int i = __builtin_ctz(rest);
    const std::uint32_t other = this->State.best.triangle[begin + i];
    if (other != before && other != NoTriangle)
    {
      rangesOn(other, known, knownKind);
      before = other;
    }
    if (other != NoTriangle && kind[i] == 1 && knownKind[i] == 1)
    {
      this->keep(begin + i, { other, known[i] }, range[i], triangle);
      hits |= 1u << i;
    }
    else
    {
      hits |= std::uint32_t{ this->compareRay(begin + i, triangle) } << i;
    }
  }
  return hits;
}

RayBits PacketRanges::decide(RayBits rays, std::uint32_t triangle)
{
  BeamTriangle seen;
  const BeamFrame* frame = nullptr;
  RayBits accepted = 0;
  for (RayBits rest = rays; rest != 0; rest &= rest - 1)
  {
    const int ray = __builtin_ctzll(rest);
    if (&this->Packet.frameOf(ray) != frame)
    {
      frame = &this->Packet.frameOf(ray);
      const ExactTriangle& t = this->State.exact[triangle];
      if (!seen.set(BeamPlaneMap(*frame), t.corners, t.plane.sides))
      {
        break;
      }
    }
    const bool inside = seen.accepts(this->Packet.x[ray], this->Packet.y[ray]);
    accepted |= RayBits{ inside } << ray;
  }
  return this->compare(accepted, triangle);
}

/// A ray whose edge functions were accepted; false if it does not hit the triangle.
bool PacketRanges::compareRay(int ray, std::uint32_t triangle)
{
  const BeamFrame& frame = this->Packet.frameOf(ray);
  const Vec3 unit = this->Packet.direction(ray);
  const double margin = beamRayMargin(frame);
  const double range = this->exactRange(triangle, unit, margin);
  if (!(range > 0.0))
  {
    return false;
  }
  const std::uint32_t known = this->State.best.triangle[ray];
  const Hit before =
    known == NoTriangle ? Hit() : Hit{ known, this->exactRange(known, unit, margin) };
  this->keep(ray, before, range, triangle);
  return true;
}

/// The nearer of two hits, whose ranges are known exactly.
void PacketRanges::keep(int ray, Hit nearest, double range, std::uint32_t triangle)
{
  keepNearest(nearest, range, triangle);
  const Vec3 d = this->Packet.frameOf(ray).direction(this->Packet.x[ray], this->Packet.y[ray]);
  const auto inverse = static_cast<float>(std::sqrt(glm::dot(d, d)) / nearest.range);
  constexpr float Rounding = 4.0f * static_cast<float>(RoundOffSingle);
  PacketBest& best = this->State.best;
  best.low[ray] = inverse * (1.0f - Rounding);
  best.high[ray] = inverse * (1.0f + Rounding);
  best.triangle[ray] = nearest.triangle;
}

double PacketRanges::exactRange(std::uint32_t triangle, const Vec3& unit, double margin)
{
  const ExactTriangle& t = this->State.exact[triangle];
  return rangeOf(t.corners, t.plane, unit, margin);
}
}
