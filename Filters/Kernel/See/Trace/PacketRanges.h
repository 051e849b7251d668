// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketRanges.h
 * @brief Applies the exact functions of TriangleTest.h where the bounds of single precision leave
 * open whether a ray of a packet hits a triangle, or which of two triangles the ray hits first.
 *
 * Source: none.
 * Valid: hits are bitwise identical to the hits of single rays.
 * Test: TestRayPacket.cxx.
 */
#ifndef avianlidar_PacketRanges_h
#define avianlidar_PacketRanges_h

#include "RayPacket.h"

#include <cstdint>

namespace avianlidar
{
/// Exact decisions for one packet during its descent. The packet's state must outlive the object.
class PacketRanges
{
public:
  explicit PacketRanges(PacketState& state)
    : State(state)
    , Packet(*state.packet)
  {
  }

  /// Compare the ranges of rays whose edge functions were accepted, and keep the nearer hit of each
  /// ray. @return rays that hit the triangle
  RayBits compare(RayBits rays, std::uint32_t triangle);

  /// Test rays that may hit the triangle, and keep the nearer hit of each ray. @return rays that
  /// hit the triangle
  RayBits decide(RayBits rays, std::uint32_t triangle);

private:
  bool compareRay(int ray, std::uint32_t triangle);
  double exactRange(std::uint32_t triangle, const Vec3& unit, double margin);

  PacketState& State;
  RayPacket& Packet;
};
}

#endif
