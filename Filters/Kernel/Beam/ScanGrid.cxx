// SPDX-License-Identifier: BSD-3-Clause
#include "ScanGrid.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace avianlidar
{
namespace
{
/// The distinct values, ascending. Each distinct value stands for all values that lie less than the
/// tolerance above it.
std::vector<double> distinct(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  std::vector<double> kept;
  for (double value : values)
  {
    if (kept.empty() || value - kept.back() > GridTolerance)
    {
      kept.push_back(value);
    }
  }
  return kept;
}

/// Index of the distinct value that stands for `value`.
int indexOf(const std::vector<double>& kept, double value)
{
  return static_cast<int>(std::upper_bound(kept.begin(), kept.end(), value) - kept.begin()) - 1;
}

/// Angle in [0, 360), deg. An angle that is all but a full turn becomes 0.
double wrapped(double degrees)
{
  double turned = std::fmod(degrees, 360.0);
  turned = turned < 0.0 ? turned + 360.0 : turned;
  return turned > 360.0 - GridTolerance ? 0.0 : turned;
}

/// Index of the first column of a sector: the column behind the widest gap, or column 0 if no gap
/// is clearly wider than the others.
std::size_t firstColumn(const std::vector<double>& azimuths)
{
  std::vector<double> gaps(azimuths.size()); // gap before each column
  for (std::size_t i = 0; i < azimuths.size(); ++i)
  {
    gaps[i] = i > 0 ? azimuths[i] - azimuths[i - 1] : azimuths[0] + 360.0 - azimuths.back();
  }
  const std::size_t widest =
    static_cast<std::size_t>(std::max_element(gaps.begin(), gaps.end()) - gaps.begin());
  std::vector<double> sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  return gaps[widest] > 1.5 * sorted[sorted.size() / 2] ? widest : 0;
}

ScanGrid gridByAngle(const std::vector<double>& azimuths, const std::vector<double>& elevations)
{
  std::vector<double> turned(azimuths.size());
  std::transform(azimuths.begin(), azimuths.end(), turned.begin(), wrapped);
  std::vector<double> columns = distinct(turned);
  ScanGrid grid;
  grid.elevations = distinct(elevations);
  if (columns.size() * grid.elevations.size() > 2 * azimuths.size())
  {
    return ScanGrid();
  }
  const std::size_t first = firstColumn(columns);
  const int count = static_cast<int>(columns.size());
  for (std::size_t i = 0; i < azimuths.size(); ++i)
  {
    grid.column.push_back((indexOf(columns, turned[i]) - static_cast<int>(first) + count) % count);
    grid.row.push_back(indexOf(grid.elevations, elevations[i]));
  }
  // A sector across north: 350, 10 becomes -10, 10.
  std::transform(columns.begin() + first, columns.end(), columns.begin() + first,
    [first](double azimuth) { return first > 0 ? azimuth - 360.0 : azimuth; });
  std::rotate(columns.begin(), columns.begin() + first, columns.end());
  grid.azimuths = columns;
  return grid;
}

ScanGrid gridByChannel(const std::vector<double>& azimuths, const std::vector<double>& elevations,
  const std::vector<int>& channels)
{
  struct Row
  {
    std::vector<std::size_t> beams;
    double sum = 0.0;
  };
  std::map<int, Row> rows;
  for (std::size_t i = 0; i < channels.size(); ++i)
  {
    rows[channels[i]].beams.push_back(i);
    rows[channels[i]].sum += elevations[i];
  }
  const std::size_t columns = rows.empty() ? 0 : rows.begin()->second.beams.size();
  std::vector<const Row*> sorted;
  for (const auto& row : rows)
  {
    if (row.second.beams.size() != columns)
    {
      return ScanGrid();
    }
    sorted.push_back(&row.second);
  }
  std::stable_sort(
    sorted.begin(), sorted.end(), [](const Row* a, const Row* b) { return a->sum < b->sum; });
  ScanGrid grid;
  grid.byChannel = true;
  grid.column.resize(channels.size());
  grid.row.resize(channels.size());
  for (std::size_t r = 0; r < sorted.size(); ++r)
  {
    grid.elevations.push_back(sorted[r]->sum / static_cast<double>(columns));
    for (std::size_t c = 0; c < columns; ++c)
    {
      grid.column[sorted[r]->beams[c]] = static_cast<int>(c);
      grid.row[sorted[r]->beams[c]] = static_cast<int>(r);
    }
  }
  for (std::size_t c = 0; c < columns; ++c)
  {
    grid.azimuths.push_back(azimuths[sorted[0]->beams[c]]);
  }
  return grid;
}
}

ScanGrid makeScanGrid(const std::vector<double>& azimuths, const std::vector<double>& elevations,
  const std::vector<int>& channels, bool byChannel)
{
  if (azimuths.empty() || azimuths.size() != elevations.size())
  {
    return ScanGrid();
  }
  ScanGrid grid = byChannel ? ScanGrid() : gridByAngle(azimuths, elevations);
  if (grid.empty() && channels.size() == azimuths.size())
  {
    grid = gridByChannel(azimuths, elevations, channels);
  }
  return grid;
}

bool equallySpaced(const std::vector<double>& values, double& origin, double& spacing)
{
  if (values.empty())
  {
    return false;
  }
  origin = values.front();
  spacing = values.size() > 1
    ? (values.back() - values.front()) / static_cast<double>(values.size() - 1)
    : 1.0;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (!(std::abs(values[i] - (origin + static_cast<double>(i) * spacing)) <= 1e-3 * spacing))
    {
      return false;
    }
  }
  return spacing > 0.0;
}
}
