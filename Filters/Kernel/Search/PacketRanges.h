// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketRanges.h
 * @brief What the bounds of single precision leave to the exact functions (TriangleTest.h) while a
 * packet goes down the tree: which of two triangles a ray hits, and at the end the ranges of the
 * winners.
 */
#ifndef avianlidar_PacketRanges_h
#define avianlidar_PacketRanges_h

#include "RayPacket.h"

#include <cstdint>

namespace avianlidar
{
/// Of one packet under way; what the constructor is given must outlive it. `Real`: precision of the
/// edge functions.
template <typename Real>
class PacketRanges
{
public:
  PacketRanges(const TriangleMesh& mesh, PacketState& state)
    : Mesh(mesh)
    , State(state)
    , Packet(*state.packet)
  {
  }

  /// Exact ranges of the rays whose nearest triangle is known and nothing else.
  void settle() { this->settle(this->State.unsettled); }

  /// Rays that surely hit the triangle about as far away as what they hit before: which is nearer?
  /// @return those whose nearest hit has changed
  RayBits compareLevel(RayBits rays, std::uint32_t triangle);

  /// The exact functions for one triangle and the rays that it may be the nearest hit of.
  /// @return rays that hit it
  RayBits decide(RayBits rays, std::uint32_t triangle);

private:
  void settle(RayBits left);
  void findUnitDirections(RayBits rays);
  RayBits settleTriangle(std::uint32_t triangle, RayBits left);
  RayBits rangesOn(std::uint32_t triangle, RayBits left, const std::uint32_t* owner,
    std::uint32_t* hit, double* range);
  void settleRays(RayBits rays);
  void setBest(int ray);
  double exactRange(int ray, std::uint32_t triangle);
  bool decideRange(int ray, std::uint32_t triangle);
  const Vec3& apex() const { return this->Packet.frameOf(0).origin; }

  const TriangleMesh& Mesh;
  PacketState& State;
  RayPacket& Packet;
};
}

#endif
