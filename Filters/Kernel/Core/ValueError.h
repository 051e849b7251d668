// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ValueError.h
 * @brief Messages for values that cannot be used, all in one form.
 *
 * Source: none.
 * Valid: numbers, written with 17 significant digits.
 * Test: TestReflectance.cxx, TestScanPattern.cxx, TestScanClock.cxx, TestGeodeticFrame.cxx (the
 * tests BadValuesAreNamed, BadClocksAreNamed).
 */
#ifndef avianlidar_ValueError_h
#define avianlidar_ValueError_h

#include <initializer_list>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace avianlidar
{
/// Least number above 0: lower end of ranges that exclude 0.
constexpr double AboveZero = std::numeric_limits<double>::denorm_min();
/// Largest finite number.
constexpr double LargestFinite = std::numeric_limits<double>::max();

/// Message "name is value, expected what".
template <class T>
std::string valueError(const std::string& name, T value, const std::string& expected)
{
  std::ostringstream text;
  text.precision(17);
  text << name << " is " << value << ", expected " << expected;
  return text.str();
}

/// @return empty if least <= value <= most, else the error of the value (also if it is NaN)
inline std::string rangeError(
  const std::string& name, double value, double least, double most, const std::string& expected)
{
  return value >= least && value <= most ? std::string() : valueError(name, value, expected);
}

/// Error of the first value outside of a range, or an empty text.
template <class Values>
std::string rangeErrorOf(const std::string& name, const Values& values, double least, double most,
  const std::string& expected)
{
  std::string error;
  for (auto value = values.begin(); value != values.end() && error.empty(); ++value)
  {
    error = rangeError(name, *value, least, most, expected);
  }
  return error;
}

/// Empty if `size` equals `count`, else "name has size values, expected one for each of ...".
inline std::string sizeError(
  const std::string& name, std::size_t size, std::size_t count, const std::string& things)
{
  return size == count ? std::string()
                       : name + " has " + std::to_string(size) +
      " values, expected one for each of the " + std::to_string(count) + " " + things;
}

/// List of expected names in words: "a, b or c".
inline std::string anyOf(const std::vector<std::string>& names)
{
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
  {
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  }
  return text;
}

/// First text that is not empty, or an empty text.
inline std::string firstError(std::initializer_list<std::string> errors)
{
  for (const std::string& error : errors)
  {
    if (!error.empty())
    {
      return error;
    }
  }
  return {};
}
}

#endif
