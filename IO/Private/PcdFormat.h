// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file PcdFormat.h
 * @brief PCD, the format of the Point Cloud Library: what is read and written of it.
 *
 * Source: "The PCD (Point Cloud Data) file format", version 0.7, pointclouds.org. Written: 0.7,
 * binary or ASCII, in rows and columns or as a list. Read: ASCII, binary and binary_compressed
 * (LZF), fields of any type and count.
 */
#ifndef AvianLidarPcdFormat_h
#define AvianLidarPcdFormat_h

#include "ByteSource.h"
#include "CloudData.h"
#include "OutputFile.h"

namespace avianlidar::formats
{
struct PcdField
{
  std::string name;
  Scalar type = Scalar::Float32;
  std::uint64_t count = 1;
};

enum class PcdData
{
  Ascii,
  Binary,
  Compressed
};

struct PcdHeader
{
  std::vector<PcdField> fields;
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  std::uint64_t points = 0;
  std::array<double, 7> viewpoint{ { 0, 0, 0, 1, 0, 0, 0 } }; ///< x y z, quaternion w x y z
  std::vector<std::string> comments;
  PcdData data = PcdData::Ascii;
  std::uint64_t begin = 0; ///< of the data

  /// Bytes of a point.
  std::uint64_t length() const;
};

/// The lines up to DATA, checked; what they promise fits the file's length.
PcdHeader readPcdHeader(ByteSource& source);

/// Reads a cloud; points whose coordinates are not finite (empty cells) are left out.
/// FormatError: not a PCD file, cut short, no x, y, z.
Cloud readPcd(ByteSource& source, const KeepGoing& keepGoing);

/// What is written.
struct PcdOutput
{
  std::uint64_t width = 0;
  std::uint64_t height = 1;
  /// x, y, z first.
  std::vector<Field> fields;
  /// Index of the point in cell (row * width + column), or -1; empty: cells are points.
  std::vector<std::int64_t> cells;
  /// The value of a field where no point is.
  std::function<double(std::size_t field, std::int64_t cell)> empty;
  std::array<double, 7> viewpoint{ { 0, 0, 0, 1, 0, 0, 0 } };
  std::string comment; ///< one line
  bool ascii = false;
};

void writePcd(OutputFile& file, const PcdOutput& output, const KeepGoing& keepGoing);
}

#endif
