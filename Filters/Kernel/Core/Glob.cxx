// SPDX-License-Identifier: BSD-3-Clause
#include "Glob.h"

namespace avianlidar
{
bool globMatches(const std::string& pattern, const std::string& name)
{
  std::size_t p = 0;
  std::size_t n = 0;
  // Where to go on if the text after the last star does not fit: the star takes one character more.
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
