// SPDX-License-Identifier: BSD-3-Clause
#include "TextLines.h"

#include <algorithm>

namespace avianlidar::formats
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
  constexpr std::size_t longest = 1 << 24;
  const bool isFirst = this->Next == 0;
  line.clear();
  bool any = false;
  while (this->fill())
  {
    any = true;
    const auto from = this->Block.begin() + static_cast<std::ptrdiff_t>(this->At);
    const auto end = std::find(from, this->Block.end(), '\n');
    line.append(from, end);
    this->At += static_cast<std::size_t>(end - from);
    failIf(line.size() > longest, "a line is longer than 16 MiB");
    if (end != this->Block.end())
    {
      ++this->At;
      break;
    }
  }
  if (isFirst && line.compare(0, 3, "\xEF\xBB\xBF") == 0) // byte-order mark
  {
    line.erase(0, 3);
  }
  if (!line.empty() && line.back() == '\r')
  {
    line.pop_back();
  }
  return any;
}

bool TextLines::fill()
{
  if (this->At < this->Block.size())
  {
    return true;
  }
  constexpr std::uint64_t blockSize = 1 << 16;
  const std::uint64_t left = this->Source.size() - this->Next;
  this->Block = this->Source.bytes(this->Next, std::min(blockSize, left));
  this->Next += this->Block.size();
  this->At = 0;
  return !this->Block.empty();
}
}
