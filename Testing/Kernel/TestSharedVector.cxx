// SPDX-License-Identifier: BSD-3-Clause
// Shared vectors give back their elements, however many of these differ.
#include "SharedVector.h"

#include <gtest/gtest.h>

#include <vector>

using namespace avianlidar;

TEST(SharedVector, GivesBackItsElements)
{
  for (const int different : { 1, 2, 65536, 65537 })
  {
    std::vector<int> values;
    for (int i = 0; i < 70000; ++i)
    {
      values.push_back((i / 3 * 7919) % different - 5);
    }
    for (int i = 0; i < different; ++i)
    {
      values.push_back(i - 5);
    }
    const SharedVector<int> shared = values;
    ASSERT_EQ(shared.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
    {
      ASSERT_EQ(shared[i], values[i]) << different << ' ' << i;
    }
    if (different <= 65536)
    {
      EXPECT_EQ(shared.different().size(), static_cast<std::size_t>(different));
    }
    EXPECT_EQ(shared.checksum(), hashOf(values.data(), values.size() * sizeof(int), 0));
  }
}

TEST(SharedVector, MayBeEmpty)
{
  const SharedVector<double> shared = std::vector<double>{};
  EXPECT_TRUE(shared.empty());
  EXPECT_EQ(shared.size(), 0u);
  EXPECT_EQ(shared.checksum(), 0u);
  EXPECT_TRUE(shared.different().empty());
}
