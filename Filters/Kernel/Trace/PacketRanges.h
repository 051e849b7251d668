// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketRanges.h
 * @brief What the bounds of single precision leave to the exact functions (TriangleTest.h) while a
 * packet goes down the tree: whether a ray hits a triangle, and which of two it hits first.
 */
#ifndef avianlidar_PacketRanges_h
#define avianlidar_PacketRanges_h

#include "RayPacket.h"

#include <cstdint>

namespace avianlidar
{
/// Of one packet under way; what the constructor is given must outlive it.
class PacketRanges
{
public:
  explicit PacketRanges(PacketState& state)
    : State(state)
    , Packet(*state.packet)
  {
  }

  /// Rays that surely hit the triangle about as far away as what they hit before: which is nearer?
  /// @return rays of which more is known than before
  RayBits compare(RayBits rays, std::uint32_t triangle);

  /// The exact functions for one triangle and the rays that it may be the nearest hit of.
  /// @return rays that hit it
  RayBits decide(RayBits rays, std::uint32_t triangle);

private:
  std::uint32_t compareGroup(int begin, std::uint32_t rays, std::uint32_t triangle);
  bool compareRay(int ray, std::uint32_t triangle);
  void keep(int ray, Hit nearest, double range, std::uint32_t triangle);
  double exactRange(std::uint32_t triangle, const Vec3& unit, double margin);

  PacketState& State;
  RayPacket& Packet;
};
}

#endif
