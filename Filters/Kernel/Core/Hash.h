// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Hash.h
 * @brief Checksums of bytes, 64 bits, fast enough to be computed at every run.
 *
 * Source: XXH3 (Y. Collet, library xxHash).
 * Valid: equal on all machines of the same byte order. The hash does not protect against bytes made
 * to collide.
 * Test: TestTriangleMesh.cxx.
 */
#ifndef avianlidar_Hash_h
#define avianlidar_Hash_h

#include <cstddef>
#include <cstdint>

namespace avianlidar
{
/// Hash of some bytes. @param seed hash of the bytes before them, if both belong together
std::uint64_t hashOf(const void* data, std::size_t bytes, std::uint64_t seed);
}

#endif
