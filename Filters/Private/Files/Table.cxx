// SPDX-License-Identifier: BSD-3-Clause
#include "Table.h"

#include "RegularFile.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace avianlidar
{
namespace
{
std::string trimmed(const std::string& text)
{
  const std::size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos
    ? std::string()
    : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}
}

TableLine::TableLine(const std::string& text, std::string place)
  : Place(std::move(place))
{
  std::istringstream stream(text);
  for (std::string cell; std::getline(stream, cell, ',');)
  {
    this->Cells.push_back(trimmed(cell));
  }
}

double TableLine::number(std::size_t column, const char* name, double least, double most) const
{
  const std::string& cell = this->Cells[column];
  double value = 0.0;
  const auto parsed = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  const bool whole = parsed.ec == std::errc() && parsed.ptr == cell.data() + cell.size();
  if (!whole || !(value >= least && value <= most))
  {
    std::ostringstream message;
    message << name << " is '" << cell << "', expected " << least << " to " << most;
    this->fail(message.str());
  }
  return value;
}

void TableLine::fail(const std::string& message) const
{
  throw std::runtime_error(this->Place + ": " + message);
}

std::string textOfFile(const char* property, const std::string& file)
{
  const std::string name = std::string(property) + " " + file;
  const std::string irregular = whyNotRegular(file);
  if (!irregular.empty())
  {
    throw std::runtime_error(name + ": " + irregular);
  }
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream)
  {
    throw std::runtime_error(name + " cannot be read");
  }
  return text.str();
}

void readTable(const std::string& text, const std::string& file,
  const std::vector<std::string>& headers, const UseLine& use)
{
  std::string expected;
  for (const std::string& header : headers)
  {
    expected += (expected.empty() ? "expected '" : " or '") + header + "'";
  }
  const bool marked = text.compare(0, 3, "\xEF\xBB\xBF") == 0;
  std::istringstream stream(marked ? text.substr(3) : text);
  auto found = headers.end();
  std::size_t columns = 0;
  int number = 0;
  for (std::string line; std::getline(stream, line);)
  {
    ++number;
    line = trimmed(line);
    if (line.empty() || line[0] == '#')
    {
      continue;
    }
    const TableLine cells(line, file + ": line " + std::to_string(number));
    if (found == headers.end())
    {
      found = std::find(headers.begin(), headers.end(), line);
      columns = cells.size();
      if (found == headers.end())
      {
        cells.fail("is not the header, " + expected);
      }
      continue;
    }
    if (cells.size() != columns)
    {
      cells.fail(
        "has " + std::to_string(cells.size()) + " columns, expected " + std::to_string(columns));
    }
    use(cells, static_cast<std::size_t>(found - headers.begin()));
  }
  if (found == headers.end())
  {
    throw std::runtime_error(file + ": holds no header, " + expected);
  }
}
}
