// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Assignment.h
 * @brief One-to-one assignment of least cost, where only some pairs are allowed and each row may go
 * without a column at a price.
 *
 * Rows come one after the other. Each takes the shortest augmenting path to a column that is free,
 * or to going without (R. Jonker and A. Volgenant, "A shortest augmenting path algorithm for dense
 * and sparse linear assignment problems", Computing 38, 1987). A path does not leave the rows and
 * columns that allowed pairs connect with its own.
 *
 * Source: see above.
 * Differs: Dijkstra's algorithm with a heap from the first row on; no initial reduction of columns.
 * Valid: finite costs of any sign. Of several best assignments the same one for the same order.
 * Test: TestAssignment.cxx against brute force, TestTracker.py against SciPy.
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

/// The column of each row, or Unassigned. @param rows the allowed pairs of each
std::vector<std::size_t> assign(
  const std::vector<std::vector<AllowedPair>>& rows, std::size_t columns, double costWithout);
}

#endif
