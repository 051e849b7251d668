// SPDX-License-Identifier: BSD-3-Clause
#include "Random.h"

#include <Random123/philox.h>

namespace avianlidar
{
std::array<double, 2> uniformPair(
  std::int32_t seed, std::uint64_t beam, std::uint64_t index, RandomPurpose purpose)
{
  const r123::Philox4x32::ctr_type counter = { { static_cast<std::uint32_t>(beam),
    static_cast<std::uint32_t>(beam >> 32), static_cast<std::uint32_t>(index),
    static_cast<std::uint32_t>(index >> 32) } };
  const r123::Philox4x32::key_type key = { { static_cast<std::uint32_t>(seed),
    static_cast<std::uint32_t>(purpose) } };
  const r123::Philox4x32::ctr_type words = r123::Philox4x32()(counter, key);
  return { lanes::openInterval(words[0], words[1]), lanes::openInterval(words[2], words[3]) };
}

std::array<double, 2> uniformPair(std::int32_t seed, std::uint64_t beam, std::uint64_t index,
  RandomPurpose purpose, std::int32_t revolution)
{
  // Its 32 bits go where no index and no purpose has any: 12 above the index, 20 above the purpose.
  const auto turn = static_cast<std::uint32_t>(revolution);
  return uniformPair(seed, beam, index | (static_cast<std::uint64_t>(turn) << 52),
    static_cast<RandomPurpose>(static_cast<std::uint32_t>(purpose) | (turn & ~0xFFFu)));
}
}
