// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Hash.h
 * @brief Checksums of bytes, 64 bits, fast enough to be computed at every run.
 *
 * Source: XXH3 (Y. Collet, library xxHash).
 * Valid: equal bytes have equal hashes on all machines of the same byte order. The hash does not
 * protect against bytes that are made to collide.
 * Test: TestTriangleMesh.cxx.
 */
#ifndef avianlidar_Hash_h
#define avianlidar_Hash_h

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// Hash of some bytes. @param seed hash of the preceding bytes, if a hash of all bytes is wanted
std::uint64_t hashOf(const void* data, std::size_t bytes, std::uint64_t seed);
}

#endif
