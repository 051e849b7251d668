// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFormat.h"
#include "TextLines.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>

namespace avianlidar::formats
{
namespace
{
constexpr std::uint64_t GreatestCount = 65536;

/// The words behind the keys of a header, not yet understood.
struct Words
{
  std::vector<std::string> fields, sizes, types, counts, width, height, viewpoint, points, data;

  std::vector<std::string>* of(const std::string& key)
  {
    // FIELDS was COLUMNS in 0.5.
    return key == "FIELDS" || key == "COLUMNS" ? &this->fields
      : key == "SIZE"                          ? &this->sizes
      : key == "TYPE"                          ? &this->types
      : key == "COUNT"                         ? &this->counts
      : key == "WIDTH"                         ? &this->width
      : key == "HEIGHT"                        ? &this->height
      : key == "VIEWPOINT"                     ? &this->viewpoint
      : key == "POINTS"                        ? &this->points
      : key == "DATA"                          ? &this->data
                                               : nullptr;
  }
};

char upper(unsigned char c)
{
  return static_cast<char>(std::toupper(c));
}

std::uint64_t oneOf(const std::vector<std::string>& words, const char* key, std::uint64_t otherwise)
{
  if (words.size() > 1)
  {
    throw FormatError(std::string(key) + " has more than one value");
  }
  return words.empty() ? otherwise : numberOf<std::uint64_t>(words[0], key);
}

void understandFields(const Words& words, PcdHeader& header)
{
  const std::size_t n = words.fields.size();
  if (n == 0 || n > MostFields || words.sizes.size() != n || words.types.size() != n ||
    (!words.counts.empty() && words.counts.size() != n))
  {
    throw FormatError("FIELDS, SIZE, TYPE and COUNT do not have as many values, or more than 4096");
  }
  for (std::size_t i = 0; i < n; ++i)
  {
    TableField field;
    field.name = words.fields[i];
    const auto size = numberOf<std::uint64_t>(words.sizes[i], "SIZE");
    const std::string& type = words.types[i];
    if (type.size() != 1 || !scalarOf(upper(type[0]), size, field.type))
    {
      throw FormatError("the field " + shown(field.name) + " has TYPE " + shown(words.types[i]) +
        " and SIZE " + shown(words.sizes[i]) + ", expected I or U with 1, 2, 4, 8 or F with 4, 8");
    }
    field.count = words.counts.empty() ? 1 : numberOf<std::uint64_t>(words.counts[i], "COUNT");
    // Old converters of ROS write 0 for a single value, and so the Point Cloud Library reads it.
    field.count += field.count == 0;
    if (field.count > GreatestCount)
    {
      throw FormatError("the field " + shown(field.name) + " has COUNT " +
        std::to_string(field.count) + ", expected 1 to 65536");
    }
    header.fields.push_back(field);
  }
}

void understandSize(const Words& words, PcdHeader& header)
{
  header.width = oneOf(words.width, "WIDTH", 0);
  header.height = oneOf(words.height, "HEIGHT", 1);
  const std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  if (header.width > most || header.height > most)
  {
    throw FormatError("WIDTH or HEIGHT is above 4294967295");
  }
  header.points = oneOf(words.points, "POINTS", header.width * header.height);
  if (!words.width.empty() && header.points != header.width * header.height)
  {
    throw FormatError("POINTS is " + std::to_string(header.points) +
      ", expected WIDTH times HEIGHT, " + std::to_string(header.width * header.height));
  }
  if (!words.viewpoint.empty() && words.viewpoint.size() != header.viewpoint.size())
  {
    throw FormatError("VIEWPOINT does not have seven values");
  }
  for (std::size_t i = 0; i < words.viewpoint.size(); ++i)
  {
    header.viewpoint[i] = numberOf<double>(words.viewpoint[i], "VIEWPOINT");
    if (!std::isfinite(header.viewpoint[i]))
    {
      throw FormatError("VIEWPOINT has a value that is not finite");
    }
  }
}

PcdData understandData(const Words& words)
{
  std::string kind = words.data.empty() ? "" : words.data[0];
  std::transform(kind.begin(), kind.end(), kind.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (kind == "ascii")
  {
    return PcdData::Ascii;
  }
  if (kind == "binary")
  {
    return PcdData::Binary;
  }
  if (kind == "binary_compressed")
  {
    return PcdData::Compressed;
  }
  throw FormatError("DATA is " + shown(kind) + ", expected ascii, binary or binary_compressed");
}

}

PcdHeader readPcdHeader(ByteSource& source)
{
  PcdHeader header;
  Words words;
  TextLines lines(source, 0);
  std::string line;
  while (words.data.empty())
  {
    if (!lines.get(line))
    {
      throw FormatError("it is no PCD file: it has no line DATA");
    }
    std::istringstream text(line);
    std::string key, word;
    text >> key;
    std::transform(key.begin(), key.end(), key.begin(), upper);
    if (!key.empty() && key[0] == '#')
    {
      header.comments.push_back(line.substr(line.find('#') + 1));
      continue;
    }
    std::vector<std::string>* values = words.of(key);
    if (!values && !key.empty() && key != "VERSION")
    {
      throw FormatError("it is no PCD file: its header has the line \"" + shown(line) + "\"");
    }
    while (values && text >> word)
    {
      values->push_back(word);
    }
    if (key == "DATA" && words.data.empty())
    {
      words.data.push_back("missing");
    }
  }
  header.begin = lines.position();
  header.data = understandData(words);
  understandFields(words, header);
  understandSize(words, header);
  if (header.data != PcdData::Compressed) // of which decompress() does
  {
    header.checkLength(source, header.data == PcdData::Ascii);
  }
  return header;
}

}
