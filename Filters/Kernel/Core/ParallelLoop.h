// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ParallelLoop.h
 * @brief The only parallel loop of the project: each thread that is free takes a block of a range.
 *
 * All other code is serial code on a range of items. The assignment of blocks to threads is not
 * determined, so the body must write the result of each item only to the slot of this item.
 *
 * Source: none.
 * Valid: any counts, blocks and numbers of threads. Loops also work in the child process of a fork.
 * Test: TestParallelLoop.cxx.
 */
#ifndef avianlidar_ParallelLoop_h
#define avianlidar_ParallelLoop_h

#include <cstddef>
#include <exception>
#include <functional>

namespace avianlidar
{
/// Function that processes items [begin, end) as thread number `thread`, 0 <= thread <
/// loopThreads(threads).
using LoopBody = std::function<void(std::size_t begin, std::size_t end, int thread)>;

/// Function that receives the share of the work that is done, in [0, 1], which never decreases. If
/// the function returns false, the work stops.
using KeepGoing = std::function<bool(double fraction)>;

/// Progress of a part of the work, from one fraction of the whole to another; empty if `keepGoing`
/// is empty. The result refers to `keepGoing`. `keepGoing` must outlive the result.
KeepGoing partOf(const KeepGoing& keepGoing, double from, double to);

/// Exception that a body throws if its result is no longer wanted.
struct WorkStopped : std::exception
{
  const char* what() const noexcept override { return "stopped"; }
};

/**
 * Call `body` for all items [0, count) in blocks of `block` items (0 is taken as 1).
 *
 * Thread 0 is the calling thread. Only this thread calls `keepGoing`, before each block of thread
 * 0, and once at the end with the fraction 1. So `keepGoing` may use data of this thread.
 * `keepGoing` may be empty. If `keepGoing` returns false, running blocks are finished and no
 * further block begins. An exception of `body` or `keepGoing` stops the work in the same way.
 * parallelFor() throws the first exception again.
 * @param threads requested number of threads, as for loopThreads(); 0: OpenMP's choice
 * @return true if all items were done and keepGoing never returned false
 */
bool parallelFor(std::size_t count, std::size_t block, int threads, const LoopBody& body,
  const KeepGoing& keepGoing = {});

/// Largest number of threads of a loop: at most 64 or four per processor, whichever is larger, and
/// less if address space is scarce.
/// @param threads requested number of threads; 0 or less: OpenMP's choice (OMP_NUM_THREADS)
int loopThreads(int threads);
}

#endif
