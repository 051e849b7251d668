// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Hash.h
 * @brief Checksums of bytes: XXH3, 64 bits (Y. Collet), the same on every machine of one byte
 * order.
 *
 * Fast enough to be worked out for every run, and no protection against bytes made to collide.
 */
#ifndef avianlidar_Hash_h
#define avianlidar_Hash_h

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// @param seed the hash of what comes before, if that belongs to it
std::uint64_t hashOf(const void* data, std::size_t bytes, std::uint64_t seed);
}

#endif
