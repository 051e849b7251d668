// SPDX-License-Identifier: BSD-3-Clause
#include "Memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace benchmarks
{
namespace
{
std::size_t statusBytes(const std::string& key)
{
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
  {
    if (word == key)
    {
      std::size_t kibibytes = 0;
      status >> kibibytes;
      return 1024 * kibibytes;
    }
  }
  return 0;
}
}

std::size_t heapBytes()
{
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

void resetPeak()
{
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}

std::size_t peakBytes()
{
  return statusBytes("VmHWM:");
}

std::size_t residentBytes()
{
  malloc_trim(0);
  return statusBytes("VmRSS:");
}
}
