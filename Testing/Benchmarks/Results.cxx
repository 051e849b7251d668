// SPDX-License-Identifier: BSD-3-Clause
#include "Results.h"

#include <algorithm>
#include <initializer_list>
#include <iostream>
#include <stdexcept>

namespace benchmarks
{
Table::Table(const std::string& file, const std::string& header)
  : File(file)
{
  if (!this->File)
  {
    throw std::runtime_error("cannot write " + file);
  }
  this->File << header << std::endl;
}

std::string Table::quoted(const std::string& text)
{
  return text.find(',') == std::string::npos ? text : '"' + text + '"';
}

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

bool wanted(const Options& options, const std::string& scene)
{
  if (!options.scene.empty())
  {
    return options.scene == scene;
  }
  const auto among = [&](std::initializer_list<const char*> names)
  { return std::find(names.begin(), names.end(), scene) != names.end(); };
  if (options.smoke)
  {
    return among({ "Hongqiao", "boxes 500", "sphere 1e2", "corridor" });
  }
  // What takes longest to make is in the short form of the matrix only.
  return !options.brief || options.suite == "matrix" ||
    among({ "Hongqiao", "Hongqiao, everything", "boxes 500", "sphere 1e4" });
}

void say(const std::string& text)
{
  std::cout << text << std::endl;
}
}
