// SPDX-License-Identifier: BSD-3-Clause
#include "Random.h"

namespace avianlidar
{
std::array<double, 2> uniformPair(
  std::int32_t seed, std::uint64_t beam, std::uint64_t index, RandomPurpose purpose)
{
  std::array<double, 2> pair;
  lanes::uniformPair(seed, beam, index, purpose, pair[0], pair[1]);
  return pair;
}

std::array<double, 2> uniformPair(std::int32_t seed, std::uint64_t beam, std::uint64_t index,
  RandomPurpose purpose, std::int32_t revolution)
{
  // 12 bits of the revolution go above the bits of the index, and 20 bits above the purpose.
  const auto turn = static_cast<std::uint32_t>(revolution);
  return uniformPair(seed, beam, index | (static_cast<std::uint64_t>(turn) << 52),
    static_cast<RandomPurpose>(static_cast<std::uint32_t>(purpose) | (turn & ~0xFFFu)));
}
}
