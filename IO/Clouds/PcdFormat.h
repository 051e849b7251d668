// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PcdFormat.h
 * @brief Reads and writes PCD, the format of the Point Cloud Library.
 *
 * Source: "The PCD (Point Cloud Data) file format", version 0.7, pointclouds.org. The code writes
 * version 0.7, binary or ASCII, in rows and columns or as a list. It reads ASCII, binary and
 * binary_compressed (LZF), with fields of any type and count.
 */
#ifndef AvianLidarPcdFormat_h
#define AvianLidarPcdFormat_h

#include "FieldTable.h"

namespace avianlidar::formats
{
struct PcdHeader : FieldTable
{
  std::array<double, 7> viewpoint{ { 0, 0, 0, 1, 0, 0, 0 } }; ///< x y z, m, then quaternion w x y z
  bool compressed = false;
  bool organised = false; ///< whether the points are a grid, whose empty cells have NaN coordinates
};

/// Reads and checks the header up to DATA. Throws FormatError if the declared points do not fit the
/// length of the file.
PcdHeader readPcdHeader(ByteSource& source);

/// Reads a cloud, without the points whose coordinates are not finite; see dropEmptyCells(). Throws
/// FormatError if the file is not a PCD file, is cut short, or lacks x, y or z.
Cloud readPcd(ByteSource& source, const KeepGoing& keepGoing);

/// File to be written. The index of a cell is row * width + column.
struct PcdOutput : TableOutput
{
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  std::array<double, 7> viewpoint{ { 0, 0, 0, 1, 0, 0, 0 } };
};

void writePcd(OutputFile& file, const PcdOutput& output, const KeepGoing& keepGoing);
}

#endif
