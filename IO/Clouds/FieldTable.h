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
constexpr std::uint64_t MostFields = 4096; ///< largest number of fields of a table that is read

struct TableField
{
  std::string name;
  Scalar type = Scalar::Float32;
  std::uint64_t count = 1; ///< number of values
};

/// Fields and points that a header declares.
struct FieldTable
{
  std::vector<TableField> fields;
  std::uint64_t points = 0;
  std::uint64_t begin = 0; ///< offset of the rows, bytes
  bool ascii = false;
  bool bigEndian = false;
  std::vector<std::string> comments;

  /// Returns the size of a point in binary rows, bytes.
  std::uint64_t length() const;

  /// Throws FormatError unless the file is long enough for the points. Must be called before memory
  /// for the points is allocated.
  void checkLength(ByteSource& source) const;
};

/// For each field, a function that stores one value from its little-endian bytes. `index` counts
/// the values of the field over all points.
using TableTargets = std::vector<std::function<void(std::uint64_t index, const unsigned char*)>>;

/// Makes the points and columns of a cloud, and the functions that store x, y and z in the points
/// and all other fields in columns. The field "_" is padding. Throws FormatError if x, y or z is
/// missing.
TableTargets targetsOf(const FieldTable& table, Cloud& to);

/// Reads the rows, text or binary. Throws FormatError if rows are missing, or if a row of text is
/// too short or too long or has a word that is not a number.
/// @return offset of the end of the rows in the file, bytes
std::uint64_t readRows(ByteSource& source, const FieldTable& table, const TableTargets& targets,
  const KeepGoing& keepGoing);

/// Keeps only the points of the given indices, which must ascend.
void keepPoints(Cloud& cloud, const std::vector<std::size_t>& kept);

/// Leaves out the points whose coordinates are not finite, with a warning of their number.
/// @param hasEmptyCells whether points of three NaN are cells of a grid, which give no warning
void dropEmptyCells(Cloud& cloud, bool hasEmptyCells = false);

/// Adds the comments of a file to the notes of its cloud.
void addComments(const FieldTable& table, Cloud& cloud);

/// Rows to be written.
struct TableOutput
{
  /// Fields of a row, first x, y, z.
  std::vector<Field> fields;
  /// Index of the point in each row, or -1 in a row without a point. Empty if row i is point i.
  std::vector<std::int64_t> cells;
  /// Function that gives the value of a field in a cell without a point.
  std::function<double(std::size_t field, std::int64_t cell)> empty;
  std::string comment; ///< comment of one line
  bool ascii = false;
};

void writeRows(
  OutputFile& file, const TableOutput& output, std::uint64_t rows, const KeepGoing& keepGoing);
}

#endif
