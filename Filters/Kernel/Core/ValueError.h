// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ValueError.h
 * @brief The one form of message for a value that cannot be used.
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

namespace avianlidar
{
/// The least number above 0, for ranges without their lower end.
constexpr double AboveZero = std::numeric_limits<double>::denorm_min();
/// The largest finite number.
constexpr double LargestFinite = std::numeric_limits<double>::max();

/// "name is value, expected what"
template <class T>
std::string valueError(const std::string& name, T value, const std::string& expected)
{
  std::ostringstream text;
  text.precision(17);
  text << name << " is " << value << ", expected " << expected;
  return text.str();
}

/// The error of a value outside a range, which holds both of its ends, or that is not a number;
/// else empty.
inline std::string rangeError(
  const std::string& name, double value, double least, double most, const std::string& expected)
{
  return value >= least && value <= most ? std::string() : valueError(name, value, expected);
}

/// The same of the first bad one of many values.
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

/// Empty if there is one value for each of so many things, else "name has size values, ..."
inline std::string sizeError(
  const std::string& name, std::size_t size, std::size_t count, const std::string& things)
{
  return size == count ? std::string()
                       : name + " has " + std::to_string(size) +
      " values, expected one for each of the " + std::to_string(count) + " " + things;
}

/// The first text that is not empty, or an empty one.
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
