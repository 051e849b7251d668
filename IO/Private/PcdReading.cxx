// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFormat.h"
#include "TextLines.h"

#include <lzf.h>

#include <algorithm>

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

void takeCompressed(
  const Bytes& data, const PcdHeader& header, TableColumns& columns, const KeepGoing& keepGoing)
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
      throw WorkStopped();
    }
  }
}

/// Whether a row follows the last one of a binary file. PCL fills its last page with zeros.
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
  TableColumns columns(header, cloud);
  bool hasMore = false;
  std::string line;
  switch (header.data)
  {
    case PcdData::Ascii:
    {
      TextLines rest(source, readAsciiRows(source, header, columns, keepGoing));
      while (!hasMore && rest.get(line))
      {
        hasMore = line.find_first_not_of(" \t") != std::string::npos;
      }
      break;
    }
    case PcdData::Binary:
      readBinaryRows(source, header, columns, keepGoing);
      hasMore = hasOneMoreRow(source, header);
      break;
    default:
      takeCompressed(plain, header, columns, keepGoing);
  }
  if (hasMore)
  {
    cloud.warnings.push_back("its header says that it has " + std::to_string(header.points) +
      " points, and more follow, which are left out");
  }
  dropEmptyCells(cloud);
  cloud.sensor = { { header.viewpoint[0], header.viewpoint[1], header.viewpoint[2] } };
  // A writer's note on the sensor, which says more, comes later.
  cloud.notes.push_back({ "position", "m", { cloud.sensor->begin(), cloud.sensor->end() }, {} });
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
