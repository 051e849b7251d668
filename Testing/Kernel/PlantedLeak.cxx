// SPDX-License-Identifier: BSD-3-Clause
// A leak on purpose, in the parallel loop of the kernel: LeakSanitizer must report it, though it is
// told to be silent about the OpenMP runtime.
#include "ParallelLoop.h"

#include <atomic>
#include <cstdio>

int main()
{
  std::atomic<long> sum{ 0 };
  avianlidar::parallelFor(40, 1, 4,
    [&sum](std::size_t begin, std::size_t, int)
    {
      volatile auto* lost = new long(static_cast<long>(begin));
      sum += *lost;
      lost = nullptr;
    });
  std::printf("%ld\n", sum.load());
  return 0;
}
