// SPDX-License-Identifier: BSD-3-Clause
#include "ParallelLoop.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>

namespace avianlidar
{
namespace
{
/// What the threads of one loop share.
class Loop
{
public:
  Loop(std::size_t count, std::size_t block, const LoopBody& body, const KeepGoing& keepGoing)
    : Count(count)
    , Block(block)
    , Body(body)
    , Continue(keepGoing)
  {
  }

  /// The work of one thread. Throws nothing: an exception must not leave a parallel region.
  void run(int thread)
  {
    try
    {
      while (!this->Stopped && this->proceed(thread) && this->step(thread))
      {
      }
    }
    catch (...)
    {
      const std::lock_guard<std::mutex> lock(this->Mutex);
      if (!this->Error)
      {
        this->Error = std::current_exception();
      }
      this->Stopped = true;
    }
  }

  /// After all threads: throw what was caught, or say whether the work is done and wanted.
  bool finish()
  {
    if (this->Error)
    {
      std::rethrow_exception(this->Error);
    }
    return !this->Stopped && (!this->Continue || this->Continue(1.0));
  }

private:
  bool proceed(int thread)
  {
    if (thread != 0 || !this->Continue)
    {
      return true;
    }
    const double done = static_cast<double>(this->Done.load());
    if (!this->Continue(done / static_cast<double>(this->Count)))
    {
      this->Stopped = true;
    }
    return !this->Stopped;
  }

  bool step(int thread)
  {
    const std::size_t begin = this->NextBlock.fetch_add(1) * this->Block;
    if (begin >= this->Count)
    {
      return false;
    }
    const std::size_t size = std::min(this->Block, this->Count - begin);
    this->Body(begin, begin + size, thread);
    this->Done += size;
    return true;
  }

  const std::size_t Count;
  const std::size_t Block;
  const LoopBody& Body;
  const KeepGoing& Continue;
  std::atomic<std::size_t> NextBlock{ 0 };
  std::atomic<std::size_t> Done{ 0 };
  std::atomic<bool> Stopped{ false };
  std::mutex Mutex;
  std::exception_ptr Error;
};
}

int loopThreads(int threads)
{
  // More threads than that only cost memory, and OpenMP ends the process when it cannot have them.
  const int most = std::max(64, 4 * omp_get_num_procs());
  return std::min(most, threads > 0 ? threads : std::max(1, omp_get_max_threads()));
}

bool parallelFor(std::size_t count, std::size_t block, int threads, const LoopBody& body,
  const KeepGoing& keepGoing)
{
  const std::size_t size = std::clamp<std::size_t>(block, 1, std::max<std::size_t>(count, 1));
  const std::size_t blocks = count / size + (count % size != 0 ? 1 : 0);
  const std::size_t wanted = static_cast<std::size_t>(loopThreads(threads));
  const int team = static_cast<int>(std::clamp<std::size_t>(blocks, 1, wanted));
  Loop loop(count, size, body, keepGoing);
  if (count > 0)
  {
#pragma omp parallel num_threads(team)
    loop.run(omp_get_thread_num());
  }
  return loop.finish();
}
}
