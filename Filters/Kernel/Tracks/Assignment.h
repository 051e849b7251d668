// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Assignment.h
 * @brief One-to-one assignment of least cost, where only some pairs are allowed, and a row may be
 * left without a column at a cost.
 *
 * Rows are added one by one. Each row takes the shortest augmenting path that ends at a free column
 * or leaves a row unassigned (R. Jonker and A. Volgenant, "A shortest augmenting path algorithm for
 * dense and sparse linear assignment problems", Computing 38, 1987). The path uses only rows and
 * columns that allowed pairs connect to this row.
 *
 * Source: Jonker and Volgenant, as above.
 * Differs: Dijkstra's algorithm with a heap serves every row. Columns are not reduced first.
 * Valid: finite costs of any sign. The order of the input decides among several best assignments.
 * Test: TestTracker.py against SciPy.
 */
#ifndef avianlidar_Assignment_h
#define avianlidar_Assignment_h

#include <cstddef>
#include <vector>

namespace avianlidar
{
struct AllowedPair
{
  std::size_t column;
  double cost;
};

constexpr std::size_t Unassigned = static_cast<std::size_t>(-1);

/// Returns the column of each row, or Unassigned. @param rows allowed pairs of each row
/// @param costWithout cost of a row without a column
std::vector<std::size_t> assign(
  const std::vector<std::vector<AllowedPair>>& rows, std::size_t columns, double costWithout);
}

#endif
