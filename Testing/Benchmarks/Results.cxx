// SPDX-License-Identifier: BSD-3-Clause
#include "Results.h"

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
  return this->brief ? RoundLimits{ 0.8, 3, 5, 0.002 } : RoundLimits{ 5.0, 5, 11, 0.005 };
}

std::size_t Options::mostRays() const
{
  return this->smoke ? 4000 : this->brief ? 400000 : 1600000;
}

bool wanted(const Options& options, const std::string& scene)
{
  if (options.smoke && options.scene.empty())
  {
    return scene == "boxes 500" || scene == "sphere 1e2" || scene == "corridor";
  }
  return options.scene.empty() || options.scene == scene;
}

void say(const std::string& text)
{
  std::cout << text << std::endl;
}
}
