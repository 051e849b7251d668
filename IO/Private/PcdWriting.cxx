// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFormat.h"

#include <charconv>

namespace avianlidar::formats
{
namespace
{
void appendNumber(std::string& text, double value)
{
  char digits[40];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
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
  writeRows(file, output, cells, keepGoing);
}
}
