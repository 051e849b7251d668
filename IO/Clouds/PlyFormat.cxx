// SPDX-License-Identifier: BSD-3-Clause
#include "PlyFormat.h"
#include "TextLines.h"

#include <algorithm>
#include <limits>
#include <sstream>

namespace avianlidar::formats
{
namespace
{
struct Property
{
  TableField field;
  bool isList = false;
  Scalar countType = Scalar::UInt8;
};

struct Element
{
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

/// Names of a type: the name of 1994, which all readers accept, and a later name.
struct TypeName
{
  const char* name;
  const char* later;
  Scalar type;
};
constexpr TypeName TypeNames[] = { { "char", "int8", Scalar::Int8 },
  { "uchar", "uint8", Scalar::UInt8 }, { "short", "int16", Scalar::Int16 },
  { "ushort", "uint16", Scalar::UInt16 }, { "int", "int32", Scalar::Int32 },
  { "uint", "uint32", Scalar::UInt32 }, { "float", "float32", Scalar::Float32 },
  { "double", "float64", Scalar::Float64 } };

Scalar typeOf(const std::string& word)
{
  const auto* found = std::find_if(std::begin(TypeNames), std::end(TypeNames),
    [&](const TypeName& known) { return word == known.name || word == known.later; });
  failIf(found == std::end(TypeNames), "a property has the type \"", shown(word),
    "\", expected char, uchar, short, ushort, int, uint, float or double");
  return found->type;
}

Property propertyOf(std::istringstream& text)
{
  Property property;
  std::string type;
  text >> type;
  if (type == "list")
  {
    std::string count;
    text >> count >> type;
    property.isList = true;
    property.countType = typeOf(count);
    failIf(isFloat(property.countType), "a list has a count of type ", shown(count),
      ", expected whole numbers");
  }
  property.field.type = typeOf(type);
  failIf(!(text >> property.field.name), "a property has no name");
  return property;
}

/// Reads the lines of the header. Sets the format, the comments and the end of the lines in
/// `header`.
std::vector<Element> readLines(ByteSource& source, PlyHeader& header)
{
  std::vector<Element> elements;
  TextLines lines(source, 0);
  std::string line, format;
  std::uint64_t properties = 0;
  failIf(!lines.get(line) || line != "ply",
    "this is not a PLY file: it does not begin with a line \"ply\"");
  for (;;)
  {
    failIf(!lines.get(line), "this is not a PLY file: it has no line end_header");
    std::istringstream text(line);
    std::string key, word;
    text >> key;
    if (key == "end_header")
    {
      break;
    }
    if (key == "comment" || key == "obj_info")
    {
      const std::size_t at = std::min(line.size(), line.find(key) + key.size() + 1);
      const bool continues = line[at] == '+' && !header.comments.empty();
      if (continues)
      {
        header.comments.back() += line.substr(at + 1);
      }
      else
      {
        header.comments.push_back(line.substr(at));
      }
    }
    else if (key == "format")
    {
      text >> format >> word;
    }
    else if (key == "element" && text >> word)
    {
      elements.push_back({ word, 0, {} });
      text >> word;
      elements.back().count = numberOf<std::uint64_t>(word, "element");
    }
    else if (key == "property" && !elements.empty() && ++properties <= MostFields)
    {
      elements.back().properties.push_back(propertyOf(text));
    }
    else
    {
      fail("this is not a PLY file of up to 4096 properties: its header has the line \"",
        shown(line), "\"");
    }
  }
  header.begin = lines.position();
  header.ascii = format == "ascii";
  header.bigEndian = format == "binary_big_endian";
  failIf(!header.ascii && !header.bigEndian && format != "binary_little_endian", "format is \"",
    shown(format), "\", expected ascii, binary_little_endian or binary_big_endian");
  return elements;
}

/// Returns the offset of the end of a binary element, bytes.
std::uint64_t endOf(ByteSource& source, const Element& element, std::uint64_t begin, bool bigEndian)
{
  const std::string name = shown(element.name);
  const auto require = [&](bool holds)
  { failIf(!holds, "it is cut short: its element ", name, " has no end"); };
  std::uint64_t length = 0;
  bool lists = false;
  for (const Property& property : element.properties)
  {
    length += sizeOf(property.field.type);
    lists = lists || property.isList;
  }
  if (!lists)
  {
    require(length == 0 || element.count <= (source.size() - begin) / length);
    return begin + element.count * length;
  }
  for (std::uint64_t row = 0; row < element.count; ++row)
  {
    for (const Property& property : element.properties)
    {
      std::uint64_t values = 1;
      if (property.isList)
      {
        const std::size_t size = sizeOf(property.countType);
        require(source.holds(begin, size));
        std::vector<unsigned char> bytes = source.bytes(begin, size);
        if (bigEndian)
        {
          std::reverse(bytes.begin(), bytes.end());
        }
        values =
          static_cast<std::uint64_t>(std::max(0.0, loadAs(property.countType, bytes.data())));
        begin += size;
      }
      const std::uint64_t count = values * sizeOf(property.field.type); // at most 2^35 bytes
      require(source.holds(begin, count));
      begin += count;
    }
  }
  return begin;
}

/// Returns the offset of the end of an element of text, bytes.
std::uint64_t endOfLines(ByteSource& source, const Element& element, std::uint64_t begin)
{
  TextLines lines(source, begin);
  const std::string name = shown(element.name);
  std::string line;
  for (std::uint64_t row = 0; row < element.count; ++row)
  {
    failIf(!lines.get(line), "it is cut short: its element ", name, " has no end");
  }
  return lines.position();
}

/// Greatest length of a comment, bytes. VTK reads lines of up to 4095 characters, and RPly reads
/// lines of up to 1023 characters.
constexpr std::size_t LongestComment = 900;

const char* nameOf(Scalar type)
{
  return std::find_if(std::begin(TypeNames), std::end(TypeNames) - 1,
    [type](const TypeName& known) { return known.type == type; })
    ->name;
}

void writeFace(
  OutputFile& file, std::int64_t face, const std::vector<std::int64_t>& points, bool ascii)
{
  const auto most = std::numeric_limits<std::int32_t>::max();
  const bool beyond = std::any_of(points.begin(), points.end(), [=](auto p) { return p > most; });
  failIf(beyond, "polygon ", face, " has a point beyond the 2^31 - 1 that PLY numbers");
  failIf(
    points.size() > 255, "polygon ", face, " has ", points.size(), " points, expected at most 255");
  std::string line =
    ascii ? std::to_string(points.size()) : std::string(1, static_cast<char>(points.size()));
  for (const std::int64_t point : points)
  {
    unsigned char bytes[4];
    store(static_cast<std::int32_t>(point), bytes);
    line += ascii ? " " + std::to_string(point) : std::string(bytes, bytes + sizeof bytes);
  }
  file.write(ascii ? line + "\n" : line);
}
}

PlyHeader readPlyHeader(ByteSource& source)
{
  PlyHeader header;
  const std::vector<Element> elements = readLines(source, header);
  const auto vertex = std::find_if(elements.begin(), elements.end(),
    [](const Element& element) { return element.name == "vertex"; });
  failIf(vertex == elements.end() || vertex->properties.empty(),
    "it has no element vertex with properties");
  for (const Element& element : elements)
  {
    header.hasFaces = header.hasFaces || (element.name == "face" && element.count > 0);
  }
  for (const Property& property : vertex->properties)
  {
    failIf(property.isList, "its vertices have the list ", shown(property.field.name),
      ", expected one number for each property of a vertex");
    header.fields.push_back(property.field);
  }
  header.points = vertex->count;
  for (auto element = elements.begin(); element != vertex; ++element)
  {
    header.begin = header.ascii ? endOfLines(source, *element, header.begin)
                                : endOf(source, *element, header.begin, header.bigEndian);
  }
  header.checkLength(source);
  return header;
}

Cloud readPly(ByteSource& source, const KeepGoing& keepGoing)
{
  const PlyHeader header = readPlyHeader(source);
  requireMemoryFor(header.points, header.length());
  Cloud cloud;
  readRows(source, header, targetsOf(header, cloud), keepGoing);
  dropEmptyCells(cloud);
  addComments(header, cloud);
  return cloud;
}

void writePly(OutputFile& file, const TableOutput& output, std::uint64_t points,
  const PlyFaces& faces, const KeepGoing& keepGoing)
{
  std::string header =
    std::string("ply\nformat ") + (output.ascii ? "ascii" : "binary_little_endian") + " 1.0\n";
  for (std::size_t at = 0; at < output.comment.size(); at += LongestComment)
  {
    header +=
      (at > 0 ? "comment +" : "comment ") + output.comment.substr(at, LongestComment) + "\n";
  }
  header += "element vertex " + std::to_string(points) + "\n";
  for (const Field& field : output.fields)
  {
    header += std::string("property ") + nameOf(field.type) + " " + field.name + "\n";
  }
  if (faces.count > 0)
  {
    header += "element face " + std::to_string(faces.count) + "\n";
    header += "property list uchar int vertex_indices\n";
  }
  file.write(header + "end_header\n");
  writeRows(file, output, points, keepGoing);
  std::vector<std::int64_t> ids;
  for (std::int64_t i = 0; i < faces.count; ++i)
  {
    faces.pointsOf(i, ids);
    writeFace(file, i, ids, output.ascii);
    goOn(keepGoing, i, faces.count, 1.0, 1.0);
  }
}
}
