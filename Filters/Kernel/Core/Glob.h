// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Glob.h
 * @brief Names selected by a pattern with wildcards.
 *
 * Source: none.
 * Valid: any two strings, compared byte by byte. Upper and lower case differ. Time grows at most
 * with the product of the two lengths.
 * Test: TestGlob.cxx.
 */
#ifndef avianlidar_Glob_h
#define avianlidar_Glob_h

#include <cstddef>
#include <string>

namespace avianlidar
{
/// True if the whole of `name` matches `pattern`, in which `*` stands for any text (also an empty
/// text) and `?` for any one character.
inline bool globMatches(const std::string& pattern, const std::string& name)
{
  std::size_t p = 0;
  std::size_t n = 0;
  // Place at which the search resumes after a mismatch: the last star takes one more character.
  std::size_t star = std::string::npos;
  std::size_t taken = 0;
  while (n < name.size())
  {
    if (p < pattern.size() && pattern[p] == '*')
    {
      star = p++;
      taken = n;
    }
    else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n]))
    {
      ++p;
      ++n;
    }
    else if (star != std::string::npos)
    {
      p = star + 1;
      n = ++taken;
    }
    else
    {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*')
  {
    ++p;
  }
  return p == pattern.size();
}
}

#endif
