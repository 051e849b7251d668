// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Table.h
 * @brief Tables as text: comma-separated values below a header, without quotes.
 *
 * Empty lines are skipped, and comments, which begin with #. Blanks around values do not count.
 *
 * Source: none.
 * Valid: text of any kind; a mark of UTF-8 at its beginning, as spreadsheets write it, is skipped.
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
  /// @param place "own.csv: line 3", for messages
  TableLine(const std::string& text, std::string place);

  std::size_t size() const { return this->Cells.size(); }
  const std::string& text(std::size_t column) const { return this->Cells[column]; }

  /// The number of a column; an error unless it lies between least and most. @param name for the
  /// message
  double number(std::size_t column, const char* name, double least, double most) const;

  /// Throws std::runtime_error with file and line before the message.
  [[noreturn]] void fail(const std::string& message) const;

private:
  std::string Place;
  std::vector<std::string> Cells;
};

/// Called with a line and the index of the table's header.
using UseLine = std::function<void(const TableLine& line, std::size_t header)>;

/// Call `use` for each line below the header; each has as many columns as the header. Throws
/// std::runtime_error naming file and line.
/// @param file for messages @param headers those that are allowed
void readTable(const std::string& text, const std::string& file,
  const std::vector<std::string>& headers, const UseLine& use);
}

#endif
