// SPDX-License-Identifier: BSD-3-Clause
#include "PacketRanges.h"

#include "Descents.h"
#include "TriangleTest.h"

#include <cmath>

namespace avianlidar
{
RayBits PacketRanges::compare(RayBits rays, std::uint32_t triangle)
{
  RayBits hits = 0;
  for (; rays != 0; rays &= rays - 1)
  {
    const int ray = __builtin_ctzll(rays);
    hits |= RayBits{ this->compareRay(ray, triangle) } << ray;
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

/// Compare a ray whose edge functions were accepted. @return false if the ray does not hit the
/// triangle
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
  Hit nearest = known == NoTriangle ? Hit() : Hit{ known, this->exactRange(known, unit, margin) };
  keepNearest(nearest, range, triangle);
  const Vec3 d = frame.direction(this->Packet.x[ray], this->Packet.y[ray]);
  const auto inverse = static_cast<float>(std::sqrt(glm::dot(d, d)) / nearest.range);
  constexpr float Rounding = 4.0f * static_cast<float>(RoundOffSingle);
  PacketBest& best = this->State.best;
  best.low[ray] = inverse * (1.0f - Rounding);
  best.high[ray] = inverse * (1.0f + Rounding);
  best.triangle[ray] = nearest.triangle;
  return true;
}

double PacketRanges::exactRange(std::uint32_t triangle, const Vec3& unit, double margin)
{
  const ExactTriangle& t = this->State.exact[triangle];
  return rangeOf(t.corners, t.plane, unit, margin);
}
}
