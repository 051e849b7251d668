// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarRequire.h
 * @brief Turns error texts into exceptions, which vtkAvianLidarGuarded() and
 * vtkAvianLidarRanks::Execute() report. Not installed.
 */
#ifndef vtkAvianLidarRequire_h
#define vtkAvianLidarRequire_h

#include <stdexcept>
#include <string>

/// Throw std::runtime_error with the text, and `before` in front of it, unless the text is empty.
inline void vtkAvianLidarRequire(const std::string& problem, const std::string& before = {})
{
  if (!problem.empty())
  {
    throw std::runtime_error(before + problem);
  }
}

/// Call `step`, and put `before` in front of the text of its std::runtime_error, which loses its
/// derived type: callers cannot distinguish FileError and MemoryError from other errors.
template <class Step>
auto vtkAvianLidarWithin(const std::string& before, const Step& step)
try
{
  return step();
}
catch (const std::runtime_error& error)
{
  throw std::runtime_error(before + error.what());
}

#endif
