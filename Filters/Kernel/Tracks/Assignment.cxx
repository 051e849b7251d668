// SPDX-License-Identifier: BSD-3-Clause
#include "Assignment.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

namespace avianlidar
{
namespace
{
class Search
{
public:
  Search(const std::vector<std::vector<AllowedPair>>& rows, std::size_t columns, double costWithout)
    : Rows(rows)
    , Columns(columns)
    , CostWithout(costWithout)
    , RowPrice(rows.size(), 0.0)
    , ColumnPrice(columns + rows.size(), 0.0)
    , RowOf(columns + rows.size(), Unassigned)
    , ColumnOf(rows.size(), Unassigned)
    , Distance(columns + rows.size(), std::numeric_limits<double>::infinity())
    , From(columns + rows.size(), Unassigned)
  {
  }

  /// Assigns a column to the row, and other columns to other rows where that costs less.
  void add(std::size_t row)
  {
    // This price leaves no reduced cost of the row below 0.
    double& least = this->RowPrice[row];
    least = std::numeric_limits<double>::infinity();
    this->forEach(row,
      [&](std::size_t column, double cost)
      { least = std::min(least, cost - this->ColumnPrice[column]); });
    std::size_t at = row;
    std::size_t end = Unassigned;
    double walked = 0.0;
    std::vector<std::size_t> scanned;
    for (;;)
    {
      this->forEach(at,
        [&](std::size_t column, double cost)
        {
          // Rounding must not make a path shorter than the paths scanned before.
          const double distance =
            walked + std::max(0.0, cost - this->RowPrice[at] - this->ColumnPrice[column]);
          if (distance < this->Distance[column])
          {
            this->Distance[column] = distance;
            this->From[column] = at;
            this->Reached.push_back(column);
            this->Next.emplace(distance, column);
          }
        });
      while (this->Next.top().first > this->Distance[this->Next.top().second])
      {
        this->Next.pop(); // replaced by a shorter path
      }
      std::tie(walked, end) = this->Next.top();
      this->Next.pop();
      at = this->RowOf[end];
      if (at == Unassigned)
      {
        break;
      }
      scanned.push_back(end);
    }
    this->RowPrice[row] += walked;
    for (const std::size_t column : scanned)
    {
      this->RowPrice[this->RowOf[column]] += walked - this->Distance[column];
      this->ColumnPrice[column] -= walked - this->Distance[column];
    }
    while (end != Unassigned)
    {
      const std::size_t owner = this->From[end];
      this->RowOf[end] = owner;
      std::swap(end, this->ColumnOf[owner]);
    }
    this->forget();
  }

  std::vector<std::size_t> result() const
  {
    std::vector<std::size_t> columns = this->ColumnOf;
    for (std::size_t& column : columns)
    {
      column = column < this->Columns ? column : Unassigned;
    }
    return columns;
  }

private:
  template <class Work>
  void forEach(std::size_t row, Work work) const
  {
    for (const AllowedPair& pair : this->Rows[row])
    {
      work(pair.column, pair.cost);
    }
    work(this->Columns + row, this->CostWithout); // the row's own column: unassigned
  }

  void forget()
  {
    for (const std::size_t column : this->Reached)
    {
      this->Distance[column] = std::numeric_limits<double>::infinity();
    }
    this->Reached.clear();
    this->Next = {};
  }

  const std::vector<std::vector<AllowedPair>>& Rows;
  std::size_t Columns;
  double CostWithout;
  std::vector<double> RowPrice;
  std::vector<double> ColumnPrice;
  std::vector<std::size_t> RowOf;
  std::vector<std::size_t> ColumnOf;
  std::vector<double> Distance; ///< length of the shortest path found so far
  std::vector<std::size_t> From;
  std::vector<std::size_t> Reached;
  using Step = std::pair<double, std::size_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<Step>> Next;
};
}

std::vector<std::size_t> assign(
  const std::vector<std::vector<AllowedPair>>& rows, std::size_t columns, double costWithout)
{
  Search search(rows, columns, costWithout);
  for (std::size_t row = 0; row < rows.size(); ++row)
  {
    search.add(row);
  }
  return search.result();
}
}
