// SPDX-License-Identifier: BSD-3-Clause
#include "FieldTable.h"
#include "TextLines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

namespace avianlidar::formats
{
namespace
{
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

/// The shortest digits that give the same value of the type back.
void appendValue(std::string& text, Scalar type, double value)
{
  if (std::isnan(value) && isFloat(type))
  {
    text += "nan";
    return;
  }
  char digits[40];
  const double stored = nearest(type, value);
  const auto end = type == Scalar::Float32
    ? std::to_chars(digits, digits + sizeof digits, static_cast<float>(stored))
    : type == Scalar::Float64
    ? std::to_chars(digits, digits + sizeof digits, stored)
    : std::to_chars(digits, digits + sizeof digits, static_cast<std::int64_t>(stored));
  text.append(digits, end.ptr);
}
}

std::uint64_t FieldTable::length() const
{
  std::uint64_t bytes = 0;
  for (const TableField& field : this->fields)
  {
    bytes += sizeOf(field.type) * field.count;
  }
  return bytes;
}

void FieldTable::checkLength(ByteSource& source, bool ascii) const
{
  std::uint64_t room = source.size() - this->begin;
  std::uint64_t least = this->length();
  if (ascii)
  {
    // Every value has a digit and something behind it, but the last.
    room += 1;
    least = 0;
    for (const TableField& field : this->fields)
    {
      least += 2 * field.count;
    }
  }
  if (this->points > room / least)
  {
    throw FormatError("it is cut short: it says that it has " + std::to_string(this->points) +
      " points, and has room for " + std::to_string(room / least));
  }
}

TableColumns::TableColumns(const FieldTable& table, Cloud& to)
  : Table(table)
  , To(to)
{
  int found = 0;
  for (const TableField& field : table.fields)
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
        makeValues(field.type, table.points * field.count) });
    }
    this->Targets.push_back(target);
  }
  if (found != 7)
  {
    throw FormatError("it has no fields x, y and z");
  }
  to.points.resize(3 * table.points);
}

void TableColumns::take(std::size_t f, std::uint64_t i, std::uint64_t c, const unsigned char* bytes)
{
  const Target& target = this->Targets[f];
  if (target.axis >= 0)
  {
    this->To.points[3 * i + target.axis] = loadAs(this->Table.fields[f].type, bytes);
  }
  else if (target.column >= 0)
  {
    setFromBytes(
      this->To.columns[target.column].values, i * this->Table.fields[f].count + c, bytes);
  }
}

std::uint64_t readAsciiRows(
  ByteSource& source, const FieldTable& table, TableColumns& columns, const KeepGoing& keepGoing)
{
  TextLines lines(source, table.begin);
  std::string line;
  unsigned char bytes[8];
  for (std::uint64_t i = 0; i < table.points; ++i)
  {
    do
    {
      if (!lines.get(line))
      {
        throw FormatError("it is cut short: it says that it has " + std::to_string(table.points) +
          " points, and has " + std::to_string(i));
      }
    } while (line.find_first_not_of(" \t") == std::string::npos);
    std::istringstream words(line);
    std::string word;
    for (std::size_t f = 0; f < table.fields.size(); ++f)
    {
      for (std::uint64_t c = 0; c < table.fields[f].count; ++c)
      {
        if (!(words >> word))
        {
          throw FormatError("point " + std::to_string(i) + " has too few values");
        }
        wordToBytes(word, table.fields[f].type, bytes);
        columns.take(f, i, c, bytes);
      }
    }
    if (words >> word)
    {
      throw FormatError("point " + std::to_string(i) + " has too many values");
    }
    goOn(keepGoing, static_cast<std::int64_t>(i), static_cast<std::int64_t>(table.points), 0, 1);
  }
  return lines.position();
}

void readBinaryRows(
  ByteSource& source, const FieldTable& table, TableColumns& columns, const KeepGoing& keepGoing)
{
  unsigned char turned[8];
  forEachRecord(source, table.begin, table.length(), table.points,
    [&](std::uint64_t i, const unsigned char* bytes)
    {
      for (std::size_t f = 0; f < table.fields.size(); ++f)
      {
        const std::size_t size = sizeOf(table.fields[f].type);
        for (std::uint64_t c = 0; c < table.fields[f].count; ++c)
        {
          if (table.bigEndian)
          {
            std::reverse_copy(bytes, bytes + size, turned);
          }
          columns.take(f, i, c, table.bigEndian ? turned : bytes);
          bytes += size;
        }
      }
      goOn(keepGoing, static_cast<std::int64_t>(i), static_cast<std::int64_t>(table.points), 0, 1);
    });
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

void writeRows(
  OutputFile& file, const TableOutput& output, std::uint64_t rows, const KeepGoing& keepGoing)
{
  std::string block;
  unsigned char bytes[8];
  for (std::uint64_t cell = 0; cell < rows; ++cell)
  {
    const auto index = static_cast<std::int64_t>(cell);
    const std::int64_t point = output.cells.empty() ? index : output.cells[cell];
    for (std::size_t f = 0; f < output.fields.size(); ++f)
    {
      const Field& field = output.fields[f];
      const double value = point >= 0 ? field.value(point) : output.empty(f, index);
      if (output.ascii)
      {
        appendValue(block, field.type, value);
        block += f + 1 < output.fields.size() ? ' ' : '\n';
      }
      else
      {
        storeAs(field.type, value, bytes);
        block.append(reinterpret_cast<char*>(bytes), sizeOf(field.type));
      }
    }
    if (index % PointsPerBlock == PointsPerBlock - 1)
    {
      file.write(block);
      block.clear();
    }
    goOn(keepGoing, index, static_cast<std::int64_t>(rows), 0.0, 1.0);
  }
  file.write(block);
}
}
