// SPDX-License-Identifier: BSD-3-Clause
// The parallel loop: every item once, progress, stop and exceptions.
#include "ParallelLoop.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace avianlidar;

TEST(ParallelLoop, EveryItemOnceForAnyThreadsAndBlocks)
{
  for (const int threads : { 0, 1, 2, 7 })
  {
    for (const std::size_t block : { 0, 1, 3, 64, 5000 })
    {
      for (const std::size_t count : { 0, 1, 2, 1000 })
      {
        std::vector<int> visits(count, 0);
        std::atomic<int> badThread{ 0 };
        EXPECT_TRUE(parallelFor(count, block, threads,
          [&](std::size_t begin, std::size_t end, int thread)
          {
            badThread += thread < 0 || thread >= loopThreads(threads);
            for (std::size_t i = begin; i < end; ++i)
            {
              ++visits[i];
            }
          }));
        EXPECT_EQ(visits, std::vector<int>(count, 1));
        EXPECT_EQ(badThread, 0);
      }
    }
  }
}

TEST(ParallelLoop, ProgressRisesToOneOnTheCallingThread)
{
  for (const int threads : { 1, 4 })
  {
    const auto caller = std::this_thread::get_id();
    std::vector<double> fractions;
    std::atomic<int> elsewhere{ 0 };
    EXPECT_TRUE(parallelFor(
      500, 10, threads, [](std::size_t, std::size_t, int) {},
      [&](double fraction)
      {
        elsewhere += std::this_thread::get_id() != caller;
        fractions.push_back(fraction);
        return true;
      }));
    EXPECT_EQ(elsewhere, 0);
    ASSERT_FALSE(fractions.empty());
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_GE(fractions.front(), 0.0);
    EXPECT_EQ(fractions.back(), 1.0);
    if (threads == 1)
    {
      EXPECT_EQ(fractions.front(), 0.0);
      EXPECT_EQ(
        fractions.size(), 52u); // before each of 50 blocks, when there is none left, and at the end
    }
  }
}

TEST(ParallelLoop, StopLeavesOnlyBlocksUnderWay)
{
  for (const int threads : { 1, 2, 4 })
  {
    std::atomic<int> blocks{ 0 };
    std::atomic<int> afterStop{ 0 };
    std::atomic<bool> stopped{ false };
    const bool done = parallelFor(
      1000000, 1, threads,
      [&](std::size_t, std::size_t, int)
      {
        ++blocks;
        if (stopped)
        {
          // Time for the stop to be seen, however busy the machine is.
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
          ++afterStop;
        }
      },
      [&](double)
      {
        stopped = blocks >= 20;
        return !stopped;
      });
    EXPECT_FALSE(done);
    EXPECT_GE(blocks, 20);
    // Others may each have begun a block before they could see the stop, and one more while it was
    // set.
    EXPECT_LE(afterStop, 2 * (threads - 1)) << threads;
    if (threads == 1)
    {
      EXPECT_EQ(blocks, 20);
    }
  }
}

TEST(ParallelLoop, StopAtTheVeryBeginningAndEnd)
{
  std::atomic<int> blocks{ 0 };
  const auto count = [&](std::size_t, std::size_t, int) { ++blocks; };
  EXPECT_FALSE(parallelFor(10, 1, 1, count, [](double) { return false; }));
  EXPECT_EQ(blocks, 0);
  EXPECT_FALSE(parallelFor(10, 1, 2, count, [](double fraction) { return fraction < 1.0; }));
}

TEST(ParallelLoop, ExceptionOfTheBodyArrivesOnce)
{
  for (const int threads : { 1, 2, 4 })
  {
    std::atomic<int> blocks{ 0 };
    try
    {
      parallelFor(2000, 1, threads,
        [&](std::size_t begin, std::size_t, int)
        {
          ++blocks;
          if (begin == 5)
          {
            throw std::runtime_error("item 5");
          }
          if (begin > 5)
          {
            // Time for the exception to be seen, however busy the machine is.
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
          }
        });
      FAIL() << "no exception";
    }
    catch (const std::runtime_error& error)
    {
      EXPECT_EQ(std::string(error.what()), "item 5");
    }
    EXPECT_LT(blocks, 2000);
  }
}

TEST(ParallelLoop, ExceptionsOfAllThreadsGiveOne)
{
  EXPECT_THROW(
    parallelFor(100, 1, 4, [](std::size_t, std::size_t, int) { throw std::runtime_error("any"); }),
    std::runtime_error);
}

TEST(ParallelLoop, ExceptionOfTheProgress)
{
  EXPECT_THROW(parallelFor(
                 100, 1, 2, [](std::size_t, std::size_t, int) {},
                 [](double) -> bool { throw std::logic_error("progress"); }),
    std::logic_error);
}

namespace
{
/// The signal that ended a forked child, or its exit code: 0 if `work` gave true.
int resultOfChild(const std::function<bool()>& work)
{
  const pid_t child = fork();
  if (child == 0)
  {
    alarm(60); // a hang is ended, by a signal
    _exit(work() ? 0 : 1);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
}
}

// That a child and its own children have loops is TestFork.py's.
TEST(ParallelLoop, AForkedChildThrowsAndStopsAsItsParentDoes)
{
  EXPECT_TRUE(parallelFor(1000, 1, 4, [](std::size_t, std::size_t, int) {}));
  EXPECT_EQ(resultOfChild(
              []()
              {
                try
                {
                  parallelFor(100, 1, 4,
                    [](std::size_t, std::size_t, int) { throw std::runtime_error("any"); });
                }
                catch (const std::runtime_error&)
                {
                  return !parallelFor(
                    10, 1, 4, [](std::size_t, std::size_t, int) {}, [](double) { return false; });
                }
                return false;
              }),
    0);
}
