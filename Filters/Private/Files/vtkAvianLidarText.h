// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarText.h
 * @brief Makes text of files and of other programs valid UTF-8, for messages and names. Not
 * installed.
 */
#ifndef vtkAvianLidarText_h
#define vtkAvianLidarText_h

#include <utf8.h>

#include <algorithm>
#include <cstdio>
#include <string>

/// The text as UTF-8: each invalid byte, and NUL, is written as an escape such as \xE4. VTK's
/// Python modules decode messages, and lose a message that is not valid UTF-8.
inline std::string vtkAvianLidarText(const std::string& text)
{
  std::string valid;
  for (auto begin = text.begin(); begin != text.end();)
  {
    const auto bad =
      std::min(utf8::find_invalid(begin, text.end()), std::find(begin, text.end(), '\0'));
    valid.append(begin, bad);
    begin = bad;
    if (bad != text.end())
    {
      char escaped[5];
      std::snprintf(escaped, sizeof(escaped), "\\x%02X", static_cast<unsigned char>(*begin++));
      valid += escaped;
    }
  }
  return valid;
}

#endif
