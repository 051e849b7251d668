// SPDX-License-Identifier: BSD-3-Clause
// Philox4x32-10 against the library of its authors, and the doubles made of it.
#include "Random.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>

using namespace avianlidar;

namespace
{
std::uint32_t low(std::uint64_t value)
{
  return static_cast<std::uint32_t>(value);
}

std::uint32_t high(std::uint64_t value)
{
  return static_cast<std::uint32_t>(value >> 32);
}

/// The odd multiple of 2^-53 made of the upper 52 bits, by integers.
double expected(std::uint32_t low, std::uint32_t high)
{
  const std::uint64_t joined = (static_cast<std::uint64_t>(high) << 32) | low;
  return std::ldexp(static_cast<double>(2 * (joined >> 12) + 1), -53);
}
}

TEST(Random, GivesTheBitsOfTheLibrary)
{
  for (const RandomPurpose purpose : { RandomPurpose::Rays, RandomPurpose::Noise })
  {
    for (std::uint64_t i = 0; i < 20000; ++i)
    {
      const auto seed = static_cast<std::int32_t>(i * 2654435761u);
      const std::uint64_t beam = i * 7777777777777u;
      const std::uint64_t index = i * i * 1234567u;
      const r123::Philox4x32::ctr_type words =
        r123::Philox4x32()({ { low(beam), high(beam), low(index), high(index) } },
          { { static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(purpose) } });
      const auto pair = uniformPair(seed, beam, index, purpose);
      ASSERT_EQ(pair[0], expected(words[0], words[1])) << i;
      ASSERT_EQ(pair[1], expected(words[2], words[3])) << i;
    }
  }
}

TEST(Random, EveryRevolutionIsAStreamOfItsOwn)
{
  const std::uint64_t last = (std::uint64_t{ 1 } << 52) - 1;
  std::set<double> seen;
  std::size_t drawn = 0;
  for (const std::int32_t revolution :
    { 0, 1, 2, 4095, 4096, 4097, 1 << 20, 2147483647, -1, -2, -4096, -2147483647 - 1 })
  {
    for (const std::uint64_t index : { std::uint64_t{ 0 }, std::uint64_t{ 1 }, last })
    {
      for (const RandomPurpose purpose : { RandomPurpose::Noise, RandomPurpose::FalseAlarms })
      {
        const auto pair = uniformPair(3, 5, index, purpose, revolution);
        seen.insert(pair[0]);
        seen.insert(pair[1]);
        drawn += 2;
        if (revolution == 0)
        {
          EXPECT_EQ(pair, uniformPair(3, 5, index, purpose));
        }
      }
    }
  }
  EXPECT_EQ(seen.size(), drawn);
}
