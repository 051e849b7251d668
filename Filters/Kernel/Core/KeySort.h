// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file KeySort.h
 * @brief Sorts integers that hold a key in their high bits and a number in their low bits.
 *
 * Source: Wassenberg et al., "Vectorized and performance-portable Quicksort", 2022 (Highway's
 * VQSort).
 * Differs: short vectors are sorted by std::sort(), which is faster for few integers.
 * Valid: any integers. Two threads must not sort one vector.
 * Test: TestBeamCells.cxx, TestTriangleOrder.cxx, TestVisiblePolygons.cxx.
 */
#ifndef avianlidar_KeySort_h
#define avianlidar_KeySort_h

#include <cstdint>
#include <vector>

namespace avianlidar
{
/// Integer of a key (high 32 bits) and a number below 2^32 (low 32 bits).
inline std::uint64_t keyAbove(std::uint32_t key, std::size_t number)
{
  return static_cast<std::uint64_t>(key) << 32 | number;
}
inline std::uint32_t keyOf(std::uint64_t both)
{
  return static_cast<std::uint32_t>(both >> 32);
}
inline std::uint32_t numberOf(std::uint64_t both)
{
  return static_cast<std::uint32_t>(both);
}

/// Integer of 128 bits.
struct alignas(16) LongKey
{
  std::uint64_t low;
  std::uint64_t high;
};

void sortKeys(std::vector<std::uint64_t>& keys);
void sortKeys(std::vector<LongKey>& keys);
}

#endif
