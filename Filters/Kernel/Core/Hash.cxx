// SPDX-License-Identifier: BSD-3-Clause
#include "Hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace avianlidar
{
std::uint64_t hashOf(const void* data, std::size_t bytes, std::uint64_t seed)
{
  return XXH3_64bits_withSeed(data, bytes, seed);
}
}
