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
/// Converts a word of ASCII data to bytes of the type. 64-bit integers are not converted by way of
/// double, because times in nanoseconds have more digits than a double.
void wordToBytes(const std::string& word, Scalar type, unsigned char* bytes)
{
  const auto withSign = type == Scalar::Int64 ? parsed<std::int64_t>(word) : std::nullopt;
  const auto without = type == Scalar::UInt64 ? parsed<std::uint64_t>(word) : std::nullopt;
  if (withSign)
  {
    store(*withSign, bytes);
  }
  else if (without)
  {
    store(*without, bytes);
  }
  else
  {
    storeAs(type, numberOf<double>(word, "a line of the data"), bytes);
  }
}

/// Appends the fewest digits from which the same value of the type can be read.
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

std::uint64_t readAsciiRows(ByteSource& source, const FieldTable& table,
  const TableTargets& targets, const KeepGoing& keepGoing)
{
  TextLines lines(source, table.begin);
  std::string line;
  unsigned char bytes[8];
  for (std::uint64_t i = 0; i < table.points; ++i)
  {
    do
    {
      failIf(!lines.get(line), "it is cut short: it says that it has ", table.points,
        " points, and has ", i);
    } while (line.find_first_not_of(" \t") == std::string::npos);
    std::istringstream words(line);
    std::string word;
    for (std::size_t f = 0; f < table.fields.size(); ++f)
    {
      for (std::uint64_t c = 0; c < table.fields[f].count; ++c)
      {
        failIf(!(words >> word), "point ", i, " has too few values");
        wordToBytes(word, table.fields[f].type, bytes);
        targets[f](i * table.fields[f].count + c, bytes);
      }
    }
    failIf(bool(words >> word), "point ", i, " has too many values");
    goOn(keepGoing, i, table.points);
  }
  return lines.position();
}

std::uint64_t readBinaryRows(ByteSource& source, const FieldTable& table,
  const TableTargets& targets, const KeepGoing& keepGoing)
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
          targets[f](i * table.fields[f].count + c, table.bigEndian ? turned : bytes);
          bytes += size;
        }
      }
      goOn(keepGoing, i, table.points);
    });
  return table.begin + table.length() * table.points;
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

void FieldTable::checkLength(ByteSource& source) const
{
  std::uint64_t room = source.size() - this->begin;
  std::uint64_t least = this->length();
  if (this->ascii)
  {
    // Every value has a digit and a separator, and only the last separator may be missing.
    room += 1;
    least = 0;
    for (const TableField& field : this->fields)
    {
      least += 2 * field.count;
    }
  }
  failIf(this->points > room / least, "it is cut short: it says that it has ", this->points,
    " points, and has room for ", room / least);
}

TableTargets targetsOf(const FieldTable& table, Cloud& to)
{
  TableTargets targets;
  int found = 0;
  to.points.resize(3 * table.points);
  for (const TableField& field : table.fields)
  {
    const std::size_t axis =
      field.name.size() == 1 && field.count == 1 ? std::string("xyz").find(field.name) : 3;
    if (axis < 3)
    {
      found |= 1 << axis;
      targets.emplace_back(
        [type = field.type, points = to.points.data(), axis](std::uint64_t i,
          const unsigned char* bytes) { points[3 * i + axis] = loadAs(type, bytes); });
    }
    else if (field.name == "_")
    {
      targets.emplace_back([](std::uint64_t, const unsigned char*) {});
    }
    else
    {
      withType(field.type,
        [&](auto kind)
        {
          using T = decltype(kind);
          to.columns.push_back({ field.name, "", static_cast<int>(field.count),
            std::vector<T>(table.points * field.count) });
          T* values = std::get<std::vector<T>>(to.columns.back().values).data();
          targets.emplace_back(
            [values](std::uint64_t i, const unsigned char* bytes) { values[i] = load<T>(bytes); });
        });
    }
  }
  failIf(found != 7, "it has no fields x, y and z");
  return targets;
}

std::uint64_t readRows(ByteSource& source, const FieldTable& table, const TableTargets& targets,
  const KeepGoing& keepGoing)
{
  return table.ascii ? readAsciiRows(source, table, targets, keepGoing)
                     : readBinaryRows(source, table, targets, keepGoing);
}

void addComments(const FieldTable& table, Cloud& cloud)
{
  for (const std::string& comment : table.comments)
  {
    cloud.notes.push_back({ "comment", "", {}, { comment } });
  }
}

void keepPoints(Cloud& cloud, const std::vector<std::size_t>& kept)
{
  const auto keep = [&kept](auto& values, std::size_t components)
  {
    std::size_t end = 0;
    for (const std::size_t i : kept)
    {
      for (std::size_t c = 0; c < components; ++c)
      {
        values[end++] = values[i * components + c];
      }
    }
    values.resize(end);
  };
  keep(cloud.points, 3);
  for (Column& column : cloud.columns)
  {
    std::visit([&](auto& values) { keep(values, column.components); }, column.values);
  }
}

void dropEmptyCells(Cloud& cloud, bool hasEmptyCells)
{
  std::vector<std::size_t> kept;
  std::size_t empty = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    const double* p = cloud.points.data() + 3 * i;
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]))
    {
      kept.push_back(i);
    }
    empty += hasEmptyCells && std::isnan(p[0]) && std::isnan(p[1]) && std::isnan(p[2]);
  }
  if (kept.size() == cloud.size())
  {
    return;
  }
  if (const std::size_t lost = cloud.size() - kept.size() - empty; lost > 0)
  {
    cloud.warnings.push_back(
      std::to_string(lost) + " points whose coordinates are not finite are left out");
  }
  keepPoints(cloud, kept);
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
    goOn(keepGoing, cell, rows);
  }
  file.write(block);
}
}
