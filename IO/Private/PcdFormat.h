// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PcdFormat.h
 * @brief Reads and writes PCD, the format of the Point Cloud Library.
 *
 * Source: "The PCD (Point Cloud Data) file format", version 0.7, pointclouds.org. Written: 0.7,
 * binary or ASCII, in rows and columns or as a list. Read: ASCII, binary and binary_compressed
 * (LZF), fields of any type and count.
 */
#ifndef AvianLidarPcdFormat_h
#define AvianLidarPcdFormat_h

#include "FieldTable.h"

namespace avianlidar::formats
{
enum class PcdData
{
  Ascii,
  Binary,
  Compressed
};

struct PcdHeader : FieldTable
{
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  std::array<double, 7> viewpoint{ { 0, 0, 0, 1, 0, 0, 0 } }; ///< x y z, quaternion w x y z
  std::vector<std::string> comments;
  PcdData data = PcdData::Ascii;
};

/// The lines up to DATA, checked; what they promise fits the file's length.
PcdHeader readPcdHeader(ByteSource& source);

/// Reads a cloud; points whose coordinates are not finite (empty cells) are left out.
/// FormatError: not a PCD file, cut short, no x, y, z.
Cloud readPcd(ByteSource& source, const KeepGoing& keepGoing);

/// What is written: cell row * width + column.
struct PcdOutput : TableOutput
{
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  std::array<double, 7> viewpoint{ { 0, 0, 0, 1, 0, 0, 0 } };
};

void writePcd(OutputFile& file, const PcdOutput& output, const KeepGoing& keepGoing);
}

#endif
