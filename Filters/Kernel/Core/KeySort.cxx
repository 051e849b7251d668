// SPDX-License-Identifier: BSD-3-Clause
#include "KeySort.h"

#include <hwy/contrib/sort/vqsort.h>

#include <algorithm>

namespace avianlidar
{
namespace
{
/// Least number of keys for which SIMD lanes sort faster.
constexpr std::size_t FewKeys = 64;
}

void sortKeys(std::vector<std::uint64_t>& keys)
{
  if (keys.size() < FewKeys)
  {
    std::sort(keys.begin(), keys.end());
    return;
  }
  hwy::Sorter()(keys.data(), keys.size(), hwy::SortAscending());
}

void sortKeys(std::vector<LongKey>& keys)
{
  static_assert(sizeof(LongKey) == sizeof(hwy::uint128_t), "both hold the low half first");
  hwy::Sorter()(reinterpret_cast<hwy::uint128_t*>(keys.data()), keys.size(), hwy::SortAscending());
}
}
