// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file TextLines.h
 * @brief Reads lines and numbers from the text of untrusted files, and shortens text for messages.
 */
#ifndef AvianLidarTextLines_h
#define AvianLidarTextLines_h

#include "ByteSource.h"
#include "FileError.h"

#include <charconv>
#include <optional>
#include <string>
#include <string_view>

namespace avianlidar
{
/// Returns the first 40 characters of a word or line of the file, for a message.
std::string shown(const std::string& text);

/// Lines of a source.
class TextLines
{
public:
  TextLines(ByteSource& source, std::uint64_t begin)
    : Source(source)
    , Next(begin)
  {
  }

  /// Reads the next line, without its end and without a byte-order mark. Returns false after the
  /// last line. Throws FileError for a line of more than 16 MiB.
  bool get(std::string& line);

  /// Returns the offset of the next line in the source, bytes.
  std::uint64_t position() const { return this->Next; }

private:
  ByteSource& Source;
  std::uint64_t Next;
};

/// Converts a word to a number, in the C locale. Returns no number if the word is not a number.
template <class T>
std::optional<T> parsed(std::string_view word)
{
  word.remove_prefix(word.size() > 1 && word[0] == '+' && word[1] != '-');
  T value{};
  const auto [stop, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
  return problem == std::errc() && stop == word.data() + word.size() ? std::optional<T>(value)
                                                                     : std::nullopt;
}

/// The same for a number that must be there. Throws FileError, which names the key, if the word is
/// not a number.
template <class T>
T numberOf(const std::string& word, const char* key)
{
  const std::optional<T> value = parsed<T>(word);
  failIf(!value, key, " has \"", shown(word), "\", expected a number");
  return *value;
}

}

#endif
