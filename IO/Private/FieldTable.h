// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file FieldTable.h
 * @brief Reads and writes points as rows of typed fields, text or binary, as in PCD and PLY after
 * the header.
 */
#ifndef AvianLidarFieldTable_h
#define AvianLidarFieldTable_h

#include "ByteSource.h"
#include "CloudData.h"
#include "OutputFile.h"

namespace avianlidar::formats
{
constexpr std::uint64_t MostFields = 4096; ///< most fields of a table that is read

struct TableField
{
  std::string name;
  Scalar type = Scalar::Float32;
  std::uint64_t count = 1; ///< values
};

/// Contents of a header.
struct FieldTable
{
  std::vector<TableField> fields;
  std::uint64_t points = 0;
  std::uint64_t begin = 0; ///< offset of the rows, bytes
  bool bigEndian = false;

  /// Bytes of a point.
  std::uint64_t length() const;

  /// Throws FormatError unless the file is long enough for the points; called before any
  /// allocation.
  void checkLength(ByteSource& source, bool ascii) const;
};

/// For each field, how its value `index`, of all points in turn, is stored from its little-endian
/// bytes.
using TableTargets = std::vector<std::function<void(std::uint64_t index, const unsigned char*)>>;

/// x, y, z go to the points, others to columns, which are made; "_" is padding. FormatError without
/// x, y and z.
TableTargets targetsOf(const FieldTable& table, Cloud& to);

/// Reads the rows. FormatError: too few, too short or too long, no numbers.
/// @return where they end in the file
std::uint64_t readAsciiRows(ByteSource& source, const FieldTable& table,
  const TableTargets& targets, const KeepGoing& keepGoing);
void readBinaryRows(ByteSource& source, const FieldTable& table, const TableTargets& targets,
  const KeepGoing& keepGoing);

/// Leaves out the points whose coordinates are not finite.
void dropEmptyCells(Cloud& cloud);

/// What is written.
struct TableOutput
{
  /// x, y, z first.
  std::vector<Field> fields;
  /// Index of the point in each row, or -1; empty: rows are points.
  std::vector<std::int64_t> cells;
  /// Value of a field in a cell without a point.
  std::function<double(std::size_t field, std::int64_t cell)> empty;
  std::string comment; ///< one line
  bool ascii = false;
};

void writeRows(
  OutputFile& file, const TableOutput& output, std::uint64_t rows, const KeepGoing& keepGoing);
}

#endif
