// SPDX-License-Identifier: BSD-3-Clause
#include "Rounds.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <map>

namespace benchmarks
{
namespace
{
/// Keeps the time of every turn, prints nothing.
class Collector : public benchmark::BenchmarkReporter
{
public:
  explicit Collector(bool processorTime)
    : ProcessorTime(processorTime)
  {
  }

  std::map<std::string, std::vector<double>> turns;

  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override
  {
    for (const Run& run : runs)
    {
      if (run.run_type == Run::RT_Iteration)
      {
        this->turns[run.run_name.function_name].push_back(
          (this->ProcessorTime ? run.cpu_accumulated_time : run.real_accumulated_time) /
          static_cast<double>(run.iterations));
      }
    }
  }

private:
  const bool ProcessorTime;
};
}

double medianOf(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

void initializeRounds(const char* program)
{
  std::vector<std::string> words = { program, "--benchmark_enable_random_interleaving=true" };
  std::vector<char*> arguments;
  for (std::string& word : words)
  {
    arguments.push_back(&word[0]);
  }
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  benchmark::Initialize(&count, arguments.data());
}

double secondsOf(const std::function<void()>& run)
{
  const auto start = std::chrono::steady_clock::now();
  run();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double processorSecondsOf(const std::function<void()>& run)
{
  const std::clock_t start = std::clock();
  run();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

std::vector<Timing> compete(const std::vector<Contender>& contenders, const RoundLimits& limits)
{
  std::vector<int> runs;
  double round = 0.0;
  for (const Contender& c : contenders)
  {
    const double seconds = std::max(secondsOf(c.run), 1e-7);
    runs.push_back(std::max(1, static_cast<int>(std::ceil(limits.shortestTurn / seconds))));
    round += seconds * runs.back();
  }
  const int rounds =
    std::clamp(static_cast<int>(limits.seconds / round), limits.fewest, limits.most);
  benchmark::ClearRegisteredBenchmarks();
  for (std::size_t i = 0; i < contenders.size(); ++i)
  {
    const auto body = [run = contenders[i].run](benchmark::State& state)
    {
      for (auto _ : state)
      {
        run();
        benchmark::ClobberMemory();
      }
    };
    benchmark::RegisterBenchmark(contenders[i].name.c_str(), body)
      ->Iterations(runs[i])
      ->Repetitions(rounds)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
  }
  Collector collector(limits.processorTime);
  benchmark::RunSpecifiedBenchmarks(&collector, "all");
  std::vector<Timing> timings;
  for (const Contender& c : contenders)
  {
    const std::vector<double>& turns = collector.turns.at(c.name);
    timings.push_back(
      { c.name, medianOf(turns), *std::min_element(turns.begin(), turns.end()), turns.size() });
  }
  return timings;
}
}
