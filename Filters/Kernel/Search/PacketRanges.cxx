// SPDX-License-Identifier: BSD-3-Clause
#include "PacketRanges.h"

#include "RangeLanes.h"
#include "TraceVisitors.h"
#include "TriangleTest.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
namespace
{
constexpr int Width = RayPacket::Width;
}

/// Exact ranges of `left`, rays whose nearest triangle is known.
template <typename Real>
void PacketRanges<Real>::settle(RayBits left)
{
  PacketState& s = this->State;
  s.unsettled &= ~left;
  this->findUnitDirections(left);
  // Mostly a few triangles have most of the rays; where many have one each, all go together.
  constexpr int FewTriangles = 6;
  for (int n = 0; n < FewTriangles && left != 0; ++n)
  {
    left &= ~this->settleTriangle(s.best.triangle[__builtin_ctzll(left)], left);
  }
  this->settleRays(left);
}

/// Unit directions of at least these rays.
template <typename Real>
void PacketRanges<Real>::findUnitDirections(RayBits rays)
{
  PacketState& s = this->State;
  RayBits left = rays & ~s.unitKnown;
  for (int begin = 0; left != 0; begin += PacketGroup, left >>= PacketGroup)
  {
    if ((left & 0xffffu) != 0)
    {
      unitDirections(this->Packet, begin, s.unit);
      s.unitKnown |= RayBits(0xffffu) << begin;
    }
  }
}

/// @return the rays of `left` that hit the triangle; their ranges are found
template <typename Real>
RayBits PacketRanges<Real>::settleTriangle(std::uint32_t triangle, RayBits left)
{
  return this->rangesOn(
    triangle, left, this->State.best.triangle, this->Packet.triangle, this->Packet.range);
}

/// Ranges of the rays of `left` whose `owner` is the triangle, if the plane's range stands.
/// @return these rays
template <typename Real>
RayBits PacketRanges<Real>::rangesOn(std::uint32_t triangle, RayBits left,
  const std::uint32_t* owner, std::uint32_t* hit, double* range)
{
  PacketState& s = this->State;
  const auto& [number, corners, plane] = s.exact[triangle];
  const BeamFrame* const beam = this->Packet.beam;
  const PlaneView view =
    beam ? viewOfCone(plane, beam->axis, beam->sinHalf, beam->cosHalf) : PlaneView::Any;
  RayBits all = 0;
  for (int begin = 0; begin < this->Packet.count; begin += PacketGroup)
  {
    const auto rays = static_cast<std::uint32_t>(left >> begin & 0xffffu);
    if (rays != 0)
    {
      all |= static_cast<RayBits>(planeHits(view, corners, plane, rays, owner + begin, number,
               s.unit.x + begin, s.unit.y + begin, s.unit.z + begin, hit + begin, range + begin))
        << begin;
    }
  }
  return all;
}

/// Rays that surely hit the triangle about as far away as what they hit before: which is nearer?
/// @return those whose nearest hit has changed
template <typename Real>
RayBits PacketRanges<Real>::compareLevel(RayBits rays, std::uint32_t triangle)
{
  PacketState& s = this->State;
  this->settle(rays & s.unsettled);
  this->findUnitDirections(rays);
  alignas(64) std::uint32_t hit[Width];
  alignas(64) double range[Width];
  std::fill(hit, hit + Width, triangle);
  this->rangesOn(triangle, rays, hit, hit, range);
  RayBits changed = 0;
  for (RayBits rest = rays; rest != 0; rest &= rest - 1)
  {
    const int ray = __builtin_ctzll(rest);
    Hit nearest = this->Packet.hit(ray);
    keepNearest(nearest, range[ray], triangle);
    if (nearest.triangle == triangle && range[ray] > 0.0)
    {
      this->Packet.setHit(ray, nearest);
      this->setBest(ray);
      changed |= RayBits(1) << ray;
    }
  }
  return changed;
}

/// Exact ranges of rays each of which hits another triangle.
template <typename Real>
void PacketRanges<Real>::settleRays(RayBits rays)
{
  if (rays == 0)
  {
    return;
  }
  PacketState& s = this->State;
  for (RayBits rest = rays; rest != 0; rest &= rest - 1)
  {
    const int ray = __builtin_ctzll(rest);
    for (int c = 0; c < 3; ++c)
    {
      const Vec3 p = this->Mesh.corner(s.best.triangle[ray], c) - this->apex();
      s.winners.corner[c][0][ray] = p.x;
      s.winners.corner[c][1][ray] = p.y;
      s.winners.corner[c][2][ray] = p.z;
    }
  }
  alignas(64) double range[Width];
  rangesOnTriangles(s.winners, padded(this->Packet.count), s.unit.x, s.unit.y, s.unit.z, range);
  for (RayBits rest = rays; rest != 0; rest &= rest - 1)
  {
    const int ray = __builtin_ctzll(rest);
    this->Packet.setHit(ray, { s.best.triangle[ray], range[ray] });
  }
}

/// Best of a ray whose nearest hit is known exactly, or that has none.
template <typename Real>
void PacketRanges<Real>::setBest(int ray)
{
  PacketState& s = this->State;
  const Hit hit = this->Packet.hit(ray);
  const Vec3 d = this->Packet.frameOf(ray).direction(this->Packet.x[ray], this->Packet.y[ray]);
  const auto inverse = static_cast<float>(std::sqrt(glm::dot(d, d)) / hit.range);
  constexpr float Rounding = 4.0f * static_cast<float>(RoundOffSingle);
  s.best.low[ray] = inverse * (1.0f - Rounding);
  s.best.high[ray] = inverse * (1.0f + Rounding);
  s.best.triangle[ray] = hit.triangle;
}

template <typename Real>
double PacketRanges<Real>::exactRange(int ray, std::uint32_t triangle)
{
  const ExactTriangles::Triangle& t = this->State.exact[triangle];
  return rangeOf(
    t.corners, t.plane, this->Packet.direction(ray), beamRayMargin(this->Packet.frameOf(ray)));
}

/// The exact functions for one triangle and the rays that it may be the nearest hit of.
/// @return rays that hit it
template <typename Real>
RayBits PacketRanges<Real>::decide(RayBits rays, std::uint32_t triangle)
{
  BeamTriangle<Real> seen;
  const BeamFrame* frame = nullptr;
  RayBits hits = 0;
  for (RayBits rest = rays; rest != 0; rest &= rest - 1)
  {
    const int ray = __builtin_ctzll(rest);
    if (&this->Packet.frameOf(ray) != frame)
    {
      frame = &this->Packet.frameOf(ray);
      const ExactTriangles::Triangle& t = this->State.exact[triangle];
      if (!seen.set(BeamPlaneMap(*frame), t.corners, t.plane.sides))
      {
        break;
      }
    }
    if (seen.accepts(
          static_cast<Real>(this->Packet.x[ray]), static_cast<Real>(this->Packet.y[ray])) &&
      this->decideRange(ray, triangle))
    {
      hits |= RayBits(1) << ray;
    }
  }
  return hits;
}

/// A ray whose edge functions were accepted; false if it does not hit the triangle.
template <typename Real>
bool PacketRanges<Real>::decideRange(int ray, std::uint32_t triangle)
{
  const double range = this->exactRange(ray, triangle);
  if (!(range > 0.0))
  {
    return false;
  }
  PacketState& s = this->State;
  Hit hit = this->Packet.hit(ray);
  const RayBits bit = RayBits(1) << ray;
  if (s.unsettled & bit)
  {
    const std::uint32_t known = s.best.triangle[ray];
    hit = { known, this->exactRange(ray, known) };
    s.unsettled &= ~bit;
  }
  keepNearest(hit, range, triangle);
  this->Packet.setHit(ray, hit);
  this->setBest(ray);
  return true;
}

template class PacketRanges<float>;
template class PacketRanges<double>;
}
