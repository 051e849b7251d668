// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketOrder.h
 * @brief Orders the numbers of a beam's rays in compact groups of sixteen, for packets.
 *
 * A stratified ray of a given number lies in the same cell in all beams, so one order serves all
 * beams. The order depends only on the number of rays, so the cost of a beam does not depend on
 * earlier work of the thread. For independent rays this order is as good as any other order. Rays
 * that already follow their neighbours keep their order.
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
/// Number of rays in a group. The last group is padded.
constexpr int PacketGroup = 16;

/// Finds the order of the rays of a beam. Each thread needs its own object.
class PacketOrder
{
public:
  /// Numbers of `rays` rays (at least 1), in compact groups of PacketGroup rays. The last group may
  /// have fewer rays. The numbers are valid until the next call, and are computed again only for
  /// another value of `rays`.
  const std::vector<std::uint32_t>& of(std::size_t rays);

  /// Numbers 0, 1, 2, ... of at least `rays` rays. The numbers are valid until the next call.
  const std::vector<std::uint32_t>& asTheyCome(std::size_t rays);

private:
  std::vector<std::uint32_t> Natural;
  std::vector<std::uint32_t> Known;
};
}

#endif
