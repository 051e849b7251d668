// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Figures.h
 * @brief Writes numbers for sentences: significant digits, in all locales the same.
 *
 * Source: none.
 * Valid: numbers from 1 to 1e15 have no exponent: 12,000 with two digits is "12000".
 * Test: TestAvailableMemory.cxx.
 */
#ifndef avianlidar_Figures_h
#define avianlidar_Figures_h

#include <charconv>
#include <cmath>
#include <string>

namespace avianlidar
{
/// Returns a number with up to `digits` significant digits, and without an exponent from 1 to 1e15.
inline std::string figures(double value, int digits)
{
  char text[64];
  const auto write = [&text](double number, std::chars_format format, int precision)
  {
    return std::string(
      text, std::to_chars(text, text + sizeof text, number, format, precision).ptr);
  };
  const std::string usual = write(value, std::chars_format::general, digits);
  double rounded = 0.0;
  std::from_chars(usual.data(), usual.data() + usual.size(), rounded);
  const bool isLarge = std::fabs(rounded) >= 1.0 && std::fabs(rounded) < 1e15;
  return isLarge && usual.find('e') != usual.npos ? write(rounded, std::chars_format::fixed, 0)
                                                  : usual;
}
}

#endif
