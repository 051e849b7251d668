// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Results.h
 * @brief Comma-separated files, and a suite's view of the run.
 */
#ifndef avianlidar_Results_h
#define avianlidar_Results_h

#include "Rounds.h"

#include <fstream>
#include <sstream>
#include <string>

namespace benchmarks
{
/// One file of results; every row is written through at once, so that a stopped run leaves what it
/// has.
class Table
{
public:
  Table(const std::string& file, const std::string& header);

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
  static std::string quoted(const std::string& text);
  static std::string quoted(const char* text) { return quoted(std::string(text)); }
  template <typename Number>
  static Number quoted(Number number)
  {
    return number;
  }

  std::ofstream File;
};

/// What the command line asked for.
struct Options
{
  std::string suite;
  std::string folder = "."; ///< results go here
  bool brief = false;       ///< the short form
  bool smoke = false;       ///< seconds: does everything work, no times worth reading
  std::string scene;        ///< only this one; empty: all

  RoundLimits limits() const;
  /// Rays of a workload, at most.
  std::size_t mostRays() const;
};

/// Is this scene asked for? The short forms leave out some.
bool wanted(const Options& options, const std::string& scene);

/// Told to the user as it happens.
void say(const std::string& text);
}

#endif
