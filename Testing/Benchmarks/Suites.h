// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Suites.h
 * @brief The measurements, each a process of its own, and what they share: options, files of
 * results, and rounds in which contenders take turns. A suite returns false if hits disagree.
 */
#ifndef avianlidar_Suites_h
#define avianlidar_Suites_h

#include "Scenes.h"

#include <fstream>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace benchmarks
{
/// How long contenders take turns.
struct RoundLimits
{
  double seconds = 5.0; ///< for all rounds of all contenders, about
  int fewest = 3;
  int most = 15;
  double shortestTurn = 0.004; ///< s; a turn shorter than this is several runs
  bool processorTime = false;  ///< time of the processor, of all threads, instead of real time
};

/// What the command line asked for.
struct Options
{
  std::string suite;
  std::string folder; ///< results go here
  bool brief = false; ///< the short form
  bool smoke = false; ///< seconds: does everything work, no times worth reading

  RoundLimits limits() const;
  /// Rays of a workload, at most.
  std::size_t mostRays() const;
};

/// A file of comma-separated values in the folder of results. Every row is written through at once,
/// so that a stopped run leaves what it has.
class Table
{
public:
  Table(const Options& options, const std::string& name, const std::string& header);

  template <typename... Values>
  void row(const Values&... values)
  {
    std::ostringstream line;
    line.precision(9);
    const char* comma = "";
    ((line << comma << quoted(values), comma = ","), ...);
    this->File << line.str() << std::endl;
  }

private:
  template <typename Value>
  static auto quoted(const Value& value)
  {
    if constexpr (std::is_convertible_v<Value, std::string>)
    {
      const std::string text = value;
      return text.find(',') == std::string::npos ? text : '"' + text + '"';
    }
    else
    {
      return value;
    }
  }

  std::ofstream File;
};

/// Writes a line for the user.
inline void say(const std::string& text)
{
  std::cout << text << std::endl;
}

struct Contender
{
  std::string name;
  std::function<void()> run;
};

struct Timing
{
  std::string name;
  double median = 0.0;       ///< s
  double best = 0.0;         ///< s
  std::vector<double> turns; ///< s, of each round
};

/// Ratios of the times of two contenders in the same round.
struct Ratio
{
  double median;
  double least;
  double most;
};

Ratio ratioOf(const Timing& of, const Timing& over);

/// Everyone runs once to warm up, then in rounds, in random order, so that whatever else the
/// machine does falls on all alike; ratios are those of the medians.
std::vector<Timing> compete(const std::vector<Contender>& contenders, const RoundLimits& limits);

double medianOf(std::vector<double> values);

/// Wall time of one call, s.
double secondsOf(const std::function<void()>& run);

/// Time of the processor for one call, of all threads, s.
double processorSecondsOf(const std::function<void()>& run);

/// Runs `work`, which writes its own results, in a copy of this process while no other thread
/// works.
/// @return whether it came to its end within so many seconds
bool inSubprocess(const std::function<void()>& work, unsigned seconds);

/// Those scenes of the list that are wanted and whose data are here, one after the other.
void forEachScene(const Options& options, const std::vector<SceneEntry>& list,
  const std::function<void(const Scene&, const SceneEntry&)>& measure);

/// Airports and generated scenes.
std::vector<SceneEntry> allScenes();

/// What is measured with: libraries and compiler.
bool suiteMachine(const Options& options);

/// Ours against Embree: every scene, N, half-beamwidth and number of threads.
bool suiteMatrix(const Options& options);

/// VTK's locators and brute force, per ray, on 500 beams.
bool suiteLocators(const Options& options);

/// Building the tree against Embree's builder of medium quality; memory.
bool suiteBuild(const Options& options);

/// Fig. 9: split rules and volumes, tree and detection, every beam by itself.
bool suiteFigure9(const Options& options);

/// Fig. 10: the proposed method against a loop over all facets, and against a descent per ray.
bool suiteFigure10(const Options& options);

/// Fig. 11: the eight combinations of beam constraint, light-energy constraint and batch.
bool suiteFigure11(const Options& options);

/// epsilon of the light-energy constraint: time, and what is lost.
bool suiteEpsilon(const Options& options);

/// Sec. 5.2 and 5.3: the original method, the proposed one, and the defaults of this project, on
/// whole scans.
bool suiteSection5(const Options& options);

/// The stages of the filter, whole updates, lighting known hits again; airports.
bool suiteFilter(const Options& options);

/// Whole scans beside Embree tracing rays and nothing else, one thread; airports.
bool suiteScan(const Options& options);

/// Peak memory of tree and scan; airports.
bool suiteMemory(const Options& options);

/// Birds that move, in a scan whose static hits are known. Outdoor scenes.
bool suiteMovers(const Options& options);
}

#endif
