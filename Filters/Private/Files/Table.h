// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Table.h
 * @brief Tables as text: comma-separated values below a header, without quotes.
 *
 * Empty lines and comments, which begin with #, are skipped. Blanks around values are removed.
 *
 * Source: none.
 * Valid: text of any kind. A UTF-8 byte order mark, which spreadsheets write, is skipped.
 * Test: TestBird.cxx (species), TestFlight.cxx (tracks).
 */
#ifndef avianlidar_Table_h
#define avianlidar_Table_h

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace avianlidar
{
/// One line of a table.
class TableLine
{
public:
  /// @param place file and line for messages, such as "own.csv: line 3"
  TableLine(const std::string& text, std::string place);

  std::size_t size() const { return this->Cells.size(); }
  const std::string& text(std::size_t column) const { return this->Cells[column]; }

  /// Number in a column. Throws the error of fail() unless the number is in [least, most].
  /// @param name name of the number, for the message
  double number(std::size_t column, const char* name, double least, double most) const;

  /// Throw std::runtime_error with file and line before the message.
  [[noreturn]] void fail(const std::string& message) const;

private:
  std::string Place;
  std::vector<std::string> Cells;
};

/// Text of a file. Throws std::runtime_error naming the property and the file. @param property name
/// of the property that holds the file's name
std::string textOfFile(const char* property, const std::string& file);

/// Function that receives a line and the index of the table's header among the allowed headers.
using UseLine = std::function<void(const TableLine& line, std::size_t header)>;

/// Call `use` for each line below the header. Each line must have as many columns as the header.
/// Throws std::runtime_error naming file and line.
/// @param file name of the file, for messages @param headers allowed headers
void readTable(const std::string& text, const std::string& file,
  const std::vector<std::string>& headers, const UseLine& use);
}

#endif
