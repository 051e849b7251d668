// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Rounds.h
 * @brief Contenders take turns in random order, round after round, so that whatever else the
 * machine does falls on all of them alike; ratios are those of the medians.
 *
 * Google Benchmark does the timing (real time unless asked otherwise) and the turns (random
 * interleaving).
 */
#ifndef avianlidar_Rounds_h
#define avianlidar_Rounds_h

#include <functional>
#include <string>
#include <vector>

namespace benchmarks
{
struct Contender
{
  std::string name;
  std::function<void()> run;
};

struct Timing
{
  std::string name;
  double median = 0.0; ///< s
  double best = 0.0;   ///< s
  std::size_t rounds = 0;
};

struct RoundLimits
{
  double seconds = 5.0; ///< for all rounds of all contenders, about
  int fewest = 3;
  int most = 15;
  /// A turn shorter than this is several runs.
  double shortestTurn = 0.004;
  bool processorTime = false; ///< time of the processor, of all threads, instead of real time
};

/// Call once, before compete(): the name of the program and flags of Google Benchmark.
void initializeRounds(const char* program);

/// Everyone runs once to warm up, then in rounds.
std::vector<Timing> compete(const std::vector<Contender>& contenders, const RoundLimits& limits);

double medianOf(std::vector<double> values);

/// Wall time of one call, s.
double secondsOf(const std::function<void()>& run);

/// Time of the processor for one call, of all threads, s.
double processorSecondsOf(const std::function<void()>& run);
}

#endif
