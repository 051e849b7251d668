// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFormat.h"
#include "TextLines.h"

#include <lzf.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <sstream>

namespace avianlidar::formats
{
namespace
{
constexpr std::uint64_t GreatestCount = 65536;

/// Words of each key of a header, before they are checked.
using Words = std::map<std::string, std::vector<std::string>>;

char upper(unsigned char c)
{
  return static_cast<char>(std::toupper(c));
}

std::uint64_t oneOf(Words& words, const char* key, std::uint64_t otherwise)
{
  failIf(words[key].size() > 1, key, " has more than one value");
  return words[key].empty() ? otherwise : numberOf<std::uint64_t>(words[key][0], key);
}

void understandFields(Words& words, PcdHeader& header)
{
  const auto &sizes = words["SIZE"], &types = words["TYPE"], &counts = words["COUNT"];
  const std::size_t n = words["FIELDS"].size();
  failIf(n == 0 || n > MostFields || sizes.size() != n || types.size() != n ||
      (!counts.empty() && counts.size() != n),
    "FIELDS, SIZE, TYPE and COUNT do not have as many values, or more than 4096");
  for (std::size_t i = 0; i < n; ++i)
  {
    TableField field;
    field.name = words["FIELDS"][i];
    const auto size = numberOf<std::uint64_t>(sizes[i], "SIZE");
    const std::string& type = types[i];
    const auto scalar = type.size() == 1 ? scalarOf(upper(type[0]), size) : std::nullopt;
    failIf(!scalar, "the field ", shown(field.name), " has TYPE ", shown(types[i]), " and SIZE ",
      shown(sizes[i]), ", expected I or U with 1, 2, 4, 8 or F with 4, 8");
    field.type = *scalar;
    field.count = counts.empty() ? 1 : numberOf<std::uint64_t>(counts[i], "COUNT");
    // Old converters of ROS write 0 for a single value. The Point Cloud Library accepts 0 too.
    field.count += field.count == 0;
    failIf(field.count > GreatestCount, "the field ", shown(field.name), " has COUNT ", field.count,
      ", expected 1 to 65536");
    header.fields.push_back(field);
  }
}

void understandSize(Words& words, PcdHeader& header)
{
  header.width = oneOf(words, "WIDTH", 0);
  header.height = oneOf(words, "HEIGHT", 1);
  const std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  failIf(header.width > most || header.height > most, "WIDTH or HEIGHT is above 4294967295");
  header.points = oneOf(words, "POINTS", header.width * header.height);
  failIf(!words["WIDTH"].empty() && header.points != header.width * header.height, "POINTS is ",
    header.points, ", expected WIDTH times HEIGHT, ", header.width * header.height);
  const std::vector<std::string>& viewpoint = words["VIEWPOINT"];
  failIf(!viewpoint.empty() && viewpoint.size() != header.viewpoint.size(),
    "VIEWPOINT does not have seven values");
  for (std::size_t i = 0; i < viewpoint.size(); ++i)
  {
    header.viewpoint[i] = numberOf<double>(viewpoint[i], "VIEWPOINT");
    failIf(!std::isfinite(header.viewpoint[i]), "VIEWPOINT has a value that is not finite");
  }
}

PcdData understandData(std::string kind)
{
  std::transform(kind.begin(), kind.end(), kind.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr const char* kinds[] = { "ascii", "binary", "binary_compressed" }; // as in PcdData
  const auto* found = std::find(std::begin(kinds), std::end(kinds), kind);
  failIf(found == std::end(kinds), "DATA is ", shown(kind),
    ", expected ascii, binary or binary_compressed");
  return static_cast<PcdData>(found - kinds);
}

using Bytes = std::vector<unsigned char>;

/// Returns the unpacked bytes of a compressed file, field by field, not point by point.
Bytes decompress(ByteSource& source, const PcdHeader& header)
{
  const Bytes sizes = source.bytes(header.begin, 8);
  const std::uint64_t packed = load<std::uint32_t>(sizes.data());
  const std::uint64_t plain = load<std::uint32_t>(sizes.data() + 4);
  failIf(plain / header.length() != header.points || plain % header.length() != 0,
    "its compressed data have ", plain, " bytes, expected ", header.points, " points of ",
    header.length());
  // LZF packs at most 264 bytes into three bytes.
  constexpr std::uint64_t greatestRatio = 88;
  const Bytes from = source.bytes(header.begin + 8, packed);
  const bool fits = plain <= greatestRatio * packed;
  requireMemoryFor(fits ? header.points : 0, header.length());
  Bytes to(fits ? plain : 0);
  failIf(to.size() != plain ||
      (plain > 0 &&
        lzf_decompress(from.data(), static_cast<unsigned int>(packed), to.data(),
          static_cast<unsigned int>(plain)) != plain),
    "its compressed data are damaged");
  return to;
}

void takeCompressed(const Bytes& data, const PcdHeader& header, const TableTargets& targets,
  const KeepGoing& keepGoing)
{
  const unsigned char* bytes = data.data();
  for (std::size_t f = 0; f < header.fields.size(); ++f)
  {
    for (std::uint64_t i = 0; i < header.points; ++i)
    {
      for (std::uint64_t c = 0; c < header.fields[f].count; ++c)
      {
        targets[f](i * header.fields[f].count + c, bytes);
        bytes += sizeOf(header.fields[f].type);
      }
    }
    goOn(keepGoing, static_cast<double>(f + 1) / header.fields.size());
  }
}

/// Returns whether a row follows the last row of a binary file. PCL fills the last page of a file
/// with zeros.
bool hasOneMoreRow(ByteSource& source, const PcdHeader& header)
{
  const std::uint64_t end = header.begin + header.points * header.length();
  if (!source.holds(end, header.length()))
  {
    return false;
  }
  const Bytes row = source.bytes(end, header.length());
  return std::any_of(row.begin(), row.end(), [](unsigned char byte) { return byte != 0; });
}

std::string makeHeader(const PcdOutput& output, std::uint64_t cells)
{
  std::string names, sizes, types, counts;
  for (const Field& field : output.fields)
  {
    names += " " + field.name;
    sizes += " " + std::to_string(sizeOf(field.type));
    types += isFloat(field.type) ? " F" : isSigned(field.type) ? " I" : " U";
    counts += " 1";
  }
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
  if (!output.comment.empty())
  {
    text += "# " + output.comment + "\n";
  }
  text += "VERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts +
    "\nWIDTH " + std::to_string(output.width) + "\nHEIGHT " + std::to_string(output.height) +
    "\nVIEWPOINT";
  for (const double number : output.viewpoint)
  {
    char digits[40];
    text += " " + std::string(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
  }
  return text + "\nPOINTS " + std::to_string(cells) + "\nDATA " +
    (output.ascii ? "ascii" : "binary") + "\n";
}
}

PcdHeader readPcdHeader(ByteSource& source)
{
  PcdHeader header;
  Words words;
  static const std::set<std::string> known{ "", "VERSION", "FIELDS", "SIZE", "TYPE", "COUNT",
    "WIDTH", "HEIGHT", "VIEWPOINT", "POINTS", "DATA" };
  TextLines lines(source, 0);
  std::string line;
  while (words["DATA"].empty())
  {
    failIf(!lines.get(line), "this is not a PCD file: it has no line DATA");
    std::istringstream text(line);
    std::string key, word;
    text >> key;
    std::transform(key.begin(), key.end(), key.begin(), upper);
    if (!key.empty() && key[0] == '#')
    {
      header.comments.push_back(line.substr(line.find('#') + 1));
      continue;
    }
    key = key == "COLUMNS" ? "FIELDS" : key; // key of version 0.5
    failIf(known.count(key) == 0, "this is not a PCD file: its header has the line \"", shown(line),
      "\"");
    while (text >> word)
    {
      words[key].push_back(word);
    }
    if (key == "DATA" && words[key].empty())
    {
      words[key].push_back("missing");
    }
  }
  header.begin = lines.position();
  header.data = understandData(words["DATA"][0]);
  understandFields(words, header);
  understandSize(words, header);
  if (header.data != PcdData::Compressed) // decompress() checks compressed files
  {
    header.checkLength(source, header.data == PcdData::Ascii);
  }
  return header;
}

Cloud readPcd(ByteSource& source, const KeepGoing& keepGoing)
{
  const PcdHeader header = readPcdHeader(source);
  if (header.data != PcdData::Compressed)
  {
    requireMemoryFor(header.points, header.length());
  }
  const Bytes plain = header.data == PcdData::Compressed ? decompress(source, header) : Bytes();
  Cloud cloud;
  const TableTargets targets = targetsOf(header, cloud);
  bool hasMore = false;
  std::string line;
  switch (header.data)
  {
    case PcdData::Ascii:
    {
      TextLines rest(source, readAsciiRows(source, header, targets, keepGoing));
      while (!hasMore && rest.get(line))
      {
        hasMore = line.find_first_not_of(" \t") != std::string::npos;
      }
      break;
    }
    case PcdData::Binary:
      readBinaryRows(source, header, targets, keepGoing);
      hasMore = hasOneMoreRow(source, header);
      break;
    default:
      takeCompressed(plain, header, targets, keepGoing);
  }
  if (hasMore)
  {
    cloud.warnings.push_back("its header says that it has " + std::to_string(header.points) +
      " points, and more follow, which are left out");
  }
  dropEmptyCells(cloud);
  cloud.sensor = { { header.viewpoint[0], header.viewpoint[1], header.viewpoint[2] } };
  // A later note of this project's writers replaces this position.
  cloud.notes.push_back({ "position", "m", { cloud.sensor->begin(), cloud.sensor->end() }, {} });
  for (const std::string& comment : header.comments)
  {
    if (comment.find(".PCD v") < 2)
    {
      continue; // first line of every PCD file
    }
    cloud.notes.push_back({ "comment", "", {}, { comment } });
  }
  return cloud;
}

void writePcd(OutputFile& file, const PcdOutput& output, const KeepGoing& keepGoing)
{
  const std::uint64_t cells = output.width * output.height;
  file.write(makeHeader(output, cells));
  writeRows(file, output, cells, keepGoing);
}
}
