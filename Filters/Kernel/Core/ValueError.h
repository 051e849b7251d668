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

#include <sstream>
#include <string>

namespace avianlidar
{
/// "name is value, expected what"
template <class T>
std::string valueError(const char* name, T value, const char* expected)
{
  std::ostringstream text;
  text.precision(17);
  text << name << " is " << value << ", expected " << expected;
  return text.str();
}
}

#endif
