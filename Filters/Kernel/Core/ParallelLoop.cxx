// SPDX-License-Identifier: BSD-3-Clause
#include "ParallelLoop.h"

#include "AvailableMemory.h"

#include <omp.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace avianlidar
{
namespace
{
bool Forked = false; ///< this process is the child of a fork
[[maybe_unused]] const int Noticing = pthread_atfork(nullptr, nullptr, []() { Forked = true; });

/// Call `work`, which throws nothing, on `threads` threads, or on fewer where there are no more.
/// Thread 0 is the calling one.
void onThreads(int threads, const std::function<void(int thread)>& work)
{
  if (!Forked)
  {
#pragma omp parallel num_threads(threads)
    work(omp_get_thread_num());
    return;
  }
  // GNU OpenMP keeps the threads of its last region for the next one. A fork does not copy them,
  // and a region of the child would wait for them without end.
  std::vector<std::thread> others;
  try
  {
    others.reserve(static_cast<std::size_t>(threads));
    for (int thread = 1; thread < threads; ++thread)
    {
      others.emplace_back(std::cref(work), thread);
    }
  }
  catch (const std::exception&) // no more threads, or no memory for them
  {
  }
  work(0);
  for (std::thread& other : others)
  {
    other.join();
  }
}

/// Bytes: a stack, an arena of malloc, and as much again for the work.
constexpr double AddressesPerThread = 160e6;

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
  // More threads than that only cost memory, and OpenMP ends the process when it cannot have them,
  // as under an address limit. Looked at once: callers have room for so many threads.
  static const double room = availableAddresses() / AddressesPerThread;
  const int enough = std::max(64, 4 * omp_get_num_procs());
  const int most = static_cast<int>(std::clamp(room, 1.0, static_cast<double>(enough)));
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
    onThreads(team, [&](int thread) { loop.run(thread); });
  }
  return loop.finish();
}

/// The loop at hand and who works on it.
struct ParallelTeam::Shared
{
  std::atomic<Loop*> current{ nullptr };
  std::atomic<std::size_t> begun{ 0 }; ///< loops so far
  std::atomic<bool> over{ false };     ///< no more loops will come
  std::atomic<int> inside{ 0 };        ///< helpers that may be using `current`
  std::mutex mutex;
  std::condition_variable news;
  int asleep = 0;

  /// Work on loops until there are no more.
  void help(int thread)
  {
    std::size_t seen = 0;
    while (this->waitForNews(seen))
    {
      // The caller ends a loop only when nobody is inside after `current` was taken away.
      ++this->inside;
      if (Loop* loop = this->current)
      {
        loop->run(thread);
      }
      --this->inside;
    }
  }

  void tell()
  {
    const std::lock_guard<std::mutex> lock(this->mutex);
    if (this->asleep > 0)
    {
      this->news.notify_all();
    }
  }

private:
  bool hasNews(std::size_t seen) const { return this->over || this->begun != seen; }

  /// False if no more loops will come. Loops often follow at once, so sleep comes late.
  bool waitForNews(std::size_t& seen)
  {
    constexpr int Patience = 200;
    for (int i = 0; i < Patience && !this->hasNews(seen); ++i)
    {
      std::this_thread::yield();
    }
    if (!this->hasNews(seen))
    {
      std::unique_lock<std::mutex> lock(this->mutex);
      ++this->asleep;
      this->news.wait(lock, [&]() { return this->hasNews(seen); });
      --this->asleep;
    }
    seen = this->begun;
    return !this->over;
  }
};

void ParallelTeam::run(int threads, const std::function<void(ParallelTeam&)>& work)
{
  const int size = loopThreads(threads);
  Shared shared;
  ParallelTeam team(size, shared);
  if (size == 1)
  {
    work(team);
    return;
  }
  std::exception_ptr error;
  onThreads(size,
    [&](int thread)
    {
      if (thread > 0)
      {
        shared.help(thread);
        return;
      }
      try
      {
        work(team);
      }
      catch (...)
      {
        error = std::current_exception();
      }
      shared.over = true;
      shared.tell();
    });
  if (error)
  {
    std::rethrow_exception(error);
  }
}

bool ParallelTeam::loop(
  std::size_t count, std::size_t block, const LoopBody& body, const KeepGoing& keepGoing)
{
  Loop loop(
    count, std::clamp<std::size_t>(block, 1, std::max<std::size_t>(count, 1)), body, keepGoing);
  const bool shares = this->Threads > 1 && count > block;
  if (shares)
  {
    this->Common.current = &loop;
    ++this->Common.begun;
    this->Common.tell();
  }
  if (count > 0)
  {
    loop.run(0);
  }
  if (shares)
  {
    this->Common.current = nullptr;
    while (this->Common.inside != 0)
    {
      std::this_thread::yield();
    }
  }
  return loop.finish();
}
}
