// SPDX-License-Identifier: BSD-3-Clause
// A vector in blocks is a vector; blocks are shared until they are written to; what follows from a
// scene is the same whether it was followed from change to change or worked out at once.
#include "SceneSummary.h"
#include "SharedBlocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <type_traits>
#include <utility>

using namespace avianlidar;

namespace
{
std::vector<int> numbers(std::size_t count)
{
  std::vector<int> values(count);
  std::iota(values.begin(), values.end(), 0);
  return values;
}
}

TEST(SharedBlocks, HoldWhatAVectorHolds)
{
  for (const std::size_t count : { 0, 1, 1023, 1024, 1025, 5000 })
  {
    const std::vector<int> values = numbers(count);
    const SharedBlocks<int> blocks(values);
    ASSERT_EQ(blocks.size(), count);
    EXPECT_EQ(blocks.empty(), count == 0);
    EXPECT_TRUE(std::equal(values.begin(), values.end(), blocks.begin()));
    std::size_t sum = 0;
    for (std::size_t k = 0; k < blocks.blocks(); ++k)
    {
      sum += blocks.block(k).size();
    }
    EXPECT_EQ(sum, count);
  }
}

TEST(SharedBlocks, AWriteTouchesOneBlockOfOneCopy)
{
  SharedBlocks<int> one(numbers(5000));
  const SharedBlocks<int> two = one;
  EXPECT_TRUE(one.sharesWith(two));
  one[2048] = -1;
  EXPECT_EQ(two[2048], 2048);
  EXPECT_EQ(std::as_const(one)[2048], -1);
  EXPECT_FALSE(one.sharesWith(two));
  for (std::size_t k = 0; k < one.blocks(); ++k)
  {
    EXPECT_EQ(one.sharesBlock(k, two), k != 2) << k;
  }
  one[2048] = 2048;
  EXPECT_FALSE(one.sharesWith(two));
  one.shareWith(two);
  EXPECT_TRUE(one.sharesWith(two));
  const SharedBlocks<int> shorter(numbers(4999));
  one.shareWith(shorter);
  EXPECT_TRUE(one.sharesBlock(3, shorter));
  EXPECT_FALSE(one.sharesBlock(4, shorter));
}

TEST(SharedBlocks, AVectorIsCopiedOnlyWhereThatIsSaid)
{
  static_assert(!std::is_convertible<std::vector<int>, SharedBlocks<int>>::value,
    "no argument is copied unnoticed");
  SharedBlocks<int> one(numbers(2000));
  const SharedBlocks<int> two = one;
  one = numbers(2000);
  EXPECT_FALSE(one.sharesBlock(0, two));
  one = numbers(3);
  ASSERT_EQ(one.size(), 3u);
  EXPECT_EQ(std::as_const(one)[2], 2);
  EXPECT_EQ(two.size(), 2000u);
}

TEST(SceneSummary, IsThatOfASceneLookedAtAtOnce)
{
  ScanSetup setup;
  setup.materials = std::vector<Material>(5000, Material{ 0.1, 0.2, 3.0 });
  setup.objectIds.assign(5000, 1);
  setup.materialIds.assign(5000, 2);
  SceneSummary followed;
  std::vector<std::uint64_t> checksums;
  const auto check = [&](double largest)
  {
    SceneSummary atOnce;
    atOnce.follow(setup);
    followed.follow(setup);
    EXPECT_EQ(followed.largestReflectance(), largest);
    EXPECT_EQ(atOnce.largestReflectance(), largest);
    EXPECT_EQ(followed.checksum(7), atOnce.checksum(7));
    EXPECT_NE(followed.checksum(7), followed.checksum(8));
    checksums.push_back(followed.checksum(7));
  };
  check(0.1 + 0.2);
  setup.materials[4999] = { 0.5, 0.25, 1.0 };
  check(0.75);
  setup.materials[4999].kp = 2.0;
  check(0.75);
  setup.materials[0] = { 0.5, 0.375, 1.0 };
  check(0.875);
  setup.materials[0] = { 0.1, 0.2, 3.0 };
  check(0.75);
  setup.objectIds[4000] = 3;
  check(0.75);
  setup.materialIds[4000] = 3;
  check(0.75);
  EXPECT_EQ(checksums[4], checksums[2]); // the same scene again
  checksums.erase(checksums.begin() + 4);
  std::sort(checksums.begin(), checksums.end());
  EXPECT_EQ(std::adjacent_find(checksums.begin(), checksums.end()), checksums.end());
}
