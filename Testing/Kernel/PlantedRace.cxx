// SPDX-License-Identifier: BSD-3-Clause
// A race on purpose, in the parallel loop of the kernel: ThreadSanitizer must report it, or its
// silence elsewhere would say nothing.
#include "ParallelLoop.h"

#include <chrono>
#include <cstdio>
#include <thread>

int main()
{
  long sum = 0;
  avianlidar::parallelFor(40, 1, 4,
    [&sum](std::size_t begin, std::size_t end, int)
    {
      // Time for the other threads to take a block, too.
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      sum += static_cast<long>(end - begin);
    });
  std::printf("%ld\n", sum);
  return 0;
}
