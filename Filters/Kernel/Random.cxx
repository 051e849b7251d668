// SPDX-License-Identifier: BSD-3-Clause
#include "Random.h"

#include <Random123/philox.h>

namespace avianlidar
{
namespace
{
/// 53 bits, the last of them 1: an odd multiple of 2^-53, so neither 0 nor 1, and 1 - u is as exact
/// as u.
double openInterval(std::uint32_t low, std::uint32_t high)
{
  const std::uint64_t bits = (static_cast<std::uint64_t>(high) << 32) | low;
  return (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
}
}

std::array<double, 2> uniformPair(
  std::int32_t seed, std::uint64_t beam, std::uint64_t index, RandomPurpose purpose)
{
  const r123::Philox4x32::ctr_type counter = { { static_cast<std::uint32_t>(beam),
    static_cast<std::uint32_t>(beam >> 32), static_cast<std::uint32_t>(index),
    static_cast<std::uint32_t>(index >> 32) } };
  const r123::Philox4x32::key_type key = { { static_cast<std::uint32_t>(seed),
    static_cast<std::uint32_t>(purpose) } };
  const r123::Philox4x32::ctr_type words = r123::Philox4x32()(counter, key);
  return { openInterval(words[0], words[1]), openInterval(words[2], words[3]) };
}
}
