// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Memory.h
 * @brief What the process holds, and the most it has held.
 */
#ifndef avianlidar_Memory_h
#define avianlidar_Memory_h

#include <cstddef>

namespace benchmarks
{
/// Bytes handed out by malloc() and not given back.
std::size_t heapBytes();

/// Forget the most that was resident so far.
void resetPeak();

/// The most that was resident since, bytes; 0 where the system does not tell.
std::size_t peakBytes();

/// What is resident now, bytes.
std::size_t residentBytes();
}

#endif
