// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PacketOrder.h
 * @brief Which rays of a beam go together in packets.
 *
 * Stratified rays of equal number lie in the same cells, so that one order, found from the cells,
 * serves all beams. It depends on nothing else: what a beam costs is the same number whatever
 * its thread did before. Independent rays, which lie anywhere, are as well served by it as by any
 * other; those of small targets lie together, target by target, as they come.
 */
#ifndef avianlidar_PacketOrder_h
#define avianlidar_PacketOrder_h

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace avianlidar
{
/// Reusable; one per thread.
class PacketOrder
{
public:
  /// Numbers of `rays` (at least 1) rays in compact groups of PacketGroup, the last of fewer. It
  /// stands until the next call.
  const std::vector<std::uint32_t>& of(std::size_t rays);

  /// Numbers from 0 on, of at least `rays` rays; they stand until the next call.
  const std::vector<std::uint32_t>& asTheyCome(std::size_t rays);

private:
  std::vector<std::uint32_t> Natural;
  std::map<std::size_t, std::vector<std::uint32_t>> Known;
};
}

#endif
