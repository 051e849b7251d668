// SPDX-License-Identifier: BSD-3-Clause
#include "Suites.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <iostream>
#include <numeric>
#include <random>
#include <set>
#include <stdexcept>

namespace benchmarks
{
RoundLimits Options::limits() const
{
  if (this->smoke)
  {
    return { 0.01, 1, 1, 0.0 };
  }
  return this->brief ? RoundLimits{ 0.8, 3, 5, 0.002 } : RoundLimits{ 2.5, 5, 21, 0.005 };
}

std::size_t Options::mostRays() const
{
  return this->smoke ? 4000 : this->brief ? 400000 : 1600000;
}

Table::Table(const Options& options, const std::string& name, const std::string& header)
  : File(options.folder + "/" + name + ".csv")
{
  if (!this->File)
  {
    throw std::runtime_error("cannot write " + name + ".csv into " + options.folder);
  }
  this->File << header << std::endl;
}

double medianOf(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
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
  std::vector<std::vector<double>> turns(contenders.size());
  std::vector<std::size_t> order(contenders.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::mt19937 random(1);
  for (int i = 0; i < rounds; ++i)
  {
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t k : order)
    {
      const auto turn = [&]()
      {
        for (int n = 0; n < runs[k]; ++n)
        {
          contenders[k].run();
        }
      };
      turns[k].push_back(
        (limits.processorTime ? processorSecondsOf(turn) : secondsOf(turn)) / runs[k]);
    }
  }
  std::vector<Timing> timings;
  for (std::size_t k = 0; k < contenders.size(); ++k)
  {
    timings.push_back({ contenders[k].name, medianOf(turns[k]),
      *std::min_element(turns[k].begin(), turns[k].end()), turns[k] });
  }
  return timings;
}

Ratio ratioOf(const Timing& of, const Timing& over)
{
  std::vector<double> ratios;
  for (std::size_t i = 0; i < of.turns.size(); ++i)
  {
    ratios.push_back(of.turns[i] / over.turns[i]);
  }
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  return { medianOf(ratios), *least, *most };
}

bool inSubprocess(const std::function<void()>& work, unsigned seconds)
{
  const pid_t child = fork();
  if (child == 0)
  {
    alarm(seconds); // its default action ends the process
    work();
    _exit(EXIT_SUCCESS);
  }
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

namespace
{
/// Whether the scene is asked for. The short forms leave out some; what takes longest to make is in
/// the short form of the matrix only.
bool wanted(const Options& options, const std::string& scene)
{
  const std::set<std::string> some = options.smoke
    ? std::set<std::string>{ "Hongqiao", "boxes 500", "sphere 1e2", "corridor" }
    : std::set<std::string>{ "Hongqiao", "Hongqiao, everything", "boxes 500", "sphere 1e4" };
  const bool all = !options.smoke && (!options.brief || options.suite == "matrix");
  return all || some.count(scene);
}
}

void forEachScene(const Options& options, const std::vector<SceneEntry>& list,
  const std::function<void(const Scene&, const SceneEntry&)>& measure)
{
  for (const SceneEntry& entry : list)
  {
    if (!wanted(options, entry.name))
    {
      continue;
    }
    const Scene scene = entry.make();
    if (scene.mesh->size() > 0)
    {
      measure(scene, entry);
    }
    else
    {
      say(entry.name + ": left out, its data are not here (AVIANLIDAR_DATA_DIR)");
    }
  }
}

std::vector<SceneEntry> allScenes()
{
  std::vector<SceneEntry> all = airports();
  const std::vector<SceneEntry> generated = generatedScenes();
  all.insert(all.end(), generated.begin(), generated.end());
  return all;
}
}
