// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Memory.h
 * @brief What the process holds, and the most it has held.
 */
#ifndef avianlidar_Memory_h
#define avianlidar_Memory_h

#include <malloc.h>

#include <cstddef>
#include <fstream>
#include <string>

namespace benchmarks
{
/// A number of /proc/self/status, bytes; 0 where the system does not give it.
inline std::size_t statusBytes(const std::string& key)
{
  std::ifstream status("/proc/self/status");
  std::size_t kibibytes = 0;
  for (std::string word; status >> word && word != key;)
  {
  }
  status >> kibibytes;
  return 1024 * kibibytes;
}

/// Bytes handed out by malloc() and not given back.
inline std::size_t heapBytes()
{
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

/// Forget the most that was resident so far.
inline void resetPeak()
{
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

/// The most that was resident since, bytes.
inline std::size_t peakBytes()
{
  return statusBytes("VmHWM:");
}

/// What is resident now, bytes.
inline std::size_t residentBytes()
{
  malloc_trim(0);
  return statusBytes("VmRSS:");
}
}

#endif
