// SPDX-License-Identifier: BSD-3-Clause
#include "LengthText.h"

#include <utf8.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <limits>
#include <locale>
#include <regex>
#include <utility>
#include <vector>

namespace avianlidar::scene
{
namespace
{
constexpr double Foot = 0.3048;
constexpr double Storey = 3.0;       // height of a floor, m, as level_height of airport.json
constexpr double Tallest = 1000.0;   // m; a greater number has a decimal comma
constexpr std::size_t Longest = 100; // characters

// Bytes that stand for characters outside ASCII.
constexpr char Prime = '\1', Quote = '\2', PlusMinus = '\3', Dash = '\4', M = '\5', Letter = '\6',
               Metr = '\7';

bool IsSpace(char c)
{
  return c == ' ' || (c >= '\t' && c <= '\r') || (c >= '\x1c' && c <= '\x1f');
}

bool IsDigit(char c)
{
  return c >= '0' && c <= '9';
}

bool IsWord(char c)
{
  return IsDigit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == M ||
    c == Letter || c == Metr;
}

// Returns the byte for a character.
char ToByte(char32_t c)
{
  static const std::pair<char32_t, char> known[] = { { 0xa0, ' ' }, { 0x202f, ' ' }, { 0x85, '\t' },
    { 0x1680, '\t' }, { 0x2028, '\t' }, { 0x2029, '\t' }, { 0x205f, '\t' }, { 0x3000, '\t' },
    { 0x2032, Prime }, { 0x2033, '"' }, { 0x2019, Quote }, { 0x2248, '~' }, { 0xb1, PlusMinus },
    { 0x2013, Dash }, { 0x43c, M }, { 0x41c, M }, { 0x7c73, M } };
  const auto found = std::find_if(
    std::begin(known), std::end(known), [c](const auto& one) { return one.first == c; });
  for (const char32_t zero : { 0x660, 0x6f0, 0x966, 0xff10 }) // Arabic, Persian, Hindi, full width
  {
    if (c >= zero && c < zero + 10)
    {
      return static_cast<char>('0' + (c - zero));
    }
  }
  const bool isControl = c < U' ' && !IsSpace(static_cast<char>(c));
  return found != std::end(known) ? found->second
    : isControl                   ? '\x7f'
    : c < 0x80                    ? static_cast<char>(c)
    : c >= 0x2000 && c <= 0x200a  ? '\t'
                                  : Letter;
}

std::string Trimmed(const std::string& text, bool (*isOutside)(char))
{
  const auto first = std::find_if_not(text.begin(), text.end(), isOutside);
  return { first,
    std::find_if_not(text.rbegin(), std::make_reverse_iterator(first), isOutside).base() };
}

// Returns a text of bytes, trimmed, or an empty text for a text that is too long or not UTF-8.
std::string ToBytes(const std::string& text)
{
  std::u32string characters;
  if (text.size() > 4 * Longest || !utf8::is_valid(text.begin(), text.end()))
  {
    return {};
  }
  utf8::utf8to32(text.begin(), text.end(), std::back_inserter(characters));
  static const std::u32string metre[] = { U"\x43c\x435\x442\x440", U"\x41c\x415\x422\x420" };
  std::string bytes;
  for (std::size_t i = 0; i < characters.size(); ++i)
  {
    std::size_t same = 0;
    while (same < 4 && i + same < characters.size() &&
      (characters[i + same] == metre[0][same] || characters[i + same] == metre[1][same]))
    {
      ++same;
    }
    bytes += same == 4 ? Metr : ToByte(characters[i]);
    i += same == 4 ? 3 : 0;
  }
  // The time of the expressions grows with a high power of the number of blanks in a row.
  bytes.erase(std::unique(bytes.begin(), bytes.end(),
                [](char a, char b) { return IsSpace(a) && IsSpace(b); }),
    bytes.end());
  bytes = Trimmed(Trimmed(Trimmed(bytes, IsSpace), [](char c) { return c == ';'; }), IsSpace);
  return bytes.size() > Longest ? std::string() : bytes;
}

// Returns the parts of "2;3", "2/3", "2..3" and "2 - 3".
std::vector<std::string> Parts(const std::string& text)
{
  std::vector<std::string> parts(1);
  for (std::size_t i = 0; i < text.size(); ++i)
  {
    const auto at = [&text](std::size_t k) { return k < text.size() ? text[k] : '\0'; };
    const auto skip = [&](std::size_t k)
    {
      while (IsSpace(at(k)))
      {
        ++k;
      }
      return k;
    };
    const char c = text[i];
    std::size_t end = i; // after the separator
    if ((c == ';' || c == '/') && at(i + 1) != '-')
    {
      end = i + 1;
    }
    else if (c == '.' && at(i + 1) == '.')
    {
      end = i + 2;
    }
    else if (i > 0 && (IsWord(text[i - 1]) || text[i - 1] == '.'))
    {
      const std::size_t dash = skip(i);
      const std::size_t digit = skip(dash + 1);
      end = (at(dash) == '-' || at(dash) == Dash) && IsDigit(at(digit)) ? digit : i;
    }
    if (end == i)
    {
      parts.back() += c;
      continue;
    }
    parts.emplace_back();
    i = end - 1;
  }
  for (std::string& part : parts)
  {
    part = Trimmed(part, IsSpace);
  }
  return parts;
}

double ToNumber(const std::string& text)
{
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

// Returns the number in "1,200.5", "1 200" or "12,5". A comma in a number above `most` is a decimal
// mark.
double NumberOf(const std::string& text, double most)
{
  static const std::regex thousands("\\d{1,3}(?:[, '\2]\\d{3})+(?:\\.\\d+)?");
  std::string plain;
  const bool areThousands = std::regex_match(text, thousands);
  for (const char c : text)
  {
    const bool isSeparator = areThousands && (c == ',' || c == ' ' || c == '\'' || c == Quote);
    plain += isSeparator ? "" : std::string(1, c == ',' ? '.' : c);
  }
  const double value = ToNumber(plain);
  const std::size_t comma = text.find(',');
  if (value <= most || comma == std::string::npos || text.find('.') != std::string::npos)
  {
    return value;
  }
  plain = text;
  plain[comma] = '.';
  plain.erase(std::remove(plain.begin(), plain.end(), ','), plain.end());
  return ToNumber(plain);
}

std::regex Expression(const std::string& text)
{
  std::regex expression;
  expression.imbue(std::locale::classic());
  expression.assign(text, std::regex::icase);
  return expression;
}

const std::regex& LengthExpression()
{
  static const std::string number = "\\d{1,3}(?:[, '\2]\\d{3})+(?:\\.\\d+)?|\\d+(?:[.,]\\d+)?";
  static const std::string word = "[\\w\5\6\7]";
  static const std::string unit = "mm|cm|km|millimet" + word + "+|centimet" + word + "+|kilomet" +
    word + "+|met(?:er|re)s?|mtrs?|mts?|m|\5|\7" + word +
    "*|ft|foot|feet|['\1]|yd|yards?|stor[ei]" + word + "*|floors?|levels?";
  static const std::regex expression = Expression("(?:~|<|>|\\+|c\\.|ca\\.?|circa|approx\\.?|about|"
                                                  "max\\.?|up to)?\\s*(" +
    number + ")\\s*(?:(?:\3|\\+/?-)\\s*(?:" + number + ")|\\+)?\\s*(" + unit +
    ")?\\.?\\s*-?\\s*(?:(" + number +
    ")\\s*(?:\"|''|in|inch|inches)\\.?)?\\s*"
    "(?:\\(.*\\)|a\\.?g\\.?l\\.?|above ground" +
    word + "*(?: level)?|high|tall|hoch)?");
  return expression;
}

// Returns the length of a unit, m. @param given length without a unit
double UnitOf(const std::string& name, double given)
{
  static const std::pair<const char*, double> units[] = { { "mm", 1e-3 }, { "mil", 1e-3 },
    { "c", 1e-2 }, { "k", 1e3 }, { "fl", Storey }, { "f", Foot }, { "'", Foot }, { "\1", Foot },
    { "y", 0.9144 }, { "s", Storey }, { "l", Storey } };
  const auto found = std::find_if(std::begin(units), std::end(units),
    [&name](const auto& one) { return name.rfind(one.first, 0) == 0; });
  return name.empty() ? given : found != std::end(units) ? found->second : 1.0;
}

std::optional<double> OneLength(const std::string& text, double given)
{
  static const std::regex metresAndCentimetres = Expression("(\\d+)\\s*m\\s*(\\d{1,2})\\s*cm");
  static const std::regex exponent = Expression("\\d+(?:\\.\\d+)?e\\d");
  std::smatch found;
  if (std::regex_match(text, found, metresAndCentimetres))
  {
    return ToNumber(found[1]) + 0.01 * ToNumber(found[2]);
  }
  if (std::regex_match(text, exponent))
  {
    return given * ToNumber(text);
  }
  if (!std::regex_match(text, found, LengthExpression()))
  {
    return {};
  }
  std::string name = found[2];
  std::transform(name.begin(), name.end(), name.begin(),
    [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 'a' - 'A') : c; });
  const bool hasInches = found[3].matched;
  if (hasInches && (name.empty() || (name[0] != 'f' && name[0] != '\'' && name[0] != Prime)))
  {
    return {};
  }
  const double unit = UnitOf(name, given);
  const bool areStoreys = !name.empty() && unit == Storey;
  const double most = areStoreys ? std::numeric_limits<double>::infinity() : Tallest / unit;
  return unit *
    (NumberOf(found[1], most) +
      (hasInches && !areStoreys ? NumberOf(found[3], std::numeric_limits<double>::infinity()) / 12.0
                                : 0.0));
}
}

std::optional<double> ReadLength(const std::string& text, double unit, double most)
{
  double greatest = 0.0;
  for (const std::string& part : Parts(ToBytes(text)))
  {
    const std::optional<double> length = OneLength(part, unit);
    if (!length)
    {
      return {};
    }
    greatest = std::max(greatest, *length);
  }
  return greatest > 0.0 && greatest <= most ? std::optional<double>(greatest) : std::nullopt;
}
}
