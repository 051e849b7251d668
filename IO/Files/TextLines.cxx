// SPDX-License-Identifier: BSD-3-Clause
#include "TextLines.h"

#include <algorithm>

namespace avianlidar
{
std::string shown(const std::string& text)
{
  constexpr std::size_t longest = 40;
  std::string start = text.substr(0, longest);
  std::replace_if(
    start.begin(), start.end(), [](unsigned char c) { return c < ' ' || c > '~'; }, '?');
  return start;
}

bool TextLines::get(std::string& line)
{
  constexpr std::uint64_t longest = 1 << 24, block = 1 << 16;
  const std::uint64_t first = this->Next, size = this->Source.size();
  line.clear();
  for (bool ends = false; !ends && this->Next < size;)
  {
    const std::uint64_t count = std::min(block, size - this->Next);
    const unsigned char* const begin = this->Source.at(this->Next, count);
    const unsigned char* const end = std::find(begin, begin + count, '\n');
    line.append(reinterpret_cast<const char*>(begin), end - begin);
    failIf(line.size() > longest, "a line is longer than 16 MiB");
    ends = end < begin + count;
    this->Next += static_cast<std::uint64_t>(end - begin) + ends;
  }
  if (first == 0 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) // byte-order mark
  {
    line.erase(0, 3);
  }
  if (!line.empty() && line.back() == '\r')
  {
    line.pop_back();
  }
  return first < size;
}
}
