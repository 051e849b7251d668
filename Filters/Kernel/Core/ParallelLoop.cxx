// SPDX-License-Identifier: BSD-3-Clause
#include "ParallelLoop.h"

#include "AvailableMemory.h"

#include <omp.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

namespace avianlidar
{
namespace
{
/// True in the child of a fork. GNU OpenMP keeps the threads of its last region for the next
/// region. A fork does not copy these threads. A region of the child would wait for them without
/// end.
bool Forked = false;
[[maybe_unused]] const int Noticing = pthread_atfork(nullptr, nullptr, []() { Forked = true; });
}

KeepGoing partOf(const KeepGoing& keepGoing, double from, double to)
{
  if (!keepGoing)
  {
    return {};
  }
  // Rounding must not exceed the value with which the next part begins.
  return [&keepGoing, from, to](double done)
  { return keepGoing(std::min(to, from + (to - from) * done)); };
}

int loopThreads(int threads)
{
  // OpenMP ends the process when a thread cannot be started, or when a thread finds no memory for
  // its first data. A thread needs a stack, an arena of malloc, and as much again for its work. The
  // memory is checked once, because callers have room for so many threads.
  constexpr double bytesOfThread = 160e6;
  static const double room = availableAddresses() / bytesOfThread;
  const double enough = std::max(64, 4 * omp_get_num_procs());
  const int most = static_cast<int>(std::clamp(room, 1.0, enough));
  return std::clamp(threads > 0 ? threads : omp_get_max_threads(), 1, most);
}

bool parallelFor(std::size_t count, std::size_t block, int threads, const LoopBody& body,
  const KeepGoing& keepGoing)
{
  const std::size_t size = std::clamp<std::size_t>(block, 1, std::max<std::size_t>(count, 1));
  std::atomic<std::size_t> next{ 0 };
  std::atomic<std::size_t> done{ 0 };
  std::atomic<bool> stopped{ false };
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&](int thread)
  {
    try
    {
      while (!stopped)
      {
        if (thread == 0 && keepGoing &&
          !keepGoing(static_cast<double>(done.load()) / static_cast<double>(count)))
        {
          stopped = true;
          return;
        }
        const std::size_t begin = next.fetch_add(size);
        if (begin >= count)
        {
          return;
        }
        const std::size_t end = std::min(begin + size, count);
        body(begin, end, thread);
        done += end - begin;
      }
    }
    catch (...)
    {
      const std::lock_guard<std::mutex> lock(mutex);
      error = error ? error : std::current_exception();
      stopped = true;
    }
  };
  const auto wanted = static_cast<std::size_t>(loopThreads(threads));
  const auto team = static_cast<int>(std::min(wanted, (count + size - 1) / size));
  if (!Forked && team > 1)
  {
#pragma omp parallel num_threads(team)
    work(omp_get_thread_num());
  }
  else if (team > 0)
  {
    std::vector<std::thread> others;
    try
    {
      for (int thread = 1; thread < team; ++thread)
      {
        others.emplace_back(work, thread);
      }
    }
    catch (const std::exception&) // without a thread or memory: the threads that run suffice
    {
    }
    work(0);
    for (std::thread& other : others)
    {
      other.join();
    }
  }
  if (error)
  {
    std::rethrow_exception(error);
  }
  return !stopped && (!keepGoing || keepGoing(1.0));
}
}
