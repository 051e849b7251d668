// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ParallelLoop.h
 * @brief The only parallel loop of the project: blocks of a range, handed out as threads become
 * free.
 *
 * All other code is serial code on a range of items. Which thread gets which block is not
 * determined, so the body must write each item's result to a slot of that item alone.
 *
 * Source: none.
 * Valid: any counts, blocks and numbers of threads. The child of a fork runs loops as its parent
 * does.
 * Test: TestParallelLoop.cxx.
 */
#ifndef avianlidar_ParallelLoop_h
#define avianlidar_ParallelLoop_h

#include <cstddef>
#include <exception>
#include <functional>

namespace avianlidar
{
/// Work on items [begin, end) as thread number `thread`, 0 <= thread < loopThreads(threads).
using LoopBody = std::function<void(std::size_t begin, std::size_t end, int thread)>;

/// Called with the fraction done, in [0, 1], which never falls; returning false stops the work.
using KeepGoing = std::function<bool(double fraction)>;

/// Progress of a part of the whole work, from one fraction to another; empty as `keepGoing` is.
KeepGoing partOf(const KeepGoing& keepGoing, double from, double to);

/// Thrown by a body whose result is no longer wanted.
struct WorkStopped : std::exception
{
  const char* what() const noexcept override { return "stopped"; }
};

/**
 * Call `body` for all of [0, count) in blocks of `block` items (0 is taken as 1).
 *
 * Thread 0 is the calling thread. Only there, before each of its blocks and once with 1 at the end,
 * `keepGoing` (which may be empty) is called, so it may touch what belongs to that thread. When it
 * returns false no further block begins; blocks under way are finished. An exception of the body or
 * of keepGoing stops the work in the same way and is thrown again here: the first one, if there
 * were several.
 * @param threads > 0, or 0 for loopThreads(0)
 * @return true if all items were done and keepGoing never returned false
 */
bool parallelFor(std::size_t count, std::size_t block, int threads, const LoopBody& body,
  const KeepGoing& keepGoing = {});

/// Threads that a loop asked for `threads` uses at most: `threads`, or OpenMP's choice
/// (OMP_NUM_THREADS) for 0 or less.
int loopThreads(int threads);
}

#endif
