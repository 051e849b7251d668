// SPDX-License-Identifier: BSD-3-Clause
// Philox4x32-10 against the known answers that its authors publish, and the doubles made of it.
#include "Random.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>

using namespace avianlidar;

namespace
{
struct KnownAnswer
{
  std::uint32_t counter[4];
  std::uint32_t key[2];
  std::uint32_t words[4];
};

// Random123, tests/kat_vectors, "philox4x32 10".
const KnownAnswer knownAnswers[] = {
  { { 0, 0, 0, 0 }, { 0, 0 }, { 0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8 } },
  { { 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff }, { 0xffffffff, 0xffffffff },
    { 0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd } },
  { { 0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344 }, { 0xa4093822, 0x299f31d0 },
    { 0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1 } },
};

std::uint64_t join(std::uint32_t low, std::uint32_t high)
{
  return (static_cast<std::uint64_t>(high) << 32) | low;
}

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
  return std::ldexp(static_cast<double>(2 * (join(low, high) >> 12) + 1), -53);
}
}

TEST(Random, KnownAnswersOfTheAuthors)
{
  for (const KnownAnswer& known : knownAnswers)
  {
    const auto pair =
      uniformPair(static_cast<std::int32_t>(known.key[0]), join(known.counter[0], known.counter[1]),
        join(known.counter[2], known.counter[3]), static_cast<RandomPurpose>(known.key[1]));
    EXPECT_EQ(pair[0], expected(known.words[0], known.words[1]));
    EXPECT_EQ(pair[1], expected(known.words[2], known.words[3]));
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
