// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PlyFormat.h
 * @brief Reads and writes the points of PLY, the polygon file format.
 *
 * Source: G. Turk, "The PLY Polygon File Format", 1994. The code writes version 1.0, binary little
 * endian or ASCII. It reads the element `vertex` of ASCII, binary little endian and binary big
 * endian files. Files whose vertices have a list property are refused. A comment that begins with a
 * plus sign continues the comment before.
 */
#ifndef AvianLidarPlyFormat_h
#define AvianLidarPlyFormat_h

#include "FieldTable.h"

namespace avianlidar::formats
{
/// Header of the element `vertex`. The member `begin` is the end of the elements before `vertex`.
struct PlyHeader : FieldTable
{
  bool hasFaces = false; ///< whether the file has an element `face` that is not empty
};

/// Reads and checks the header up to end_header. Throws FormatError if the declared elements do not
/// fit the length of the file.
PlyHeader readPlyHeader(ByteSource& source);

/// Reads a cloud, without the points whose coordinates are not finite. Throws FormatError if the
/// file is not a PLY file, is cut short, or lacks x, y or z.
Cloud readPly(ByteSource& source, const KeepGoing& keepGoing);

/// Number of polygons, and a function that gives the indices of the points of a polygon.
struct PlyFaces
{
  std::int64_t count = 0;
  std::function<void(std::int64_t face, std::vector<std::int64_t>& points)> pointsOf;
};

/// Writes a file. Throws FormatError if a face has more than 255 points or an index of a point
/// above 2^31 - 1.
void writePly(OutputFile& file, const TableOutput& output, std::uint64_t points,
  const PlyFaces& faces, const KeepGoing& keepGoing);
}

#endif
