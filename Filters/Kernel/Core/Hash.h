// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Hash.h
 * @brief Checksums of bytes, 64 bits, fast enough to be computed at every run.
 *
 * Source: XXH3 (Y. Collet, library xxHash).
 * Valid: the same on every machine of one byte order. No protection against bytes made to collide.
 * Test: TestTriangleMesh.cxx.
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
