// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketOrder.h
 * @brief Orders the numbers of a beam's rays in compact groups of sixteen, for packets.
 *
 * Stratified rays of equal number lie in the same cells in all beams, so the order found for one
 * beam is used for all beams. The order depends only on the number of rays, so the cost of a beam
 * does not depend on earlier work of the thread. For independent rays this order is as good as any
 * other. Rays that already follow their neighbours keep their order.
 *
 * Source: none.
 * Valid: any number of rays, at least 1. The order affects cost only, never hits.
 * Test: TestPacketOrder.cxx.
 */
#ifndef avianlidar_PacketOrder_h
#define avianlidar_PacketOrder_h

#include <cstddef>
#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Rays are tested in groups of sixteen; the last group is padded.
constexpr int PacketGroup = 16;

/// Finds the order of the rays of a beam. One object per thread.
class PacketOrder
{
public:
  /// Numbers of `rays` (at least 1) rays in compact groups of PacketGroup; the last group may have
  /// fewer. Valid until the next call; computed again if `rays` differs from the last call.
  const std::vector<std::uint32_t>& of(std::size_t rays);

  /// Numbers 0, 1, 2, ... of at least `rays` rays. Valid until the next call.
  const std::vector<std::uint32_t>& asTheyCome(std::size_t rays);

private:
  std::vector<std::uint32_t> Natural;
  std::vector<std::uint32_t> Known;
};
}

#endif
