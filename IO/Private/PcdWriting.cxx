// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFormat.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace avianlidar::formats
{
namespace
{
void appendNumber(std::string& text, double value)
{
  char digits[40];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
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

std::string makeHeader(const PcdOutput& output, std::uint64_t cells)
{
  std::string names, sizes, types, counts;
  for (const Field& field : output.fields)
  {
    names += " " + field.name;
    sizes += " " + std::to_string(sizeOf(field.type));
    types += isFloat(field.type) ? " F" : isSigned(field.type) ? " I" : " U";
    counts += " 1";
  }
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
  if (!output.comment.empty())
  {
    text += "# " + output.comment + "\n";
  }
  text += "VERSION 0.7\nFIELDS" + names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts +
    "\nWIDTH " + std::to_string(output.width) + "\nHEIGHT " + std::to_string(output.height) +
    "\nVIEWPOINT";
  for (const double number : output.viewpoint)
  {
    text += " ";
    appendNumber(text, number);
  }
  return text + "\nPOINTS " + std::to_string(cells) + "\nDATA " +
    (output.ascii ? "ascii" : "binary") + "\n";
}
}

void writePcd(OutputFile& file, const PcdOutput& output, const KeepGoing& keepGoing)
{
  const std::uint64_t cells = output.width * output.height;
  file.write(makeHeader(output, cells));
  std::string block;
  unsigned char bytes[8];
  for (std::uint64_t cell = 0; cell < cells; ++cell)
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
    goOn(keepGoing, index, static_cast<std::int64_t>(cells), 0.0, 1.0);
  }
  file.write(block);
}
}
