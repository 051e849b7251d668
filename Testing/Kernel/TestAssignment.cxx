// SPDX-License-Identifier: BSD-3-Clause
// The best assignment: that of brute force.
#include "Assignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

using namespace avianlidar;

namespace
{
using Rows = std::vector<std::vector<AllowedPair>>;

double leastCost(const Rows& rows, std::size_t row, std::vector<bool>& taken, double without)
{
  if (row == rows.size())
  {
    return 0.0;
  }
  double least = without + leastCost(rows, row + 1, taken, without);
  for (const AllowedPair& pair : rows[row])
  {
    if (!taken[pair.column])
    {
      taken[pair.column] = true;
      least = std::min(least, pair.cost + leastCost(rows, row + 1, taken, without));
      taken[pair.column] = false;
    }
  }
  return least;
}
}

TEST(Assignment, CostsAsLittleAsBruteForce)
{
  std::mt19937_64 random(1);
  const auto below = [&](std::size_t n) { return random() % n; };
  int without = 0;
  for (int run = 0; run < 2000; ++run)
  {
    const std::size_t columns = 1 + below(6);
    Rows rows(1 + below(6));
    const bool ties = run % 4 == 0;
    std::vector<std::vector<double>> costs(rows.size(), std::vector<double>(columns, 1e9));
    for (std::size_t row = 0; row < rows.size(); ++row)
    {
      for (std::size_t column = 0; column < columns; ++column)
      {
        if (below(3) > 0)
        {
          costs[row][column] =
            ties ? static_cast<double>(below(3)) : 1e-3 * static_cast<double>(below(20000)) - 8.0;
          rows[row].push_back({ column, costs[row][column] });
        }
      }
    }
    const double price = ties ? 2.0 : 12.0 - static_cast<double>(below(15));
    const std::vector<std::size_t> found = assign(rows, columns, price);
    double cost = 0.0;
    std::vector<bool> taken(columns, false);
    for (std::size_t row = 0; row < rows.size(); ++row)
    {
      if (found[row] == Unassigned)
      {
        cost += price;
        ++without;
        continue;
      }
      EXPECT_FALSE(taken[found[row]]);
      taken[found[row]] = true;
      cost += costs[row][found[row]];
    }
    std::vector<bool> none(columns, false);
    EXPECT_NEAR(cost, leastCost(rows, 0, none, price), 1e-9) << "run " << run;
  }
  EXPECT_GT(without, 100);
}
