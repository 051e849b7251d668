// SPDX-License-Identifier: BSD-3-Clause
#include "ShownNames.h"

namespace avianlidar::scene
{
std::string ShownName(const std::string& name)
{
  constexpr std::size_t longest = 80;
  constexpr const char* digits = "0123456789abcdef";
  std::size_t end = name.size();
  if (end > longest)
  {
    // A character of UTF-8 goes on with bytes 10xxxxxx.
    for (end = longest; end > 0 && (name[end] & 0xC0) == 0x80; --end)
    {
    }
  }
  std::string shown;
  for (std::size_t i = 0; i < end; ++i)
  {
    const auto byte = static_cast<unsigned char>(name[i]);
    shown += byte < 0x20 || byte == 0x7F
      ? std::string("\\x") + digits[byte >> 4] + digits[byte & 15]
      : std::string(1, name[i]);
  }
  return shown + (end < name.size() ? "..." : "");
}
}
