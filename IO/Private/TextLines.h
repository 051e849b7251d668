// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TextLines.h
 * @brief Reads lines and numbers from the text of untrusted files, and shortens text for messages.
 */
#ifndef AvianLidarTextLines_h
#define AvianLidarTextLines_h

#include "ByteSource.h"
#include "CloudData.h"

#include <charconv>
#include <string>

namespace avianlidar::formats
{
/// The first characters of a word or a line of the file, for a message.
std::string shown(const std::string& text);

/// Lines of a source, read block by block.
class TextLines
{
public:
  TextLines(ByteSource& source, std::uint64_t begin)
    : Source(source)
    , Next(begin)
  {
  }

  /// The next line without its end, the first one without a byte-order mark; false behind the last.
  /// A line of more than 16 MiB is a FormatError.
  bool get(std::string& line);

  /// Where the next line begins.
  std::uint64_t position() const { return this->Next - (this->Block.size() - this->At); }

private:
  bool fill();

  ByteSource& Source;
  std::uint64_t Next;
  std::vector<unsigned char> Block;
  std::size_t At = 0;
};

/// The number that a word is, in the C locale; otherwise a FormatError that names the key.
template <class T>
T numberOf(const std::string& word, const char* key)
{
  T value{};
  const char* end = word.data() + word.size();
  const bool hasPlus = word.size() > 1 && word[0] == '+' && word[1] != '-';
  const auto [stop, problem] = std::from_chars(word.data() + hasPlus, end, value);
  if (problem != std::errc() || stop != end)
  {
    throw FormatError(std::string(key) + " has \"" + shown(word) + "\", expected a number");
  }
  return value;
}

}

#endif
