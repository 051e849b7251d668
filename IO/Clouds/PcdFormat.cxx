// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFormat.h"

#include "CloudNotes.h"
#include "TextLines.h"

#include <lzf.h>
#include <vtksys/SystemTools.hxx>

#include <algorithm>
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
using vtksys::SystemTools;

constexpr std::uint64_t GreatestCount = 65536;

/// Words of each key of a header, before they are checked.
using Words = std::map<std::string, std::vector<std::string>>;

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
    const std::string type = SystemTools::UpperCase(types[i]);
    const auto scalar = type.size() == 1 ? scalarOf(type[0], size) : std::nullopt;
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
  const std::uint64_t width = oneOf(words, "WIDTH", 0), height = oneOf(words, "HEIGHT", 1);
  const std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  failIf(width > most || height > most, "WIDTH or HEIGHT is above 4294967295");
  header.organised = height > 1;
  header.points = oneOf(words, "POINTS", width * height);
  failIf(!words["WIDTH"].empty() && header.points != width * height, "POINTS is ", header.points,
    ", expected WIDTH times HEIGHT, ", width * height);
  const std::vector<std::string>& viewpoint = words["VIEWPOINT"];
  failIf(!viewpoint.empty() && viewpoint.size() != header.viewpoint.size(),
    "VIEWPOINT does not have seven values");
  for (std::size_t i = 0; i < viewpoint.size(); ++i)
  {
    header.viewpoint[i] = numberOf<double>(viewpoint[i], "VIEWPOINT");
    failIf(!std::isfinite(header.viewpoint[i]), "VIEWPOINT has a value that is not finite");
  }
}

void understandData(const std::string& word, PcdHeader& header)
{
  const std::string kind = SystemTools::LowerCase(word);
  header.ascii = kind == "ascii";
  header.compressed = kind == "binary_compressed";
  failIf(!header.ascii && !header.compressed && kind != "binary", "DATA is ", shown(kind),
    ", expected ascii, binary or binary_compressed");
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

/// Returns whether a row follows the last row, which ends at the offset `end`. PCL fills the last
/// page of a binary file with zeros.
bool hasOneMoreRow(ByteSource& source, const PcdHeader& header, std::uint64_t end)
{
  if (header.ascii)
  {
    TextLines rest(source, end);
    bool hasWords = false;
    for (std::string line; !hasWords && rest.get(line);)
    {
      hasWords = line.find_first_not_of(" \t") != std::string::npos;
    }
    return hasWords;
  }
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
    key = SystemTools::UpperCase(key);
    if (!key.empty() && key[0] == '#')
    {
      const std::string comment = line.substr(line.find('#') + 1);
      if (comment.find(".PCD v") > 1) // not the first line of every PCD file
      {
        header.comments.push_back(comment);
      }
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
  understandData(words["DATA"][0], header);
  understandFields(words, header);
  understandSize(words, header);
  if (!header.compressed) // decompress() checks compressed files
  {
    header.checkLength(source);
  }
  return header;
}

Cloud readPcd(ByteSource& source, const KeepGoing& keepGoing)
{
  const PcdHeader header = readPcdHeader(source);
  if (!header.compressed)
  {
    requireMemoryFor(header.points, header.length());
  }
  const Bytes plain = header.compressed ? decompress(source, header) : Bytes();
  Cloud cloud;
  const TableTargets targets = targetsOf(header, cloud);
  if (header.compressed)
  {
    takeCompressed(plain, header, targets, keepGoing);
  }
  else if (hasOneMoreRow(source, header, readRows(source, header, targets, keepGoing)))
  {
    cloud.warnings.push_back("its header says that it has " + std::to_string(header.points) +
      " points, and more follow, which are left out");
  }
  CloudNotes notes;
  const bool isOwn = std::any_of(header.comments.begin(), header.comments.end(),
    [&notes](const std::string& comment) { return fromText(comment, notes); });
  dropEmptyCells(cloud, header.organised || isOwn); // grids of this project may have one row
  cloud.sensor = { { header.viewpoint[0], header.viewpoint[1], header.viewpoint[2] } };
  // A later note of this project's writers replaces this position.
  cloud.notes.push_back({ "position", "m", { cloud.sensor->begin(), cloud.sensor->end() }, {} });
  addComments(header, cloud);
  return cloud;
}

void writePcd(OutputFile& file, const PcdOutput& output, const KeepGoing& keepGoing)
{
  const std::uint64_t cells = output.width * output.height;
  file.write(makeHeader(output, cells));
  writeRows(file, output, cells, keepGoing);
}
}
