// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlyFormat.h
 * @brief Reads and writes the points of PLY, the polygon file format.
 *
 * Source: G. Turk, "The PLY Polygon File Format", 1994. Written: 1.0, binary little endian or
 * ASCII. Read: ASCII, binary little and big endian; only the element `vertex`, which has no lists.
 * A comment that begins with a plus sign continues the one before it.
 */
#ifndef AvianLidarPlyFormat_h
#define AvianLidarPlyFormat_h

#include "FieldTable.h"

namespace avianlidar::formats
{
/// Header of the element `vertex`; `begin` is the end of the elements before `vertex`.
struct PlyHeader : FieldTable
{
  std::vector<std::string> comments;
  bool ascii = false;
  bool hasFaces = false; ///< a mesh
};

/// The lines up to end_header, checked; what they promise fits the file's length.
PlyHeader readPlyHeader(ByteSource& source);

/// Reads a cloud; points whose coordinates are not finite are left out. FormatError: not a PLY
/// file, cut short, no x, y, z.
Cloud readPly(ByteSource& source, const KeepGoing& keepGoing);

/// Polygons: how many, and the points of each.
struct PlyFaces
{
  std::int64_t count = 0;
  std::function<void(std::int64_t face, std::vector<std::int64_t>& points)> pointsOf;
};

/// FormatError for a face of more than 255 points, or a point beyond 2^31 - 1 in one.
void writePly(OutputFile& file, const TableOutput& output, std::uint64_t points,
  const PlyFaces& faces, const KeepGoing& keepGoing);
}

#endif
