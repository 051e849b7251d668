// SPDX-License-Identifier: BSD-3-Clause
#include "ClutterMap.h"

#include "KeySort.h"
#include "ValueError.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace avianlidar
{
namespace
{
// Bits of a key: azimuth above elevation above range.
constexpr int RangeBits = 26;
constexpr int ElevationBits = 18;
// Ranges begin at Margin, so that neighbours below the first range have keys of their own.
constexpr int Margin = ClutterMap::MostTolerance;
constexpr int LowestElevation = (1 << (ElevationBits - 1));

bool within(double value, double low, double high)
{
  return value >= low && value <= high;
}

std::vector<ClutterMap::Key> distinct(std::vector<ClutterMap::Key> keys)
{
  sortKeys(keys);
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  return keys;
}

/// First index from `from` on whose key is not less than `key`. A near key takes few steps.
std::size_t gallop(const std::vector<ClutterMap::Key>& keys, std::size_t from, ClutterMap::Key key)
{
  std::size_t step = 1;
  std::size_t low = from;
  while (low + step < keys.size() && keys[low + step] < key)
  {
    low += step;
    step *= 2;
  }
  const std::size_t high = std::min(keys.size(), low + step + 1);
  const auto begin = keys.begin();
  return static_cast<std::size_t>(std::lower_bound(begin + static_cast<std::ptrdiff_t>(low),
                                    begin + static_cast<std::ptrdiff_t>(high), key) -
    begin);
}
}

//------------------------------------------------------------------------------
int ClutterGrid::columns() const
{
  return static_cast<int>(std::lround(360.0 / this->azimuthStep));
}

//------------------------------------------------------------------------------
ClutterMap::ClutterMap(const ClutterGrid& grid, double window)
  : Grid(grid)
  , Window(window)
{
}

//------------------------------------------------------------------------------
std::string ClutterMap::check(const ClutterGrid& grid, double window)
{
  if (!within(grid.rangeStep, 0.001, 1000.0))
  {
    return valueError("RangeStep", grid.rangeStep, "0.001 to 1000 m");
  }
  if (!within(grid.azimuthStep, 0.001, 90.0))
  {
    return valueError("AzimuthStep", grid.azimuthStep, "0.001 to 90 degrees");
  }
  if (!within(grid.elevationStep, 0.001, 90.0))
  {
    return valueError("ElevationStep", grid.elevationStep, "0.001 to 90 degrees");
  }
  if (!within(window, 1.0, LongestWindow))
  {
    return valueError("Window", window, "1 to 100,000 scans");
  }
  return {};
}

//------------------------------------------------------------------------------
ClutterMap::Key ClutterMap::keyOf(const ClutterGrid& grid, const Vec3& offset)
{
  const int columns = grid.columns();
  const double azimuth = std::atan2(offset.x, offset.y) / (2.0 * Pi) * columns;
  const double elevation =
    std::atan2(offset.z, std::hypot(offset.x, offset.y)) * DegreesPerRadian / grid.elevationStep;
  const double range = std::floor(safeLength(offset) / grid.rangeStep);
  ClutterCell cell;
  cell.azimuth = static_cast<int>(std::lround(azimuth) + columns) % columns;
  cell.elevation = static_cast<int>(std::lround(elevation));
  cell.range = static_cast<int>(std::min(range, static_cast<double>(MostRanges - 1)));
  return keyOf(cell);
}

//------------------------------------------------------------------------------
ClutterMap::Key ClutterMap::keyOf(const ClutterCell& cell)
{
  const auto azimuth = static_cast<Key>(cell.azimuth);
  const auto elevation = static_cast<Key>(cell.elevation + LowestElevation);
  const auto range = static_cast<Key>(cell.range + Margin);
  return (azimuth << ElevationBits | elevation) << RangeBits | range;
}

//------------------------------------------------------------------------------
ClutterCell ClutterMap::cellOf(Key key)
{
  ClutterCell cell;
  cell.range = static_cast<int>(key & ((Key(1) << RangeBits) - 1)) - Margin;
  key >>= RangeBits;
  cell.elevation = static_cast<int>(key & ((Key(1) << ElevationBits) - 1)) - LowestElevation;
  cell.azimuth = static_cast<int>(key >> ElevationBits);
  return cell;
}

//------------------------------------------------------------------------------
bool ClutterMap::holds(const ClutterGrid& grid, const ClutterCell& cell)
{
  const auto rows = std::lround(90.0 / grid.elevationStep);
  return cell.azimuth >= 0 && cell.azimuth < grid.columns() && std::abs(cell.elevation) <= rows &&
    cell.range >= 0 && cell.range < MostRanges;
}

//------------------------------------------------------------------------------
std::vector<Vec3> ClutterMap::middles() const
{
  // Sine and cosine of each elevation that occurs, found once.
  const int rows = static_cast<int>(std::lround(90.0 / this->Grid.elevationStep));
  constexpr double Unknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::pair<double, double>> elevations(
    static_cast<std::size_t>(2 * rows + 1), { Unknown, Unknown });
  std::vector<Vec3> found;
  found.reserve(this->Keys.size());
  int column = -1;
  double east = 0.0;
  double north = 0.0;
  for (const Key key : this->Keys)
  {
    const ClutterCell cell = cellOf(key);
    if (cell.azimuth != column) // cells are sorted by azimuth
    {
      const double azimuth = 2.0 * Pi * cell.azimuth / this->Grid.columns();
      column = cell.azimuth;
      east = std::sin(azimuth);
      north = std::cos(azimuth);
    }
    auto& [rise, level] = elevations[static_cast<std::size_t>(cell.elevation + rows)];
    if (std::isnan(rise))
    {
      const double elevation = cell.elevation * this->Grid.elevationStep * RadiansPerDegree;
      rise = std::sin(elevation);
      level = std::cos(elevation);
    }
    const double range = (cell.range + 0.5) * this->Grid.rangeStep;
    const double across = range * level;
    found.push_back({ across * east, across * north, range * rise });
  }
  return found;
}

//------------------------------------------------------------------------------
double ClutterMap::persistenceKept() const
{
  return 0.5 / std::max(this->Window, 500.0);
}

//------------------------------------------------------------------------------
void ClutterMap::setScans(int scans)
{
  this->Scans = scans;
  this->Total = -this->Window * std::expm1(scans * std::log1p(-1.0 / this->Window));
}

//------------------------------------------------------------------------------
double ClutterMap::shareOf(double sum) const
{
  return sum > 0.0 ? std::min(1.0, sum / this->Total) : 0.0; // rounding may leave more than 1
}

//------------------------------------------------------------------------------
ClutterMap ClutterMap::learned(std::vector<Key> points) const
{
  const std::vector<Key> scan = distinct(std::move(points));
  ClutterMap result(this->Grid, this->Window);
  result.setScans(std::min(this->Scans, std::numeric_limits<int>::max() - 1) + 1);
  result.Keys.reserve(this->Keys.size() + scan.size());
  result.Sums.reserve(this->Keys.size() + scan.size());
  const double weight = 1.0 - 1.0 / this->Window;
  const double least = this->persistenceKept() * result.Total;
  std::size_t old = 0;
  std::size_t fresh = 0;
  while (old < this->Keys.size() || fresh < scan.size())
  {
    const bool isOld =
      old < this->Keys.size() && (fresh == scan.size() || this->Keys[old] <= scan[fresh]);
    const Key key = isOld ? this->Keys[old] : scan[fresh];
    double sum = isOld ? this->Sums[old++] * weight : 0.0;
    if (fresh < scan.size() && scan[fresh] == key)
    {
      sum += 1.0;
      ++fresh;
    }
    if (sum >= least)
    {
      result.Keys.push_back(key);
      result.Sums.push_back(sum);
    }
  }
  return result;
}

//------------------------------------------------------------------------------
ClutterMap ClutterMap::restored(
  const std::vector<Key>& cells, const std::vector<double>& persistences, int scans) const
{
  ClutterMap result(this->Grid, this->Window);
  result.setScans(scans);
  std::vector<std::pair<Key, double>> both(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
  {
    both[i] = { cells[i], persistences[i] * result.Total };
  }
  std::sort(both.begin(), both.end());
  for (const auto& [key, sum] : both)
  {
    if (!result.Keys.empty() && result.Keys.back() == key)
    {
      result.Sums.back() = sum; // pairs are sorted: this sum is the largest
      continue;
    }
    result.Keys.push_back(key);
    result.Sums.push_back(sum);
  }
  return result;
}

//------------------------------------------------------------------------------
std::vector<double> ClutterMap::probabilities(
  const std::vector<Key>& points, int rangeTolerance, int angularTolerance) const
{
  const std::vector<Key> scan = distinct(points);
  std::vector<double> largest(scan.size(), 0.0);
  const int columns = this->Grid.columns();
  // On a coarse circle the neighbours of both sides meet.
  const int sides = std::min(angularTolerance, columns / 2);
  std::vector<std::pair<int, int>> rows; // of neighbours, the nearest first
  for (int turn = -sides; turn <= sides; ++turn)
  {
    for (int rise = -angularTolerance; rise <= angularTolerance; ++rise)
    {
      rows.emplace_back(turn, rise);
    }
  }
  std::stable_sort(rows.begin(), rows.end(),
    [](const auto& a, const auto& b)
    { return std::abs(a.first) + std::abs(a.second) < std::abs(b.first) + std::abs(b.second); });
  const auto column = [](int azimuth)
  { return static_cast<Key>(azimuth) << (ElevationBits + RangeBits); }; // modulo 2^64 if below zero
  for (const auto& [turn, rise] : rows)
  {
    const Key step =
      column(turn) + (static_cast<Key>(rise) << RangeBits) - static_cast<Key>(rangeTolerance);
    std::size_t place = 0;
    Key before = 0;
    for (std::size_t i = 0; i < scan.size(); ++i)
    {
      if (largest[i] >= this->Total) // nothing is larger
      {
        continue;
      }
      Key first = scan[i] + step;
      if (turn < 0 && scan[i] < column(-turn))
      {
        first += column(columns);
      }
      else if (turn > 0 && scan[i] >= column(columns - turn))
      {
        first -= column(columns);
      }
      place = gallop(this->Keys, first < before ? 0 : place, first);
      before = first;
      const Key last = first + static_cast<Key>(2 * rangeTolerance);
      for (std::size_t k = place; k < this->Keys.size() && this->Keys[k] <= last; ++k)
      {
        largest[i] = std::max(largest[i], this->Sums[k]);
      }
    }
  }
  for (double& sum : largest)
  {
    sum = this->shareOf(sum);
  }
  std::vector<double> result(points.size());
  std::size_t at = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const bool isAhead = at < scan.size() && scan[at] <= points[i]; // often near the point before
    at = gallop(scan, isAhead ? at : 0, points[i]);
    result[i] = largest[at];
  }
  return result;
}
}
