// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFormat.h"
#include "TextLines.h"

#include <lzf.h>

#include <charconv>
#include <cmath>
#include <sstream>

namespace avianlidar::formats
{
namespace
{
using Bytes = std::vector<unsigned char>;

/// All bytes of a compressed file: field by field, not point by point.
Bytes decompress(ByteSource& source, const PcdHeader& header)
{
  const Bytes sizes = source.bytes(header.begin, 8);
  const std::uint64_t packed = load<std::uint32_t>(sizes.data());
  const std::uint64_t plain = load<std::uint32_t>(sizes.data() + 4);
  if (plain / header.length() != header.points || plain % header.length() != 0)
  {
    throw FormatError("its compressed data have " + std::to_string(plain) + " bytes, expected " +
      std::to_string(header.points) + " points of " + std::to_string(header.length()));
  }
  // LZF packs at most 264 bytes into three.
  constexpr std::uint64_t greatestRatio = 88;
  const Bytes from = source.bytes(header.begin + 8, packed);
  const bool fits = plain <= greatestRatio * packed;
  requireMemoryFor(fits ? header.points : 0, header.length());
  Bytes to(fits ? plain : 0);
  if (to.size() != plain ||
    (plain > 0 &&
      lzf_decompress(from.data(), static_cast<unsigned int>(packed), to.data(),
        static_cast<unsigned int>(plain)) != plain))
  {
    throw FormatError("its compressed data are damaged");
  }
  return to;
}

/// Where the fields go: x, y, z to the points, others to columns; "_" is padding.
class Columns
{
public:
  Columns(const PcdHeader& header, Cloud& to)
    : Header(header)
    , To(to)
  {
    int found = 0;
    for (const PcdField& field : header.fields)
    {
      Target target;
      for (int axis = 0; axis < 3; ++axis)
      {
        if (field.name == std::string(1, "xyz"[axis]) && field.count == 1)
        {
          target.axis = axis;
          found |= 1 << axis;
        }
      }
      if (target.axis < 0 && field.name != "_")
      {
        target.column = static_cast<int>(to.columns.size());
        to.columns.push_back({ field.name, "", static_cast<int>(field.count),
          makeValues(field.type, header.points * field.count) });
      }
      this->Targets.push_back(target);
    }
    if (found != 7)
    {
      throw FormatError("it has no fields x, y and z");
    }
    to.points.resize(3 * header.points);
  }

  /// Value c of field f of point i.
  void take(std::size_t f, std::uint64_t i, std::uint64_t c, const unsigned char* bytes)
  {
    const Target& target = this->Targets[f];
    if (target.axis >= 0)
    {
      this->To.points[3 * i + target.axis] = loadAs(this->Header.fields[f].type, bytes);
    }
    else if (target.column >= 0)
    {
      setFromBytes(
        this->To.columns[target.column].values, i * this->Header.fields[f].count + c, bytes);
    }
  }

private:
  struct Target
  {
    int axis = -1;
    int column = -1;
  };
  const PcdHeader& Header;
  Cloud& To;
  std::vector<Target> Targets;
};

/// A word of ASCII data as bytes of the type. Integers of 64 bits do not go by way of double: times
/// in nanoseconds have more digits.
void wordToBytes(const std::string& word, Scalar type, unsigned char* bytes)
{
  const char* end = word.data() + word.size();
  const auto whole = [&](auto& integer)
  {
    const auto [stop, problem] = std::from_chars(word.data(), end, integer);
    return problem == std::errc() && stop == end;
  };
  std::int64_t withSign = 0;
  std::uint64_t without = 0;
  if (type == Scalar::Int64 && whole(withSign))
  {
    store(withSign, bytes);
  }
  else if (type == Scalar::UInt64 && whole(without))
  {
    store(without, bytes);
  }
  else
  {
    storeAs(type, numberOf<double>(word, "a line of the data"), bytes);
  }
}

void readAscii(
  ByteSource& source, const PcdHeader& header, Columns& columns, const KeepGoing& keepGoing)
{
  TextLines lines(source, header.begin);
  std::string line;
  unsigned char bytes[8];
  for (std::uint64_t i = 0; i < header.points; ++i)
  {
    do
    {
      if (!lines.get(line))
      {
        throw FormatError("it is cut short: it says that it has " + std::to_string(header.points) +
          " points, and has " + std::to_string(i));
      }
    } while (line.find_first_not_of(" \t") == std::string::npos);
    std::istringstream words(line);
    std::string word;
    for (std::size_t f = 0; f < header.fields.size(); ++f)
    {
      for (std::uint64_t c = 0; c < header.fields[f].count; ++c)
      {
        if (!(words >> word))
        {
          throw FormatError("point " + std::to_string(i) + " has too few values");
        }
        wordToBytes(word, header.fields[f].type, bytes);
        columns.take(f, i, c, bytes);
      }
    }
    goOn(keepGoing, static_cast<std::int64_t>(i), static_cast<std::int64_t>(header.points), 0, 1);
  }
}

void readBinary(
  ByteSource& source, const PcdHeader& header, Columns& columns, const KeepGoing& keepGoing)
{
  forEachRecord(source, header.begin, header.length(), header.points,
    [&](std::uint64_t i, const unsigned char* bytes)
    {
      for (std::size_t f = 0; f < header.fields.size(); ++f)
      {
        for (std::uint64_t c = 0; c < header.fields[f].count; ++c)
        {
          columns.take(f, i, c, bytes);
          bytes += sizeOf(header.fields[f].type);
        }
      }
      goOn(keepGoing, static_cast<std::int64_t>(i), static_cast<std::int64_t>(header.points), 0, 1);
    });
}

void takeCompressed(
  const Bytes& data, const PcdHeader& header, Columns& columns, const KeepGoing& keepGoing)
{
  const unsigned char* bytes = data.data();
  for (std::size_t f = 0; f < header.fields.size(); ++f)
  {
    for (std::uint64_t i = 0; i < header.points; ++i)
    {
      for (std::uint64_t c = 0; c < header.fields[f].count; ++c)
      {
        columns.take(f, i, c, bytes);
        bytes += sizeOf(header.fields[f].type);
      }
    }
    if (keepGoing && !keepGoing(static_cast<double>(f + 1) / header.fields.size()))
    {
      throw Aborted();
    }
  }
}

void dropEmptyCells(Cloud& cloud)
{
  std::vector<bool> marks(cloud.size());
  bool all = true;
  for (std::size_t i = 0; i < marks.size(); ++i)
  {
    const double* p = cloud.points.data() + 3 * i;
    marks[i] = std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
    all = all && marks[i];
  }
  if (all)
  {
    return;
  }
  Values points = std::move(cloud.points);
  keepMarked(points, 3, marks);
  cloud.points = std::move(std::get<std::vector<double>>(points));
  for (Column& column : cloud.columns)
  {
    keepMarked(column.values, column.components, marks);
  }
}
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
  Columns columns(header, cloud);
  switch (header.data)
  {
    case PcdData::Ascii:
      readAscii(source, header, columns, keepGoing);
      break;
    case PcdData::Binary:
      readBinary(source, header, columns, keepGoing);
      break;
    default:
      takeCompressed(plain, header, columns, keepGoing);
  }
  dropEmptyCells(cloud);
  cloud.sensor = { { header.viewpoint[0], header.viewpoint[1], header.viewpoint[2] } };
  for (const std::string& comment : header.comments)
  {
    if (comment.find(".PCD v") < 2)
    {
      continue; // the line that every PCD file has
    }
    cloud.notes.push_back({ "comment", "", {}, { comment } });
  }
  return cloud;
}
}
