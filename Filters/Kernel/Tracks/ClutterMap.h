// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ClutterMap.h
 * @brief Where a sensor that stands still has echoes again and again: persistence of cells of
 * azimuth, elevation and range.
 *
 * With W the window and n the scans learned, each scan weighs q = 1 - 1/W as much as the next one.
 * Persistence of a cell: sum of the weights of the scans in which it held an echo, over the sum of
 * all n weights, W (1 - q^n). Cells below persistenceKept() are forgotten.
 *
 * A sorted list of cells: a scan is sorted and merged with it, and a scan that asks for its
 * probabilities walks along it once for each row of neighbours, so that both take about
 * n log n + m steps for n points and m cells.
 *
 * Source: background subtraction by the share of scans, as in Examples/sequence; the exponential
 * window is ours.
 * Valid: finite points. The same bits for any order of the points. Azimuths beyond +-180 degrees
 * are neighbours, the other side of the zenith is not.
 * Test: TestClutterMap.cxx; TestClutterFilter.py (NumPy, point by point).
 */
#ifndef avianlidar_ClutterMap_h
#define avianlidar_ClutterMap_h

#include "Vector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
/// Cells about the sensor. Angles are nearest to a multiple of their step, ranges are from a
/// multiple of theirs on.
struct ClutterGrid
{
  double rangeStep = 1.5;       ///< m, 0.001 to 1000
  double azimuthStep = 0.375;   ///< degrees, 0.001 to 90; the whole circle has a whole number
  double elevationStep = 0.375; ///< degrees, 0.001 to 90

  int columns() const; ///< of the whole circle
};

struct ClutterCell
{
  int azimuth = 0;   ///< 0 to columns() - 1, clockwise from y
  int elevation = 0; ///< 0 is the horizon
  int range = 0;
};

class ClutterMap
{
public:
  /// Of a cell; a larger one is later in the list.
  using Key = std::uint64_t;

  static constexpr double LongestWindow = 100000.0;
  static constexpr int MostTolerance = 10;
  /// More ranges are one cell.
  static constexpr int MostRanges = (1 << 26) - 2 * MostTolerance - 1;

  /// @param window W, scans, 1 to LongestWindow
  explicit ClutterMap(const ClutterGrid& grid = {}, double window = 200.0);

  /// What is wrong with a grid or a window, or an empty string.
  static std::string check(const ClutterGrid& grid, double window);

  /// The cell of a point. @param offset m, from the sensor
  static Key keyOf(const ClutterGrid& grid, const Vec3& offset);
  static Key keyOf(const ClutterCell& cell);
  static ClutterCell cellOf(Key key);
  /// Is it a cell of the grid?
  static bool holds(const ClutterGrid& grid, const ClutterCell& cell);
  /// The middle of a cell, m from the sensor.
  static Vec3 middleOf(const ClutterGrid& grid, const ClutterCell& cell);

  /// The map after one scan more. @param points keys of its points, in any order
  ClutterMap learned(std::vector<Key> points) const;

  /// The map that has these cells. @param scans that were learned
  ClutterMap restored(
    const std::vector<Key>& cells, const std::vector<double>& persistences, int scans) const;

  /// The largest persistence of the cells around each point.
  /// @param rangeTolerance, angularTolerance in cells to each side, 0 to MostTolerance
  std::vector<double> probabilities(
    const std::vector<Key>& points, int rangeTolerance, int angularTolerance) const;

  const std::vector<Key>& keys() const { return this->Keys; } ///< rising
  double persistence(std::size_t index) const { return this->shareOf(this->Sums[index]); }
  int scans() const { return this->Scans; }
  const ClutterGrid& grid() const { return this->Grid; }

  /// Cells below it are forgotten: a thousandth, or half of one echo in a long window.
  double persistenceKept() const;

private:
  double total() const; ///< sum of the weights of all scans
  double shareOf(double sum) const;

  ClutterGrid Grid;
  double Window;
  int Scans = 0;
  std::vector<Key> Keys;
  std::vector<double> Sums; ///< of the weights of scans with an echo
};
}

#endif
