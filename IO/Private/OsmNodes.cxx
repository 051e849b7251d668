// SPDX-License-Identifier: BSD-3-Clause
#include "OsmNodes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

namespace avianlidar::scene
{
namespace
{
constexpr std::string_view NodeStart = "<node", NodeEnd = "</node>", XmlSpaces = " \t\r\n";
constexpr std::size_t LongestId = 40; // characters that a message shows

// Returns where a tag ends, and one past the text if the tag does not end. Values in quotes may
// hold ">".
std::size_t FindEnd(std::string_view text, std::size_t at)
{
  for (char quote = 0; at < text.size(); ++at)
  {
    const char c = text[at];
    if (quote == 0 && c == '>')
    {
      break;
    }
    quote = quote == c ? char(0) : quote == 0 && (c == '"' || c == '\'') ? c : quote;
  }
  return at;
}

// Returns the value of an attribute, or an empty text.
std::string_view ValueOf(std::string_view tag, std::string_view attribute)
{
  for (std::size_t at = 0; (at = tag.find_first_of(XmlSpaces, at)) < tag.size();)
  {
    at = tag.find_first_not_of(XmlSpaces, at);
    const std::size_t equals = tag.find('=', at);
    const std::size_t open = tag.find_first_of("\"'", equals);
    if (open == std::string_view::npos)
    {
      break;
    }
    const std::size_t close = tag.find(tag[open], open + 1);
    const std::string_view name = tag.substr(at, equals - at);
    if (name.substr(0, name.find_first_of(XmlSpaces)) == attribute)
    {
      return close == std::string_view::npos ? std::string_view()
                                             : tag.substr(open + 1, close - open - 1);
    }
    at = close;
  }
  return {};
}

bool IsDegrees(std::string_view text, double largest)
{
  text.remove_prefix(std::min(text.find_first_not_of(XmlSpaces), text.size()));
  text = text.substr(0, text.find_last_not_of(XmlSpaces) + 1);
  text.remove_prefix(!text.empty() && text[0] == '+');
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && std::abs(value) <= largest;
}
}

std::vector<std::string> LeaveOutNodes(std::string& text)
{
  std::vector<std::string> found;
  for (std::size_t at = 0; (at = text.find(NodeStart, at)) != std::string::npos;)
  {
    const std::size_t end = FindEnd(text, at);
    const std::string_view tag(text.data() + at, end - at);
    const bool isNode = tag.size() > NodeStart.size() &&
      XmlSpaces.find(tag[NodeStart.size()]) != std::string_view::npos;
    if (isNode && end < text.size() &&
      !(IsDegrees(ValueOf(tag, "lat"), 90.0) && IsDegrees(ValueOf(tag, "lon"), 180.0)))
    {
      found.emplace_back(ValueOf(tag, "id").substr(0, LongestId));
      const bool isEmpty = tag.back() == '/';
      const std::size_t closing = isEmpty ? std::string::npos : text.find(NodeEnd, end);
      text.replace(at + 1, 4, "none");
      if (closing != std::string::npos)
      {
        text.replace(closing + 2, 4, "none");
      }
    }
    at = end;
  }
  return found;
}
}
