// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file UnpackedSize.h
 * @brief Limits for compressed files. A file of 1 MB may hold 1 GB of zeros, which would fill the
 * memory, or keep a reader busy for minutes. Python's read_regular() has the same limits.
 */
#ifndef AvianLidarUnpackedSize_h
#define AvianLidarUnpackedSize_h

#include "FileError.h"

#include <cstdint>

namespace avianlidar
{
constexpr std::uint64_t MostUnpacked = 256u << 20; ///< bytes
constexpr std::uint64_t SmallUnpacked = 16u << 20; ///< bytes up to which any growth is allowed
constexpr std::uint64_t MostGrowth = 100;          ///< of larger files; text grows 5 to 30 times

/// Throws Error if `unpacked` bytes are more than a file of `packed` bytes may hold.
inline void CheckUnpacked(std::uint64_t unpacked, std::uint64_t packed)
{
  failIf(unpacked > MostUnpacked, "holds more than ", MostUnpacked >> 20,
    " MiB once decompressed: decompress it first");
  failIf(unpacked > SmallUnpacked && unpacked / MostGrowth > packed, "its ", packed,
    " bytes hold more than ", MostGrowth,
    " times as many once decompressed, as no mesh or map does: decompress it first");
}
}

#endif
