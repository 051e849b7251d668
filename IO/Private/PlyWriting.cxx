// SPDX-License-Identifier: BSD-3-Clause
#include "PlyFormat.h"

#include <algorithm>
#include <limits>

namespace avianlidar::formats
{
namespace
{
/// VTK takes lines of up to 4095 characters, RPly of up to 1023. A comment that begins with a plus
/// continues the one before.
constexpr std::size_t LongestComment = 900;

/// The names of 1994, which every reader knows.
const char* nameOf(Scalar type)
{
  switch (type)
  {
    case Scalar::Int8:
      return "char";
    case Scalar::UInt8:
      return "uchar";
    case Scalar::Int16:
      return "short";
    case Scalar::UInt16:
      return "ushort";
    case Scalar::Int32:
      return "int";
    case Scalar::UInt32:
      return "uint";
    case Scalar::Float32:
      return "float";
    default:
      return "double";
  }
}

void writeFace(
  OutputFile& file, std::int64_t face, const std::vector<std::int64_t>& points, bool ascii)
{
  const auto most = std::numeric_limits<std::int32_t>::max();
  const bool beyond = std::any_of(points.begin(), points.end(), [=](auto p) { return p > most; });
  if (points.size() > 255 || beyond)
  {
    throw FormatError("polygon " + std::to_string(face) + " has " +
      (beyond ? "a point beyond the 2^31 - 1 that PLY numbers"
              : std::to_string(points.size()) + " points, expected at most 255"));
  }
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
